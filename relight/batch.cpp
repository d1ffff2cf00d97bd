#include "relight/batch.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "files/parallel.h"
#include "relight/kernels/batch_kernel.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

/// Sets the light of the clusters, and traces the sharp lights.
void set_light(const BinnedEnvironment& binned, ClusterLights& clusters, TracedLight& traced) {
    const ClusterSums sums{.all = binned.sums, .sharp = binned.sharp_lights};
    files::parallel_for(files::IndexRange<std::size_t>(0, clusters.spread.size()),
                        [&](const auto& words) {
                            const std::size_t end = std::min(words.end() * 64, sums.all.size());
                            for (std::size_t cluster = words.begin() * 64; cluster < end; ++cluster)
                                clusters.set(cluster, sums.without_sharp(cluster));
                        });
    traced.trace(binned.sharp_lights);
}

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
    if (transfer.num_points != 0)
        throw std::invalid_argument("expected receivers on surfaces, got points in space");
    const BlockScene scene = relighter.receiver_light().block_scene();
    EnvironmentBinner binner = binner_of(relighter);
    BatchLights lights(transfer.num_clusters());
    std::vector<TracedLight> traced;
    for (std::size_t k = 0; k < BatchLights::Most; ++k)
        traced.emplace_back(transfer, relighter.shadow_rays());
    for (std::size_t first = 0; first < environments.size(); first += BatchLights::Most) {
        lights.size = std::min(BatchLights::Most, environments.size() - first);
        for (std::size_t k = 0; k < lights.size; ++k)
            set_light(binner.bin(environments[first + k]), lights.each[k], traced[k]);
        lights.compare_and_sum();
        files::parallel_for(std::size_t{0}, scene.counts.num_tiles(), [&](std::size_t tile) {
            constexpr std::size_t TileBlocks = prt::VisibleCounts::TileBlocks;
            std::vector<BlockLight> light(BatchLights::Most * TileBlocks);
            light_tile(scene, tile, lights, light);
            const std::size_t begin = scene.counts.tile_begin(tile);
            for (std::size_t k = 0; k < lights.size; ++k)
                for (std::size_t block = begin; block < scene.counts.tile_begin(tile + 1);
                     ++block) {
                    BlockRadiance sums;
                    static_cast<void>(block_radiance(scene.normals[block],
                                                     light[k * TileBlocks + block - begin],
                                                     traced[k].diffuse(block), sums));
                    write_block(transfer, sums, block,
                                radiance.subspan((first + k) * num_receivers, num_receivers));
                }
        });
    }
}

} // namespace relumine::relight
