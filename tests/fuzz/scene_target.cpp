#include "tests/fuzz/scene_target.h"

#include <algorithm>

#include "cubemap/cube_map.h"
#include "prt/transfer/quadtree.h"
#include "relight/bounces/bounce_light.h"
#include "relight/relighter.h"
#include "tests/fuzz/fuzz.h"

namespace relumine::fuzz {

namespace {

/// Under light of about 1, highlights within the limits of a file reflect no more than this.
constexpr float MaxReflected = 1e12f;

void require_moderate(std::span<const glm::vec3> radiance) {
    for (const glm::vec3& value : radiance)
        for (int channel = 0; channel < 3; ++channel)
            require(value[channel] >= 0.0f && value[channel] <= MaxReflected,
                    "radiance is finite, not negative and moderate");
}

} // namespace

void require_sound(const prt::Scene& scene) {
    const prt::Transfer& transfer = scene.transfer;
    const std::size_t num_receivers = scene.receivers.size();
    require(transfer.num_receivers() == num_receivers && transfer.normals.size() == num_receivers,
            "the transfer is of the receivers");
    for (const mesh::Triangle& triangle : scene.mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            require(vertex < scene.mesh.num_vertices(), "triangles are of vertices");
    const std::size_t num_pairs = num_receivers * transfer.num_clusters();
    const bool is_deep =
        transfer.glossy && transfer.glossy->deepest_level() > 4; // 12 MB and more of light
    if (num_receivers == 0 || num_pairs > 100'000 || is_deep)
        return;
    for (std::size_t place = 0; place < num_receivers; ++place)
        for (std::size_t leaf = 0; leaf < transfer.num_clusters(); ++leaf) {
            const int count = transfer.counts.count(place, leaf);
            require(count >= 0 && count <= 16, "counts are 0 to 16");
        }
    relight::Relighter relighter(transfer);
    cubemap::CubeMap map(4);
    std::fill(map.texels.begin(), map.texels.end(), glm::vec3(1.0f, 0.5f, 2.0f));
    relighter.set_environment(std::move(map));
    require(relighter.radiance().size() == num_receivers, "every receiver has a radiance");
    require_moderate(relighter.radiance());
    const std::vector<glm::vec3> red(4, glm::vec3(1.0f, 0.0f, 0.0f));
    update_region(relighter, {.face = cubemap::Face::PositiveY, .x0 = 1, .y0 = 1, .x1 = 3, .y1 = 3},
                  red);
    require_moderate(relighter.radiance());
    if (!scene.bounces)
        return;
    relight::BounceLight light(*scene.bounces, transfer);
    light.set_albedo(std::vector(num_receivers, glm::vec3(0.5f)));
    light.solve(relighter.diffuse_radiance());
    require_moderate(light.indirect());
    light.step(relighter.diffuse_radiance());
    require_moderate(light.indirect());
}

} // namespace relumine::fuzz
