#include "relumine/out/output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "cubemap/image/environment.h"
#include "mesh/floor.h"
#include "relight/pictures/exposure.h"
#include "relumine/out/floor_picture.h"
#include "tests/mesh/lit_ply.h"
#include "tests/prt/scenes.h"
#include "tests/prt/textured_square.h"
#include "tests/relight/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class Output : public scenes::InFolder {
protected:
    static LitScene lit(const PrecomputeOptions& options = {.tolerance = 0.2f, .no_refine = true}) {
        LitScene scene(precompute(scenes::two_squares(), options));
        scene.light(scenes::random_environment(8, 1));
        return scene;
    }
};

TEST_F(Output, ColoursAreFactors) {
    const LitScene scene = lit();
    const std::vector<glm::vec3> grey =
        colors_of(scene.scene(), scene.radiance(), glm::vec3(0.5f, 1.0f, 2.0f));
    const std::vector<glm::vec3> own = colors_of(scene.scene(), scene.radiance(), MeshColors{});
    for (std::size_t i = 0; i < grey.size(); ++i) {
        EXPECT_EQ(grey[i], scene.radiance()[i] * glm::vec3(0.5f, 1.0f, 2.0f));
        EXPECT_EQ(own[i], scene.radiance()[i] * glm::vec3(0.5f, 0.25f, 1.0f));
    }
    EXPECT_THROW(
        static_cast<void>(colors_of(scene.scene(), scene.radiance().first(3), glm::vec3(1.0f))),
        std::invalid_argument);
    const Scene plain = unclustered_scene(scenes::boulder());
    const std::vector<glm::vec3> black(plain.receivers.size(), glm::vec3(0.0f));
    EXPECT_THROW(static_cast<void>(colors_of(plain, black, MeshColors{})), std::invalid_argument);
}

TEST_F(Output, OfManyFramesIsThatOfOne) {
    LitScene scene = lit();
    Painter painter(scene, {.width = 20, .height = 10, .samples_per_axis = 2});
    for (std::uint32_t seed = 1; seed < 4; ++seed) {
        scene.light(scenes::random_environment(8, seed));
        EXPECT_EQ(painter.draw(scene.lighting()).pixels,
                  draw(scene, {.width = 20, .height = 10, .samples_per_axis = 2}).pixels);
    }
}

TEST_F(Output, TellsHowMuchIsDrawn) {
    const LitScene scene = lit();
    Painter painter(scene, {.width = 200, .height = 100, .samples_per_axis = 1});
    std::vector<double> told;
    painter.on_progress([&](double fraction) { told.push_back(fraction); });
    static_cast<void>(painter.draw(scene.lighting()));
    EXPECT_GT(told.size(), 3u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(told.back(), 1.0);
}

TEST_F(Output, LooksThroughTheCameraThatIsGiven) {
    const LitScene scene = lit();
    const Camera away{.eye = {0, 5, 0}, .target = {0, 10, 0}};
    const Picture sky = draw(scene, {.width = 4, .height = 4, .camera = away});
    for (std::uint32_t y = 0; y < 4; ++y)
        EXPECT_GT(sky.pixels[y * 4].g, 0.0f);
    EXPECT_NE(sky.pixels, draw(scene, {.width = 4, .height = 4}).pixels);
}

TEST_F(Output, IsWrittenByExtension) {
    const LitScene scene = lit();
    save(scene, file("bright.exr"), {.exposure_ev = 1.0, .width = 8, .height = 4});
    const Picture picture = draw(scene, {.width = 8, .height = 4});
    const cubemap::EnvironmentImage written =
        cubemap::load_environment(file("bright.exr"), {.layout = cubemap::Layout::LatLong});
    ASSERT_EQ(written.pixels.size(), picture.pixels.size());
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        EXPECT_EQ(written.pixels[i], 2.0f * picture.pixels[i]);

    save(scene, file("lit.ply"), {.albedo = glm::vec3(0.5f), .exposure_ev = 0.0});
    const std::vector<glm::vec3> colors =
        colors_of(scene.scene(), scene.radiance(), glm::vec3(0.5f));
    const std::vector<mesh::LitVertex> vertices = mesh::lit_ply(file("lit.ply"), colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
        EXPECT_EQ(vertices[i].radiance, colors[i]);
    for (const char* name : {"lit.png", "lit.glb", "lit.npy"}) {
        save(scene, file(name), {.width = 8, .height = 4});
        EXPECT_GT(std::filesystem::file_size(file(name)), 50u) << name;
    }
    EXPECT_THROW(save(scene, file("lit.jpg")), std::invalid_argument);
    EXPECT_THROW(save(scene, file("absent/lit.png"), {.width = 8, .height = 4}),
                 std::runtime_error);
}

// What surfaces give of their own comes on top of all light, times a factor that costs nothing.
TEST_F(Output, EmissionIsAddedAndDimmed) {
    const glm::vec3 own(3.0f, 0.0f, 0.5f);
    const PrecomputeOptions glowing{
        .tolerance = 0.2f, .surface = everywhere({.albedo = glm::vec3(0.5f), .emission = own})};
    const LitScene scene = lit(glowing);
    const std::vector<glm::vec3> colors =
        colors_of(scene.scene(), scene.radiance(), glm::vec3(1.0f));
    const std::vector<glm::vec3> dimmed =
        Painter(scene, {.emission = {{.gain = {0.5f, 1.0f, 2.0f}}}}).values(scene.radiance());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        EXPECT_EQ(colors[i], scene.radiance()[i] + own);
        EXPECT_EQ(dimmed[i], scene.radiance()[i] + glm::vec3(1.5f, 0.0f, 1.0f));
    }
    PrecomputeOptions of_pixels = glowing;
    of_pixels.receivers = Pixels{.width = 9, .height = 5};
    const LitScene pixels = lit(of_pixels);
    for (const LitScene* drawn : {&scene, &pixels}) {
        OutputOptions options{.width = 9, .height = 5, .samples_per_axis = 1};
        options.background = NothingBehind{};
        const Picture bright = draw(*drawn, options);
        options.emission = {{.gain = glm::vec3(0.0f)}};
        const Picture plain = draw(*drawn, options);
        float covered = 0.0f;
        for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
            EXPECT_LT(glm::distance(bright.pixels[i], plain.pixels[i] + plain.alpha[i] * own),
                      1e-5f);
            covered += plain.alpha[i];
        }
        EXPECT_GT(covered, 1.0f);
    }
}

TEST_F(Output, OfPixelsIsTheirPicture) {
    const LitScene scene = lit({.tolerance = 0.2f, .receivers = Pixels{.width = 9, .height = 5}});
    const Picture opaque = draw(scene);
    EXPECT_EQ(opaque.width, 9u);
    EXPECT_TRUE(opaque.alpha.empty());
    EXPECT_EQ(draw(scene, {.background = NothingBehind{}}).alpha.size(), 45u);
    EXPECT_THROW(save(scene, file("pixels.ply")), std::invalid_argument);
    EXPECT_FALSE(is_output_of("pixels.GLB", scene.scene()));
    EXPECT_TRUE(is_output_of("pixels.PNG", scene.scene()));
}

TEST_F(Output, OfTexelsIsTheirLightmap) {
    const LitScene scene = lit({.tolerance = 0.2f, .receivers = Texels{.width = 8, .height = 4}});
    const Picture lightmap = draw(scene, {.albedo = glm::vec3(2.0f)});
    EXPECT_EQ(lightmap.pixels.size(), 32u);
    EXPECT_EQ(lightmap.pixels.front(), 2.0f * scene.radiance().front());
}

TEST_F(Output, OfAMapIsALatLong) {
    save_map(file("map.exr"), cubemap::CubeMap(4, glm::vec3(0.25f)), 2.0);
    const cubemap::EnvironmentImage image = cubemap::load_environment(file("map.exr"));
    EXPECT_EQ(image.width, 16u);
    EXPECT_EQ(image.height, 8u);
    for (const glm::vec3& pixel : image.pixels)
        EXPECT_NEAR(pixel.g, 1.0f, 1e-6f);
}

/// A wall on a floor of this size.
Mesh standing(float floor_scale) {
    Mesh mesh(scenes::corner(3));
    mesh::append_floor(mesh.geometry, 12, floor_scale);
    mesh.floor_vertices = 12;
    return mesh;
}

/// A ground, a sky and a sun of one texel.
cubemap::CubeMap sunny() {
    cubemap::CubeMap map = scenes::random_environment(16, 3, 1.0f);
    map.at(cubemap::Face::PositiveY, 3, 4) = glm::vec3(300.0f, 200.0f, 100.0f);
    return map;
}

/// Expects that a picture shows the ground of the photograph and nothing else.
void expect_photograph(const LitScene& lit, const Picture& picture, const Camera& camera) {
    const prt::PictureRays rays(camera, picture.width, picture.height, 1);
    const relight::Backdrop ground = relight::grounded_backdrop(
        relight::map_backdrop(environment_of(lit)), picture_ground(lit.scene()), camera.eye);
    for (std::uint32_t y = 0; y < picture.height; ++y)
        for (std::uint32_t x = 0; x < picture.width; ++x)
            for (int channel = 0; channel < 3; ++channel) {
                const float expected = ground(rays.direction(x, y, 0))[channel];
                EXPECT_NEAR(picture.pixels[y * picture.width + x][channel], expected,
                            1e-3f * expected);
            }
}

TEST_F(Output, AFloorWithoutShadowsIsThePhotograph) {
    // The thing is a speck on the floor, and the picture looks elsewhere.
    const Mesh mesh = standing(40000.0f);
    const float far = 0.25f * mesh::bounds(mesh.geometry).size().x;
    const Camera camera{
        .eye = {far, 3.0f, 0.0f}, .target = {far, 0.0f, 6.0f}, .fov_degrees = 60.0f};
    for (const bool on_pixels : {false, true}) {
        PrecomputeOptions how{.tolerance = 0.1f, .no_refine = true};
        if (on_pixels) {
            how.receivers = Pixels{.width = 20, .height = 15, .samples_per_axis = 1};
            how.view = View{.camera = camera};
        }
        LitScene lit(precompute(mesh, how));
        lit.light(sunny());
        ASSERT_FALSE(on_pixels ? lit.radiance().empty() : lit.lighting().lights.empty());
        OutputOptions options{.samples_per_axis = 1};
        if (!on_pixels) {
            options.width = 20;
            options.height = 15;
            options.camera = camera;
        }
        expect_photograph(lit, draw(lit, options), camera);
        options.floor = FloorLook::Grey;
        EXPECT_NE(draw(lit, options).pixels, draw(lit, {.samples_per_axis = 1}).pixels);
    }
}

TEST_F(Output, ALayerThatIsHiddenFromTheCameraIsLightAlone) {
    cubemap::LightLayer box;
    box.name = "box";
    box.region = cubemap::Disc{.direction = {0, 0, -1}, .radius_degrees = 60.0};
    box.effect = cubemap::Emit{.radiance = glm::vec3(3.0f)};
    const OutputOptions options{.width = 40, .height = 30, .samples_per_axis = 1};
    OutputOptions clear = options;
    clear.background = NothingBehind{};
    LitScene scene = lit();
    const Picture before = draw(scene, options), mesh = draw(scene, clear);
    set_layers(scene, {box});
    const Picture seen = draw(scene, options), lit_mesh = draw(scene, clear);
    box.camera = false;
    for (const bool is_solo : {false, true}) {
        box.solo = is_solo;
        set_layers(scene, {box});
        const Picture hidden = draw(scene, options);
        std::size_t num_behind = 0, num_changed = 0, num_on_mesh = 0;
        for (std::size_t i = 0; i < mesh.alpha.size(); ++i)
            if (mesh.alpha[i] == 0.0f) {
                ++num_behind;
                num_changed += seen.pixels[i] != before.pixels[i] ? 1 : 0;
                EXPECT_EQ(hidden.pixels[i], is_solo ? glm::vec3(0.0f) : before.pixels[i]);
            } else if (mesh.alpha[i] == 1.0f && !is_solo) {
                num_on_mesh += lit_mesh.pixels[i] != mesh.pixels[i] ? 1 : 0;
                EXPECT_EQ(hidden.pixels[i], seen.pixels[i]) << "its light stays";
            }
        EXPECT_GT(num_behind, 100u);
        EXPECT_GT(num_changed, 20u) << "there is something to hide";
        EXPECT_TRUE(is_solo || num_on_mesh > 20);
    }
}

TEST_F(Output, AFloorCatchesShadows) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f}));
    lit.light(sunny());
    const OutputOptions options{.width = 40, .height = 30, .background = NothingBehind{}};
    const Picture alone = draw(lit, options);
    std::size_t num_clear = 0, num_shaded = 0;
    for (std::size_t i = 0; i < alone.alpha.size(); ++i) {
        num_clear += alone.alpha[i] < 0.01f ? 1 : 0;
        // What is dark and not opaque is a shadow.
        num_shaded +=
            alone.alpha[i] > 0.1f && alone.alpha[i] < 0.95f && alone.pixels[i].g == 0.0f ? 1 : 0;
    }
    EXPECT_GT(num_clear, 300u);
    EXPECT_GT(num_shaded, 10u);
    // A plain background takes the same shadows.
    OutputOptions white = options;
    white.background = glm::vec3(1.0f);
    const Picture on_white = draw(lit, white);
    for (std::size_t i = 0; i < alone.alpha.size(); ++i)
        if (alone.pixels[i] == glm::vec3(0.0f) && alone.alpha[i] > 0.0f) {
            const glm::vec3 left = on_white.pixels[i];
            EXPECT_NEAR((left.r + left.g + left.b) / 3.0f, 1.0f - alone.alpha[i], 1e-5f);
        }
}

/// What a picture shows of the ground below an eye and of the sky above it.
std::array<glm::vec3, 2> ground_and_sky(const LitScene& lit) {
    const Lighting lighting = lit.lighting();
    const relight::Backdrop seen =
        on_floor(relight::map_backdrop(lighting.behind()), lit.scene(), lighting, FloorLook::Photo,
                 glm::vec3(0.0f, 3.0f, 4.0f));
    return {seen(glm::normalize(glm::vec3(0.2f, -1.0f, -0.3f))),
            seen(glm::normalize(glm::vec3(0.2f, 0.5f, -1.0f)))};
}

TEST_F(Output, ThePhotographedGroundTakesTheLightOfLayersAndLists) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f, .no_refine = true}));
    lit.light(sunny());
    const glm::vec3 open = *lit.lighting().open_floor;
    std::array<glm::vec3, 2> before{};
    const auto expect_factors = [&](float ground, float sky) {
        const std::array<glm::vec3, 2> now = ground_and_sky(lit);
        EXPECT_NEAR(now[0].g, ground * before[0].g, 3e-3f * ground * before[0].g);
        EXPECT_NEAR(now[1].g, sky * before[1].g, 1e-4f * before[1].g);
    };
    for (const double turn : {90.0, 0.0}) {
        set_layers(lit, {});
        set_rotation(lit, turn);
        before = ground_and_sky(lit);
        // The sun is flagged: the ground lies in the shade as the asset does.
        cubemap::LightLayer flag;
        flag.region =
            cubemap::Disc{.direction = cubemap::texel_direction(cubemap::Face::PositiveY, 3, 4, 16),
                          .radius_degrees = 25.0};
        flag.effect = cubemap::Gain{.factor = 0.0f};
        set_layers(lit, {flag});
        const float shade = lit.lighting().open_floor->g / open.g;
        EXPECT_LT(shade, 0.8f);
        expect_factors(shade, 1.0f);
        // What dims the ground itself is seen once.
        flag.region = cubemap::Disc{.direction = {0, 1, 0}, .radius_degrees = 180.0};
        flag.effect = cubemap::Gain{.factor = 0.5f};
        set_layers(lit, {flag});
        expect_factors(0.5f, 0.5f);
    }
    set_layers(lit, {});
    Light both{sunny()};
    both.lights = {{.direction = {0, 1, 0}, .irradiance = glm::dvec3(3.0)}};
    lit.light(std::move(both));
    EXPECT_GT(lit.lighting().open_gain.g, 1.0f);
    expect_factors(lit.lighting().open_floor->g / open.g, 1.0f);
}

TEST_F(Output, TheFloorIsGreyWhereNoGroundIsKnown) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f, .no_refine = true}));
    lit.light(sunny());
    EXPECT_EQ(floor_look(lit.scene(), lit.lighting()), FloorLook::Photo);
    EXPECT_EQ(floor_look(lit.scene(), lit.lighting(), {.floor = FloorLook::Grey}), FloorLook::Grey);
    lit.light(cubemap::CubeMap(8, glm::vec3(1.0f)));
    EXPECT_EQ(floor_look(lit.scene(), lit.lighting()), FloorLook::Studio);
    lit.light(std::vector<lights::DistantLight>{{.direction = {0, 1, 0}, .irradiance = {1, 1, 1}}});
    EXPECT_EQ(floor_look(lit.scene(), lit.lighting()), FloorLook::Grey);
    EXPECT_EQ(floor_look(lit.scene(), lit.lighting(), {.background = glm::vec3(1.0f)}),
              FloorLook::Photo);
}

TEST_F(Output, ExposureIsThatOfTheMeshAndNotOfItsFloor) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f, .no_refine = true}));
    lit.light(sunny());
    const auto exposure = [&](float albedo) {
        return Painter(lit, {.floor = FloorLook::Grey,
                             .floor_albedo = glm::vec3(albedo),
                             .background = glm::vec3(0.0f)})
            .choose_exposure_ev(lit.lighting());
    };
    EXPECT_EQ(exposure(0.05f), exposure(5.0f));
}

const Camera LookingDown{
    .eye = {1.0f, 2.0f, 4.0f}, .target = {0.0f, 0.2f, 0.0f}, .fov_degrees = 30};

TEST_F(Output, ExposureMetersTheLightOfADarkAsset) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f, .no_refine = true}));
    lit.light(cubemap::CubeMap(8, glm::vec3(4.0f)));
    const auto exposure = [&](float albedo) {
        return Painter(lit, {.albedo = glm::vec3(albedo), .background = glm::vec3(0.0f)})
            .choose_exposure_ev(lit.lighting());
    };
    const double least = exposure(relight::LeastMeteredAlbedo);
    EXPECT_NEAR(least, exposure(1.0f) + 2.0, 0.02);
    for (const float dark : {0.1f, 1e-2f, 1e-7f, 0.0f})
        EXPECT_EQ(exposure(dark), least) << dark;
}

TEST_F(Output, ExposureBrightensNoRoundings) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f, .no_refine = true}));
    lit.light(cubemap::CubeMap(8, glm::vec3(4.0f)));
    // As inside of a room that lets no more light through than roundings do.
    const std::vector<glm::vec3> rounded(lit.radiance().size(), glm::vec3(1e-7f));
    Lighting lighting = lit.lighting();
    lighting.radiance = lighting.arriving = rounded;
    lighting.lights.clear();
    EXPECT_NEAR(Painter(lit, {.background = glm::vec3(0.0f)}).choose_exposure_ev(lighting),
                12.0 - 2.0, 0.02);
}

TEST_F(Output, PixelsOfADarkAssetAreMeteredAsItsVertices) {
    LitScene lit(precompute(standing(4.0f), {.tolerance = 0.1f,
                                             .receivers = Pixels{.width = 40, .height = 30},
                                             .view = View{.camera = LookingDown}}));
    lit.light(cubemap::CubeMap(8, glm::vec3(4.0f)));
    const auto exposure = [&](float albedo) {
        return Painter(lit, {.albedo = glm::vec3(albedo), .background = glm::vec3(0.0f)})
            .choose_exposure_ev(lit.lighting());
    };
    EXPECT_EQ(exposure(1e-3f), exposure(relight::LeastMeteredAlbedo));
    EXPECT_NEAR(exposure(1e-3f), exposure(1.0f) + 2.0, 0.02);
}

/// A dark post on a floor, under a lamp that the picture does not show.
Scene post_under_lamp(const ReceiverChoice& receivers) {
    Mesh mesh(scenes::joined(scenes::box({-0.1f, 0.0f, -0.1f}, {0.1f, 1.2f, 0.1f}),
                             scenes::box({-0.3f, 2.5f, -0.3f}, {0.3f, 2.6f, 0.3f})));
    mesh.geometry.materials = {{.name = "post", .base_color = glm::vec3(0.1f)},
                               {.name = "lamp", .emission = glm::vec3(800.0f)}};
    mesh.geometry.triangle_materials.assign(24, 0);
    std::fill_n(mesh.geometry.triangle_materials.begin() + 12, 12, 1u);
    mesh::append_floor(mesh.geometry, 24, 6.0f);
    mesh.floor_vertices = 24;
    PrecomputeOptions options{.tolerance = 0.2f, .receivers = receivers, .no_refine = true};
    if (std::holds_alternative<Pixels>(receivers))
        options.view = View{.camera = LookingDown};
    return precompute(std::move(mesh), options);
}

/// The post under a dim sky, by its vertices or by the pixels of the picture.
LitScene lit_post(const ReceiverChoice& receivers) {
    LitScene lit(post_under_lamp(receivers));
    lit.light(cubemap::CubeMap(8, glm::vec3(0.05f)));
    return lit;
}
const std::array<ReceiverChoice, 2> PostReceivers = {Vertices{}, Pixels{.width = 80, .height = 60}};
const OutputOptions OfPost = {
    .width = 80, .height = 60, .samples_per_axis = 1, .camera = LookingDown};

/// Its exposure is metered before a ground that a cut-out does not show.
TEST_F(Output, ALampOnThePhotographIsCutOut) {
    for (const ReceiverChoice& receivers : PostReceivers) {
        const LitScene lit = lit_post(receivers);
        OutputOptions options = OfPost;
        options.floor = FloorLook::Photo;
        options.background = NothingBehind{};
        Painter painter(lit, options);
        EXPECT_TRUE(std::isfinite(painter.choose_exposure_ev(lit.lighting())));
        const Picture picture = painter.draw(lit.lighting());
        EXPECT_EQ(picture.alpha.size(), picture.pixels.size());
        EXPECT_EQ(*std::ranges::max_element(picture.alpha), 1.0f);
    }
}

TEST_F(Output, ExposureDoesNotBurnAFloorUnderLamps) {
    for (const ReceiverChoice& receivers : PostReceivers) {
        const LitScene lit = lit_post(receivers);
        OutputOptions options = OfPost;
        options.floor = FloorLook::Grey;
        options.floor_albedo = glm::vec3(0.5f);
        options.background = glm::vec3(0.0f);
        const auto bright_share = [&](double ev) {
            const Picture picture = draw(lit, options);
            const auto num_bright = std::count_if(
                picture.pixels.begin(), picture.pixels.end(), [&](const glm::vec3& pixel) {
                    const float brightest = std::max({pixel.r, pixel.g, pixel.b});
                    return std::exp2(ev) * double{brightest} > 1.45;
                });
            return static_cast<double>(num_bright) / static_cast<double>(picture.pixels.size());
        };
        const double with_lamp = Painter(lit, options).choose_exposure_ev(lit.lighting());
        EXPECT_LT(bright_share(with_lamp), 0.03);
        EXPECT_GT(bright_share(with_lamp + 1.0), 0.03);
    }
}

// What a window shows may burn out, or the room would be dark.
TEST_F(Output, ExposureOfARoomIsThatOfItsWalls) {
    const mesh::TriangleMesh room = data_gen::painted_room(2000);
    const cubemap::CubeMap white(8, glm::vec3(1.0f));
    const auto exposure = [&](const Scene& scene, const Background& background) {
        LitScene lit(scene);
        lit.light(white);
        return Painter(lit, {.background = background}).choose_exposure_ev(lit.lighting());
    };
    const Scene vertices =
        precompute(room, {.tolerance = 0.1f, .no_refine = true, .bounce_tolerance = 0.0f});
    const double of_walls = exposure(vertices, glm::vec3(0.0f));
    EXPECT_EQ(exposure(vertices, EnvironmentBehind{}), of_walls);
    EXPECT_GT(of_walls, 0.6);
    const Scene pixels =
        precompute(room, {.tolerance = 0.1f,
                          .receivers = Pixels{.width = 32, .height = 24},
                          .no_refine = true,
                          .view = View{.camera = camera_of(vertices, OutputOptions{})},
                          .bounce_tolerance = 0.0f});
    EXPECT_EQ(exposure(pixels, EnvironmentBehind{}), exposure(pixels, glm::vec3(0.0f)));
}

TEST_F(Output, TheCameraIsThatOfTheFileOrInsideOfARoom) {
    Mesh mesh(scenes::corner(3));
    mesh.camera = Camera{.eye = {5, 6, 7}, .target = {0, 1, 0}, .fov_degrees = 41.0f};
    const Scene scene = unclustered_scene(mesh);
    EXPECT_EQ(camera_of(scene, OutputOptions{}), *mesh.camera);
    EXPECT_EQ(camera_of(scene, OutputOptions{.fov_degrees = 20.0f}).fov_degrees, 20.0f);
    EXPECT_EQ(camera_of(scene, OutputOptions{.eye = glm::vec3(1.0f)}).eye, glm::vec3(1.0f));
    const Camera asked = camera_of(scene, OutputOptions{.camera_place = CameraPlace{}});
    EXPECT_EQ(asked, relight::framed(scene.mesh));
    const Scene room = unclustered_scene(data_gen::painted_room(2000));
    const Camera inside = camera_of(room, OutputOptions{});
    const mesh::Bounds box = mesh::bounds(room.mesh);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT(inside.eye[axis], box.min[axis]);
        EXPECT_LT(inside.eye[axis], box.max[axis]);
    }
    EXPECT_GT(inside.fov_degrees, 50.0f);
    EXPECT_EQ(camera_of(room, OutputOptions{.eye = glm::vec3(1.0f)}).fov_degrees, 35.0f)
        << "as for any other eye";
    EXPECT_EQ(
        camera_of(room, OutputOptions{.eye = glm::vec3(1.0f), .fov_degrees = 50.0f}).fov_degrees,
        50.0f);
}

TEST_F(Output, HighlightsKeepTextures) {
    mesh::TriangleMesh square = scenes::textured_square();
    for (mesh::Material& material : square.materials) {
        material.model = mesh::MaterialModel::MetallicRoughness;
        material.metallic = 0.0f;
        material.roughness = 0.5f;
    }
    const Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.072487f};
    LitScene lit(precompute(square, {.tolerance = 0.1f, .view = View{.camera = camera}}));
    lit.light(sunny());
    const Picture picture = draw(lit, {.width = 8, .height = 8, .samples_per_axis = 1});
    const glm::vec3* row = picture.pixels.data() + 32;
    EXPECT_GT(row[2].r, 1.5f * row[2].g);
    EXPECT_GT(row[4].g, 1.5f * row[4].r);
    EXPECT_FALSE(is_other_eye(lit.scene(), {}));
    EXPECT_TRUE(is_other_eye(lit.scene(), {.camera_place = CameraPlace{}}));
}

} // namespace
} // namespace relumine
