#include "relight/pictures/floor_shadows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/receivers/mesh_point.h"

namespace relumine::relight {
namespace {

/// A sheet at a height above the floor, over all points with x < 0.
class HalfPlane : public prt::Blockers {
public:
    static constexpr float Height = 1.0f;

    std::uint32_t occluded(const glm::vec3& origin, const prt::DirectionPacket& directions,
                           std::uint32_t active) const override {
        std::uint32_t result = 0;
        for (std::uint32_t i = 0; i < prt::PacketSize; ++i) {
            const glm::vec3 w = directions.direction(i);
            const float x = origin.x + (Height - origin.y) / w.y * w.x;
            result |= static_cast<std::uint32_t>(w.y > 0.0f && x < 0.0f) << i;
        }
        return result & active;
    }
};

/// A soft box in the zenith, of cells of radiance 1: |x / y| and |z / y| of its directions are
/// below 1/8, 7 degrees.
std::vector<SharpLight> box_in_zenith() {
    std::vector<SharpLight> lights;
    for (std::uint32_t y = 14; y < 18; ++y)
        for (std::uint32_t x = 14; x < 18; ++x) {
            const prt::Cell cell{cubemap::Face::PositiveY, 5, x, y};
            const double s = cell.size();
            const double power = cubemap::solid_angle(x * s, y * s, (x + 1) * s, (y + 1) * s);
            const glm::dvec3 w = cubemap::direction(cell.face, (x + 0.5) * s, (y + 0.5) * s);
            lights.push_back({.cluster = 0,
                              .cell = cell,
                              .direction = w,
                              .irradiance = {power * w, power * w, power * w}});
        }
    return lights;
}

TEST(FloorShadows, OfAnEdgeUnderASoftBoxFallEvenly) {
    mesh::TriangleMesh mesh;
    mesh.positions = {
        {-1.0f, 0.0f, -1.0f}, {-1.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 1.0f}, {1.0f, 0.0f, -1.0f}};
    mesh.normals.assign(4, {0.0f, 1.0f, 0.0f});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const prt::RayScene rays(mesh);
    const prt::Camera camera{.eye = {0.3f, 2.0f, 0.5f}, .target = {0.0f, 0.0f, 0.0f}};
    const PictureTiles tiles{.width = 75, .height = 65};
    const prt::PictureRays grid(camera, tiles.width, tiles.height, 3);
    const FadingFloor floor{.first_vertex = 0};
    const SeenMesh seen_mesh(mesh, rays, {}, camera.eye);
    const EyeSamples samples(seen_mesh, rays, camera.eye, grid, tiles, 0, {});
    const FloorLights lights(box_in_zenith(), grid.samples_per_pixel());
    EXPECT_LE(lights.beams().size(), 4u) << "beams reach 8 degrees";
    float whole = 0.0f;
    for (const FloorLights::Beam& beam : lights.beams())
        whole += beam.whole.r;
    // Of directions (x, z) / y, the light on a level floor is even but for a power of the cosine.
    EXPECT_NEAR(whole, 1.0 / 16.0 / std::numbers::pi, 0.03 * whole);
    const HalfPlane blockers;
    FloorShadows shadows(mesh, floor, blockers, 0.0f, lights);
    std::size_t num_dark = 0, num_grey = 0, num_lit = 0;
    double largest = 0.0, sum = 0.0;
    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile) {
        const SampleRectangle seen = samples.of(tile, FloorShadows::Reach);
        const PixelRectangle inner = tiles.pixels(tile, 0);
        shadows.trace(seen, inner);
        for (std::uint32_t y = inner.top; y < inner.bottom; ++y)
            for (std::uint32_t x = inner.left; x < inner.right; ++x) {
                const std::span<const EyeSample> own = seen.pixel(x, y);
                if (!std::all_of(own.begin(), own.end(),
                                 [](const EyeSample& sample) { return sample.hits(); }))
                    continue;
                float seen_part = 0.0f;
                for (const EyeSample& sample : own) {
                    const float at = prt::value_at(mesh, mesh.positions, sample.point()).x;
                    seen_part +=
                        std::clamp(0.5f + 4.0f * at / HalfPlane::Height, 0.0f, 1.0f) / 9.0f;
                }
                seen_part = std::min(seen_part, 1.0f);
                ++(seen_part == 0.0f ? num_dark : seen_part > 0.9999f ? num_lit : num_grey);
                const double error = shadows.of(x, y).r / whole - seen_part;
                largest = std::max(largest, std::abs(error));
                sum += error;
            }
    }
    EXPECT_GT(num_dark, 500u);
    EXPECT_GT(num_lit, 500u);
    EXPECT_GT(num_grey, 500u);
    // Rows of 16 lights alone would be off by an eighth.
    EXPECT_LT(largest, 0.04);
    EXPECT_LT(std::abs(sum), 0.005 * static_cast<double>(num_grey));
}

} // namespace
} // namespace relumine::relight
