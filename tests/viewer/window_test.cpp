// The window as a user has it, on a display without a screen: a script drags a light, the pictures
// show what it lights.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "cubemap/image/environment.h"
#include "cubemap/layers/light_layer.h"
#include "cubemap/resample/save_environment.h"
#include "data_gen/scenes.h"
#include "mesh/save.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/precompute.h"
#include "tests/prt/scenes.h"
#include "viewer/view_state.h"

namespace relumine::viewer {
namespace {

constexpr int Width = 800;
constexpr int Height = 500;

class WindowTest : public testing::Test {
protected:
    void SetUp() override {
        if (std::system("command -v xvfb-run >/dev/null 2>&1") != 0)
            GTEST_SKIP()
                << "needs xvfb-run (Debian packages xvfb and xauth): no window is tested here";
        std::string pattern =
            (std::filesystem::temp_directory_path() / "relumine-view-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;

        const mesh::TriangleMesh mesh = data_gen::sphere(4000);
        const prt::Receivers receivers = prt::vertex_receivers(mesh);
        const prt::RayScene rays(mesh);
        const prt::PrecomputeOptions options{
            .tolerance = 0.03f, .face_resolution = 64, .bias = prt::automatic_bias(mesh)};
        prt::save_scene(folder_ / "scene.prt",
                        {.mesh = mesh,
                         .transfer = prt::precompute(receivers, rays, options),
                         .settings = {.tolerance = options.tolerance,
                                      .face_resolution = 64,
                                      .bias = options.bias}});
        // Bluish above, so that the background tells where up is.
        cubemap::CubeMap environment(32, glm::vec3(0.05f));
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = 0; x < 32; ++x)
                environment.at(cubemap::Face::PositiveY, x, y) = glm::vec3(0.05f, 0.05f, 0.2f);
        cubemap::save_environment(folder_ / "env.exr", environment);
        viewport_ = panel_layout(Width, Height).scene;
        camera_ = camera_on_all(unclustered_scene(mesh), viewport_);
    }
    void TearDown() override {
        if (!folder_.empty())
            std::filesystem::remove_all(folder_);
    }

    /// Exit code of `relumine view` with a script; its words are in out.txt and err.txt.
    [[nodiscard]] int play(const std::string& script, int width = Width,
                           const std::string& scene = "scene.prt") const {
        std::ofstream(folder_ / "script") << script;
        // The program's words and exit code are kept inside: xvfb-run may fail to remove its own
        // folder when a program ends soon.
        std::ofstream(folder_ / "run")
            << fmt::format("RELUMINE_CACHE=cache '{}' view {} env.exr --script script --size "
                           "{}x{} --exposure 0 --json >out.txt 2>err.txt\n"
                           "echo $? >code.txt\n",
                           RELUMINE_BINARY, scene, width, Height);
        std::filesystem::remove(folder_ / "code.txt");
        const std::string command = fmt::format(
            "cd '{}' && LIBGL_ALWAYS_SOFTWARE=1 ASAN_OPTIONS=detect_leaks=0 "
            "TSAN_OPTIONS=\"$TSAN_OPTIONS ignore_noninstrumented_modules=1\" xvfb-run -a -s "
            "'-screen 0 1280x1024x24' sh run >xvfb.txt 2>&1",
            folder_.string());
        static_cast<void>(std::system(command.c_str()));
        int code = -1;
        std::ifstream(folder_ / "code.txt") >> code;
        return code;
    }
    [[nodiscard]] std::string words(const std::string& name) const {
        std::ifstream file(folder_ / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] cubemap::Picture picture(const std::string& name) const {
        return cubemap::load_image_pyramid(folder_ / name)->levels().front();
    }
    /// The window's pixel at which a point of the world is seen.
    [[nodiscard]] std::array<int, 2> pixel_of(const glm::vec3& point) const {
        const CameraFrame axes = frame(camera_, viewport_);
        const glm::vec3 from_eye = point - camera_.eye();
        const float depth = glm::dot(from_eye, axes.forward);
        const float x = glm::dot(from_eye, axes.right) / glm::dot(axes.right, axes.right) / depth;
        const float y = glm::dot(from_eye, axes.up) / glm::dot(axes.up, axes.up) / depth;
        return {viewport_.x +
                    static_cast<int>((0.5f + 0.5f * x) * static_cast<float>(viewport_.width)),
                viewport_.y +
                    static_cast<int>((0.5f - 0.5f * y) * static_cast<float>(viewport_.height))};
    }
    /// Green, the mean of 5 x 5 pixels.
    [[nodiscard]] static float brightness(const cubemap::Picture& picture,
                                          const std::array<int, 2>& at) {
        float sum = 0.0f;
        for (int y = at[1] - 2; y <= at[1] + 2; ++y)
            for (int x = at[0] - 2; x <= at[0] + 2; ++x)
                sum += picture
                           .pixels[static_cast<std::size_t>(y) * picture.width +
                                   static_cast<std::size_t>(x)]
                           .g;
        return sum / 25.0f;
    }
    /// Whether two pictures agree bit by bit in a part of the window.
    [[nodiscard]] static bool equal(const cubemap::Picture& a, const cubemap::Picture& b,
                                    const PixelRectangle& part) {
        for (int y = part.y; y < part.y + part.height; ++y)
            for (int x = part.x; x < part.x + part.width; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * a.width + static_cast<std::size_t>(x);
                if (a.pixels[i] != b.pixels[i])
                    return false;
            }
        return true;
    }

    std::filesystem::path folder_;
    PixelRectangle viewport_;
    OrbitCamera camera_;
    // On the sphere, towards the camera and to both sides of it.
    glm::vec3 right_ = data_gen::SphereCenter + glm::normalize(glm::vec3(0.85f, 0.2f, 0.4f));
    glm::vec3 left_ = data_gen::SphereCenter + glm::normalize(glm::vec3(-0.65f, 0.2f, 0.65f));
};

TEST_F(WindowTest, ADraggedDiscLightsTheOtherSideAndUndoBringsItBack) {
    ASSERT_EQ(play("add_disc Key 1,0.2,0.3 20\n"
                   "set_gain Key 2\n"
                   "wait 2\n"
                   "screenshot before.exr\n"
                   "drag_layer Key -1,0.2,0.3 12\n"
                   "wait 1\n"
                   "screenshot after.exr\n"
                   "undo\n"
                   "wait 1\n"
                   "screenshot undone.exr\n"
                   "quit\n"),
              0)
        << words("err.txt");
    EXPECT_EQ(words("err.txt"), "");
    const nlohmann::json report = nlohmann::json::parse(words("out.txt"));
    EXPECT_EQ(report["drag_events"], 12);
    EXPECT_GT(report["seconds_drag_mean"], 0.0);

    const cubemap::Picture before = picture("before.exr");
    const cubemap::Picture after = picture("after.exr");
    const cubemap::Picture undone = picture("undone.exr");
    ASSERT_EQ(before.width, static_cast<std::uint32_t>(Width));
    ASSERT_EQ(before.height, static_cast<std::uint32_t>(Height));
    // Light from the right, then from the left: no mirror image.
    EXPECT_GT(brightness(before, pixel_of(right_)), 3.0f * brightness(before, pixel_of(left_)));
    EXPECT_GT(brightness(after, pixel_of(left_)), 3.0f * brightness(after, pixel_of(right_)));
    // Behind the mesh nothing has changed, nor in the tools over it.
    const PixelRectangle corner{
        .x = viewport_.x, .y = viewport_.y, .width = viewport_.width, .height = 8};
    EXPECT_TRUE(equal(before, after, corner));
    EXPECT_TRUE(equal(before, after, panel_layout(Width, Height).scene_tools));
    // The environment's picture shows the disc where it is now: +X left of the centre, -X right of
    // it.
    const PixelRectangle map = panel_layout(Width, Height).environment;
    const std::array left_in_map = {map.x + map.width * 29 / 100, map.y + map.height * 48 / 100};
    const std::array right_in_map = {map.x + map.width * 71 / 100, map.y + map.height * 48 / 100};
    EXPECT_GT(brightness(before, left_in_map), 4.0f * brightness(before, right_in_map));
    EXPECT_GT(brightness(after, right_in_map), 4.0f * brightness(after, left_in_map));

    EXPECT_TRUE(equal(before, undone, viewport_));
    EXPECT_TRUE(equal(before, undone, map));
}

TEST_F(WindowTest, ThePointerDragsLayersTurnsTheSceneAndAsksWhoLights) {
    const PixelRectangle map = panel_layout(Width, Height).environment;
    const auto on_map = [&](const glm::dvec3& direction) {
        const glm::dvec2 pixel = LatLongView{}.pixel_of(map, direction);
        return fmt::format("{} {}", std::lround(pixel.x), std::lround(pixel.y));
    };
    const std::array on_sphere = pixel_of(right_);
    ASSERT_EQ(play(fmt::format("add_disc Key 1,0.2,0.3 20\n"
                               "screenshot before.exr\n"
                               "drag_env {} {}\n"
                               "screenshot moved.exr\n"
                               "save_layers saved.json\n"
                               "click_mesh {} {}\n"
                               "wait 1\n"
                               "screenshot heat.exr\n"
                               "drag_mesh 200 250 300 250\n"
                               "screenshot turned.exr\n",
                               on_map({1, 0.2, 0.3}), on_map({-1, 0.2, 0.3}), on_sphere[0],
                               on_sphere[1])),
              0)
        << words("err.txt");
    const cubemap::LightLayers saved = cubemap::load_layers(folder_ / "saved.json");
    ASSERT_EQ(saved.layers.size(), 1u);
    EXPECT_LT(
        angle_between(std::get<cubemap::Disc>(saved.layers[0].region).direction, {-1, 0.2, 0.3}),
        2.0);

    const cubemap::Picture moved = picture("moved.exr");
    EXPECT_GT(brightness(moved, pixel_of(left_)), 1.5f * brightness(moved, pixel_of(right_)));
    const cubemap::Picture heat = picture("heat.exr");
    EXPECT_FALSE(equal(moved, heat, map));
    const PixelRectangle upper{.x = viewport_.x,
                               .y = viewport_.y,
                               .width = viewport_.width,
                               .height = viewport_.height / 8};
    EXPECT_TRUE(equal(moved, heat, upper));
    EXPECT_FALSE(equal(heat, picture("turned.exr"), viewport_));
}

TEST_F(WindowTest, PointsInSpaceAreLitBalls) {
    const glm::vec3 to_eye = glm::normalize(camera_.eye() - data_gen::SphereCenter);
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), to_eye));
    PrecomputeOptions options;
    options.receivers = Points{.positions = {data_gen::SphereCenter + 1.2f * to_eye,
                                             data_gen::SphereCenter + 1.7f * right}};
    options.output = folder_ / "scene.prt";
    static_cast<void>(precompute(data_gen::sphere(1000), options));
    const std::array in_front = pixel_of(data_gen::SphereCenter + 1.2f * to_eye);
    ASSERT_EQ(play(fmt::format("wait 1\n"
                               "screenshot dark.exr\n"
                               "add_disc Key {},{},{} 20\n"
                               "set_gain Key 3\n"
                               "wait 1\n"
                               "screenshot lit.exr\n"
                               "click_mesh {} {}\n"
                               "wait 1\n"
                               "screenshot heat.exr\n",
                               to_eye.x, to_eye.y, to_eye.z, in_front[0], in_front[1])),
              0)
        << words("err.txt");
    const cubemap::Picture dark = picture("dark.exr"), lit = picture("lit.exr");
    EXPECT_GT(brightness(lit, in_front), 1.5f * brightness(dark, in_front));
    // The ball asks as a vertex does.
    EXPECT_FALSE(equal(lit, picture("heat.exr"), panel_layout(Width, Height).environment));
}

TEST_F(WindowTest, ALightGoesWhereTheMeshIsClicked) {
    const std::array right = pixel_of(right_), left = pixel_of(left_);
    ASSERT_EQ(play(fmt::format("rotate 50\n"
                               "add_disc Key 0,-1,0 10\n"
                               "aim_layer Key {0} {1}\n"
                               "save_layers facing.json\n"
                               "mirror_layer Key {0} {1}\n"
                               "save_layers mirrored.json\n"
                               "click_does 1\n"
                               "drag_mesh {0} {1} {2} {3}\n"
                               "save_layers dragged.json\n"
                               "undo\n"
                               "save_layers undone.json\n",
                               right[0], right[1], left[0], left[1])),
              0)
        << words("err.txt");
    const auto seen = [&](const std::string& file) {
        const cubemap::LightLayers layers = cubemap::load_layers(folder_ / file);
        return turned(middle(layers.layers.at(0).region), *layers.rotate_degrees);
    };
    const glm::dvec3 normal(right_ - data_gen::SphereCenter);
    const glm::dvec3 to_eye(glm::normalize(camera_.eye() - right_));
    EXPECT_LT(angle_between(seen("facing.json"), normal), 2.0);
    EXPECT_LT(angle_between(seen("mirrored.json") + to_eye, normal), 2.0);
    EXPECT_LT(angle_between(seen("dragged.json"), glm::dvec3(left_ - data_gen::SphereCenter)), 2.0)
        << "it follows the pointer, and the camera stays";
    EXPECT_EQ(seen("undone.json"), seen("mirrored.json")) << "one step of undo";

    EXPECT_EQ(play("add_disc Key 0,1,0 10\naim_layer Key 3 45\n"), 1);
    EXPECT_EQ(words("err.txt"),
              "relumine: script line 2: expected a pixel of the mesh, got 3 45\n");
}

TEST_F(WindowTest, ASavedPictureIsThatOfRelightFromTheCameraItTells) {
    ASSERT_EQ(play("drag_mesh 200 250 260 280\n"
                   "look 20 10\n"
                   "fly 0.1,0.2,0.4\n"
                   "save_picture own.png\n"
                   "save_picture own.exr\n"),
              0)
        << words("err.txt");
    const std::string camera = nlohmann::json::parse(words("out.txt"))["camera"];
    ASSERT_EQ(
        std::system(fmt::format("cd '{}' && '{}' relight scene.prt env.exr -q {} --size {}x{} "
                                "--exposure 0 -o relit.exr",
                                folder_.string(), RELUMINE_BINARY, camera, viewport_.width,
                                viewport_.height)
                        .c_str()),
        0)
        << camera;
    const cubemap::Picture own = picture("own.exr"), relit = picture("relit.exr");
    ASSERT_EQ(own.pixels.size(), relit.pixels.size());
    double difference = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < own.pixels.size(); ++i) {
        difference += std::abs(own.pixels[i].g - relit.pixels[i].g);
        sum += relit.pixels[i].g;
    }
    EXPECT_LT(difference, 0.002 * sum) << "up to the digits of the camera";
    EXPECT_TRUE(std::filesystem::exists(folder_ / "own.png"));
    EXPECT_EQ(play("save_picture own.jpeg\n"), 1);
    EXPECT_EQ(words("err.txt"), "relumine: script line 1: own.jpeg: expected .png or .exr for a "
                                "picture, got '.jpeg'\n");
}

TEST_F(WindowTest, NoToolIsCutOffInANarrowWindow) {
    // In a window that is narrower than the row of tools, they stand in several.
    for (const int width : {800, 1000}) {
        const PixelRectangle tools = panel_layout(width, Height).scene_tools;
        std::string script;
        for (int y = tools.y + 42; y < tools.y + tools.height; y += 25)
            for (int x = tools.x + 16; x < tools.x + tools.width && x < 260; x += 40)
                script += fmt::format("click {} {}\n", x, y);
        std::filesystem::remove(folder_ / "picture-1.png");
        ASSERT_EQ(play(script + fmt::format("screenshot {}.png\n", width), width), 0)
            << words("err.txt");
        EXPECT_TRUE(std::filesystem::exists(folder_ / "picture-1.png"))
            << "*Save picture* is in none of the rows at a width of " << width;
    }
}

TEST_F(WindowTest, ASoloLightShinesAlone) {
    ASSERT_EQ(play("add_preset strip 1,0.2,0.3\n"
                   "add_preset ring -1,0.2,0.3\n"
                   "set_gain strip 2\n"
                   "set_gain ring 2\n"
                   "wait 1\n"
                   "screenshot both.exr\n"
                   "solo ring 1\n"
                   "wait 1\n"
                   "screenshot ring.exr\n"
                   "undo\n"
                   "wait 1\n"
                   "screenshot undone.exr\n"),
              0)
        << words("err.txt");
    const cubemap::Picture both = picture("both.exr"), ring = picture("ring.exr");
    EXPECT_GT(brightness(both, pixel_of(right_)), 0.02f);
    EXPECT_LT(brightness(ring, pixel_of(right_)), 0.3f * brightness(both, pixel_of(right_)));
    EXPECT_GT(brightness(ring, pixel_of(left_)), 0.02f);
    EXPECT_EQ(brightness(ring, {viewport_.x + 8, viewport_.y + 60}), 0.0f) << "no environment";
    EXPECT_TRUE(equal(both, picture("undone.exr"), viewport_));
    EXPECT_EQ(play("add_preset strop 1,0,0\n"), 1);
}

TEST_F(WindowTest, LassosAndDroppedPicturesBecomeLayersAndRotationIsUndone) {
    const PixelRectangle map = panel_layout(Width, Height).environment;
    cubemap::save_environment(folder_ / "picture.exr",
                              cubemap::CubeMap(8, glm::vec3(3.0f, 2.0f, 1.0f)),
                              cubemap::Layout::LatLong);
    const auto box = [&](double x0, double y0, double x1, double y1) {
        return fmt::format("{} {} {} {}", std::lround(map.x + x0 * map.width),
                           std::lround(map.y + y0 * map.height),
                           std::lround(map.x + x1 * map.width),
                           std::lround(map.y + y1 * map.height));
    };
    // The dialogue is in the window's middle; its second button makes a layer.
    const std::string on_image_layer = fmt::format("{} {}", Width / 2 + 20, Height / 2 + 22);
    ASSERT_EQ(play(fmt::format("lasso_env {}\n"
                               "wait 1\n"
                               "screenshot lasso.exr\n"
                               "drop picture.exr\n"
                               "wait 3\n"
                               "screenshot asks.exr\n"
                               "click {}\n"
                               "wait 1\n"
                               "screenshot layer.exr\n"
                               "rotate 40\n"
                               "wait 1\n"
                               "screenshot rotated.exr\n"
                               "undo\n"
                               "wait 1\n"
                               "screenshot unrotated.exr\n"
                               "save_layers saved.json\n"
                               "open picture.exr\n"
                               "save_layers on_picture.json\n"
                               "undo\n"
                               "save_layers undone.json\n"
                               "undo\n"
                               "undo\n"
                               "save_layers nothing.json\n",
                               box(0.15, 0.3, 0.35, 0.6), on_image_layer)),
              0)
        << words("err.txt");
    const cubemap::LightLayers saved = cubemap::load_layers(folder_ / "saved.json");
    ASSERT_EQ(saved.layers.size(), 2u) << "the drop became a layer";
    EXPECT_TRUE(std::holds_alternative<cubemap::Lasso>(saved.layers[0].region));
    EXPECT_TRUE(std::holds_alternative<cubemap::Gain>(saved.layers[0].effect));
    // The outline's middle is a quarter from the left: +X.
    EXPECT_EQ(cubemap::coverage(saved.layers[0].region, direction_at({0.25, 0.45})), 1.0);
    EXPECT_EQ(cubemap::coverage(saved.layers[0].region, direction_at({0.37, 0.45})), 0.0);
    const auto& patch = std::get<cubemap::ImagePatch>(saved.layers[1].effect);
    EXPECT_EQ(patch.path, "picture.exr") << "relative to the file";
    EXPECT_EQ(saved.base, "env.exr");
    const cubemap::Picture lasso = picture("lasso.exr");
    EXPECT_FALSE(equal(lasso, picture("asks.exr"), viewport_))
        << "the dialogue dims what is behind it";
    const cubemap::Picture layer = picture("layer.exr");
    EXPECT_GT(brightness(layer, {map.x + map.width / 2, map.y + map.height * 46 / 100}),
              brightness(lasso, {map.x + map.width / 2, map.y + map.height * 46 / 100}));
    EXPECT_FALSE(equal(layer, picture("rotated.exr"), map));
    EXPECT_TRUE(equal(layer, picture("unrotated.exr"), map));
    EXPECT_TRUE(equal(layer, picture("unrotated.exr"), viewport_));
    EXPECT_EQ(cubemap::load_layers(folder_ / "on_picture.json").base, "picture.exr");
    EXPECT_EQ(cubemap::load_layers(folder_ / "undone.json").base, "env.exr");
    EXPECT_TRUE(cubemap::load_layers(folder_ / "nothing.json").layers.empty());
}

TEST_F(WindowTest, SavedLayersFindTheirPicturesFromAnotherFolder) {
    cubemap::save_environment(folder_ / "picture.exr", cubemap::CubeMap(8, glm::vec3(3.0f)),
                              cubemap::Layout::LatLong);
    std::filesystem::create_directory(folder_ / "a");
    std::filesystem::create_directory(folder_ / "b");
    ASSERT_EQ(play("add_image picture.exr\n"
                   "save_layers a/layers.json\n"
                   "open a/layers.json\n"
                   "save_layers b/layers.json\n"
                   "open b/layers.json\n"),
              0)
        << words("err.txt");
    const cubemap::LightLayers saved = cubemap::load_layers(folder_ / "b/layers.json");
    ASSERT_EQ(saved.layers.size(), 1u);
    EXPECT_EQ(std::get<cubemap::ImagePatch>(saved.layers[0].effect).path, "../picture.exr");
    EXPECT_EQ(play("add_image missing.exr\n"), 1);
    EXPECT_EQ(play("add_image env.png\n"), 1);
    EXPECT_EQ(words("err.txt"), "relumine: script line 1: env.png: expected .exr, .hdr, .tif, "
                                ".pfm, .dds, .ktx2 or .jpg for an image layer, got '.png'\n");
}

TEST_F(WindowTest, AScriptThatFailsEndsWithOneLine) {
    EXPECT_EQ(play("drag_layer Nobody 1,0,0\n"), 1);
    EXPECT_EQ(words("err.txt"),
              "relumine: script line 1: expected the name of a layer, got 'Nobody'\n");
    EXPECT_EQ(play("open missing.exr\n"), 1);
    EXPECT_NE(words("err.txt").find("missing.exr"), std::string::npos);
}

TEST_F(WindowTest, RoughnessChangesHighlightsThatFollowTheEye) {
    const std::string script = "roughness 0.2\nwait 1\nscreenshot smooth.exr\n"
                               "roughness 0.9\nwait 1\nscreenshot rough.exr\n"
                               "roughness 0.2\nwait 1\nscreenshot again.exr\n";
    EXPECT_EQ(play(script), 1);
    EXPECT_NE(words("err.txt").find("expected a scene whose highlights follow the eye"),
              std::string::npos)
        << words("err.txt");
    prt::Surface shiny{.albedo = glm::vec3(0.1f),
                       .specular = glm::vec3(0.6f),
                       .highlight = prt::Highlight::GgxWhole,
                       .roughness_or_exponent = 0.4f};
    prt::save_scene(
        folder_ / "scene.prt",
        precompute(data_gen::sphere(4000),
                   {.tolerance = 0.06f,
                    .face_resolution = 64,
                    .surface = [&](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface&) {
                        return shiny;
                    }}));
    ASSERT_EQ(play(script), 0) << words("err.txt");
    // Of the scene's view alone: panels show times.
    const auto pixels = [&](const std::string& name) {
        const cubemap::Picture all = picture(name);
        std::vector<glm::vec3> result;
        for (int y = viewport_.y; y < viewport_.y + viewport_.height; ++y)
            for (int x = viewport_.x; x < viewport_.x + viewport_.width; ++x)
                result.push_back(all.pixels[static_cast<std::size_t>(y) * all.width +
                                            static_cast<std::size_t>(x)]);
        return result;
    };
    const auto smooth = pixels("smooth.exr"), rough = pixels("rough.exr");
    EXPECT_TRUE(smooth == pixels("again.exr"));
    float largest = 0.0f;
    for (std::size_t i = 0; i < smooth.size(); ++i)
        largest = std::max(largest, std::abs(smooth[i].b - rough[i].b));
    EXPECT_GT(largest, 0.02f);
}

TEST_F(WindowTest, AThingIsDraggedAndUndoBringsItBack) {
    constexpr glm::vec3 Ball(1.0f, 0.6f, 0.0f);
    mesh::TriangleMesh mesh = scenes::floor_grid(21, 5.0f);
    const std::size_t num_ground = mesh.num_triangles();
    mesh = scenes::joined(mesh, scenes::icosphere(3, 0.6f, Ball));
    mesh.groups = {"ground", "ball"};
    mesh.materials = {{.name = "pale", .base_color = glm::vec3(0.8f)},
                      {.name = "red", .base_color = {0.8f, 0.02f, 0.02f}}};
    mesh.triangle_groups.assign(num_ground, 0);
    mesh.triangle_groups.resize(mesh.num_triangles(), 1);
    mesh.triangle_materials = mesh.triangle_groups;
    const Scene scene =
        precompute(std::move(mesh),
                   {.tolerance = 0.05f, .face_resolution = 32, .no_refine = true, .movable = true});
    prt::save_scene(folder_ / "things.prt", scene);
    camera_ = camera_on_all(scene, viewport_);
    const std::array<int, 2> from = pixel_of(Ball), to = {from[0] + 170, from[1]};
    const std::string drag =
        fmt::format("drag_thing {} {} {} {}\n", from[0], from[1], to[0], to[1]);
    ASSERT_EQ(play("wait 1\nscreenshot before.exr\n" + drag +
                       "wait 1\nscreenshot after.exr\n"
                       "undo\nwait 1\nscreenshot undone.exr\n"
                       "redo\nwait 1\nscreenshot redone.exr\n",
                   Width, "things.prt"),
              0)
        << words("err.txt");
    EXPECT_GT(nlohmann::json::parse(words("out.txt"))["drag_events"], 5);
    const cubemap::Picture before = picture("before.exr"), after = picture("after.exr");
    // The red ball is dark in green.
    EXPECT_LT(brightness(before, from), 0.5f * brightness(before, to));
    EXPECT_LT(brightness(after, to), 0.5f * brightness(after, from));
    EXPECT_TRUE(equal(before, picture("undone.exr"), viewport_));
    EXPECT_TRUE(equal(after, picture("redone.exr"), viewport_));
}

TEST_F(WindowTest, AMeshIsSeenWhileItIsPrecomputed) {
    mesh::save(folder_ / "posts.ply", data_gen::colonnade(4000));
    const auto played = [&] {
        EXPECT_EQ(play("wait 1\nquit\n", Width, "posts.ply"), 0) << words("err.txt");
        return nlohmann::json::parse(words("out.txt"));
    };
    const nlohmann::json first = played();
    EXPECT_GT(first["frames_of_first_sight"], 0);
    EXPECT_GT(first["clusters"], 384) << "the script plays to the whole scene";
    // It is in the cache now.
    const nlohmann::json second = played();
    EXPECT_FALSE(second.contains("frames_of_first_sight"));
    EXPECT_EQ(second["clusters"], first["clusters"]);
}

} // namespace
} // namespace relumine::viewer
