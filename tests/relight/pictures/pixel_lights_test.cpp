#include "relight/pictures/pixel_lights.h"

#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relight/sharp/light_packets.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

/// A sun of 20 parts and a lamp of 5 on the other side.
std::vector<SharpLight> sun_and_lamp() {
    std::vector<SharpLight> lights;
    for (int i = 0; i < 25; ++i) {
        const double step = 0.002 * i;
        const glm::dvec3 w = glm::normalize(i < 20 ? glm::dvec3(1.0, 1.0 + step, 0.4 - step)
                                                   : glm::dvec3(-1.0, 0.7 + step, 0.2));
        lights.push_back({.direction = w, .irradiance = {w, w, w}});
    }
    return lights;
}

TEST(PixelLights, AreThoseOfRaysOneByOne) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const prt::RayScene rays(mesh);
    const std::vector<SharpLight> lights = sun_and_lamp();
    const LightPackets packets(lights);
    const LightBeams beams(lights);
    ASSERT_EQ(beams.num_packets(), packets.num_packets());
    constexpr float Bias = 1e-4f;
    const ShadowRays shadow_rays{.blockers = &rays, .bias = Bias};
    const prt::Camera camera{.eye = {2.5f, 2.0f, 3.5f}, .target = {0.0f, 0.4f, 0.0f}};
    const PictureTiles tiles{.width = 96, .height = 64};
    const prt::PictureRays grid(camera, tiles.width, tiles.height, 3);
    const SeenMesh seen_mesh(mesh, rays, {}, camera.eye);
    const EyeSamples samples(seen_mesh, rays, camera.eye, grid, tiles, 0, {});
    PixelLights pixel_lights(mesh, rays, rays, Bias, beams);
    std::vector<std::uint16_t> expected(packets.num_packets());
    std::size_t num_even = 0, num_uneven = 0, num_wrong = 0, num_rays = 0;
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const SampleRectangle seen = samples.of(tile, 1);
        const PixelRectangle inner = tiles.pixels(tile, 0);
        pixel_lights.trace(seen, inner);
        for (std::uint32_t y = inner.top; y < inner.bottom; ++y)
            for (std::uint32_t x = inner.left; x < inner.right; ++x) {
                const bool is_even = pixel_lights.is_even(x, y);
                ++(is_even ? num_even : num_uneven);
                for (std::size_t i = 0; i < 9; ++i) {
                    const EyeSample& sample = seen.pixel(x, y)[i];
                    if (!sample.hits() || (is_even && i != 4))
                        continue;
                    packets.visible(prt::smooth_position(mesh, sample.point()),
                                    prt::mapped_normal(mesh, sample.point()), shadow_rays,
                                    expected);
                    const std::span<const std::uint16_t> found = pixel_lights.of(x, y, i);
                    ++num_rays;
                    num_wrong +=
                        std::equal(expected.begin(), expected.end(), found.begin()) ? 0 : 1;
                }
            }
    }
    EXPECT_GT(num_even, 1'000u);
    EXPECT_GT(num_uneven, 200u);
    // A shadow may lie between the middles of pixels.
    EXPECT_LE(num_wrong, num_rays / 200);
}

} // namespace
} // namespace relumine::relight
