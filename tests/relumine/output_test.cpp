#include "relumine/output.h"

#include <cmath>
#include <vector>

#include "cubemap/image/environment.h"
#include "mesh/load.h"
#include "tests/relight/environments.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class Output : public scenes::InFolder {
protected:
    static LitScene lit(const PrecomputeOptions& options = {.tolerance = 0.2f}) {
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
    EXPECT_EQ(mesh::load(file("lit.ply")).colors,
              colors_of(scene.scene(), scene.radiance(), glm::vec3(0.5f)));
    for (const char* name : {"lit.png", "lit.glb", "lit.npy"}) {
        save(scene, file(name), {.width = 8, .height = 4});
        EXPECT_GT(std::filesystem::file_size(file(name)), 50u) << name;
    }
    EXPECT_THROW(save(scene, file("lit.jpg")), std::invalid_argument);
    EXPECT_THROW(save(scene, file("absent/lit.png"), {.width = 8, .height = 4}),
                 std::runtime_error);
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

} // namespace
} // namespace relumine
