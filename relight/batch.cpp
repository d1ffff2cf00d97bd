#include "relight/batch.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "files/parallel.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

/// As many as are worth reading a tile of the transfer for: more gain little.
constexpr std::size_t GroupSize = 8;

/// The light of one environment, ready for the receivers.
struct BatchLight {
    ClusterLights clusters;
    TracedLight traced;

    BatchLight(const Relighter& relighter, BinnedEnvironment binned)
        : clusters(relighter.transfer().num_clusters()),
          traced(relighter.transfer(), relighter.shadow_rays()) {
        const ClusterSums sums{.all = binned.sums, .sharp = binned.sharp_lights};
        files::parallel_for(
            files::IndexRange<std::size_t>(0, clusters.spread.size()), [&](const auto& words) {
                const std::size_t end = std::min(words.end() * 64, sums.all.size());
                for (std::size_t cluster = words.begin() * 64; cluster < end; ++cluster)
                    clusters.set(cluster, sums.without_sharp(cluster));
            });
        clusters.sum_prefix();
        traced.trace(binned.sharp_lights);
    }
};

/// Writes the radiance of a block.
void write_block(const prt::Transfer& transfer, const BlockRadiance& sums, std::size_t block,
                 std::span<glm::vec3> radiance) {
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t end = std::min(begin + prt::BlockSize, transfer.num_receivers());
    for (std::size_t place = begin; place < end; ++place) {
        glm::vec3& value = radiance[transfer.order[place]];
        value = sums.of(place - begin);
        if (!transfer.surfaces.empty())
            value = prt::reflect(transfer.surfaces[place], {.diffuse = value}, 0.0f);
    }
}

} // namespace

void relight_batch(const Relighter& relighter, std::span<const cubemap::CubeMap> environments,
                   std::span<glm::vec3> radiance) {
    const prt::Transfer& transfer = relighter.transfer();
    const std::size_t num_receivers = transfer.num_receivers();
    if (radiance.size() != environments.size() * num_receivers)
        throw std::invalid_argument(fmt::format("expected room for {} radiances, got {}",
                                                environments.size() * num_receivers,
                                                radiance.size()));
    if (transfer.glossy)
        throw std::invalid_argument("expected receivers without highlights, got some with");
    if (transfer.have_no_surface)
        throw std::invalid_argument("expected receivers on surfaces, got points in space");
    const BlockScene scene = relighter.receiver_light().block_scene();
    EnvironmentBinner binner = binner_of(relighter);
    std::vector<BlockLight> scratch(scene.counts.num_blocks());
    for (std::size_t first = 0; first < environments.size(); first += GroupSize) {
        std::vector<std::unique_ptr<BatchLight>> lights;
        for (const cubemap::CubeMap& map :
             environments.subspan(first, std::min(GroupSize, environments.size() - first)))
            lights.push_back(std::make_unique<BatchLight>(relighter, binner.bin(map)));
        files::parallel_for(std::size_t{0}, scene.counts.num_tiles(), [&](std::size_t tile) {
            for (std::size_t i = 0; i < lights.size(); ++i) {
                light_tile(scene, tile, lights[i]->clusters, scratch);
                for (std::size_t block = scene.counts.tile_begin(tile);
                     block < scene.counts.tile_begin(tile + 1); ++block) {
                    BlockRadiance sums;
                    static_cast<void>(block_radiance(scene.normals[block], scratch[block],
                                                     lights[i]->traced.diffuse(block), sums));
                    write_block(transfer, sums, block,
                                radiance.subspan((first + i) * num_receivers, num_receivers));
                }
            }
        });
    }
}

} // namespace relumine::relight
