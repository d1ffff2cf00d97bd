#include "tests/bench/dense_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/dense_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// sums: [3][16]
void sum_block(const std::uint8_t* values, const glm::vec3* light, std::size_t num_clusters,
               float* sums) {
    const hn::CappedTag<float, prt::BlockSize> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        auto red = hn::Zero(d), green = red, blue = red;
        for (std::size_t cluster = 0; cluster < num_clusters; ++cluster) {
            const auto t = hn::ConvertTo(
                d, hn::PromoteTo(integers,
                                 hn::LoadU(bytes, values + cluster * prt::BlockSize + lane)));
            red = hn::MulAdd(t, hn::Set(d, light[cluster].r), red);
            green = hn::MulAdd(t, hn::Set(d, light[cluster].g), green);
            blue = hn::MulAdd(t, hn::Set(d, light[cluster].b), blue);
        }
        hn::StoreU(red, d, sums + lane);
        hn::StoreU(green, d, sums + prt::BlockSize + lane);
        hn::StoreU(blue, d, sums + 2 * prt::BlockSize + lane);
    }
}

} // namespace relumine::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::bench {

HWY_EXPORT(sum_block);

DenseTable dense_table(const prt::Transfer& transfer) {
    const prt::VisibleCounts& counts = transfer.counts;
    DenseTable table{.num_clusters = transfer.num_clusters(), .num_blocks = counts.num_blocks()};
    table.values.resize(table.num_blocks * table.num_clusters * prt::BlockSize);
    table.scale = static_cast<float>(1.0 / (255.0 * std::numbers::pi));
    std::vector<glm::vec3> directions;
    for (const prt::Cell& cell : transfer.quadtree.leaves())
        directions.emplace_back(cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                                   (cell.y + 0.5) * cell.size()));
    files::parallel_for(std::size_t{0}, table.num_blocks, [&](std::size_t block) {
        const std::size_t begin = block * prt::BlockSize;
        const std::size_t end = std::min(begin + prt::BlockSize, transfer.num_receivers());
        std::uint8_t* value = table.values.data() + block * table.num_clusters * prt::BlockSize;
        for (std::size_t cluster = 0; cluster < table.num_clusters;
             ++cluster, value += prt::BlockSize)
            for (std::size_t place = begin; place < end; ++place) {
                const float cosine =
                    std::clamp(glm::dot(transfer.normals[place], directions[cluster]), 0.0f, 1.0f);
                value[place - begin] = static_cast<std::uint8_t>(std::lround(
                    255.0f / 16.0f * cosine * static_cast<float>(counts.count(place, cluster))));
            }
    });
    return table;
}

void relight(const DenseTable& table, std::span<const glm::vec3> light,
             std::vector<glm::vec3>& radiance) {
    radiance.resize(table.num_blocks * prt::BlockSize);
    files::parallel_for(
        files::IndexRange<std::size_t>(0, table.num_blocks, 16), [&](const auto& blocks) {
            for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                std::array<float, 3 * prt::BlockSize> sums;
                HWY_DYNAMIC_DISPATCH(sum_block)
                (table.values.data() + block * table.num_clusters * prt::BlockSize, light.data(),
                 table.num_clusters, sums.data());
                for (std::size_t i = 0; i < prt::BlockSize; ++i)
                    radiance[block * prt::BlockSize + i] =
                        table.scale *
                        glm::vec3(sums[i], sums[prt::BlockSize + i], sums[2 * prt::BlockSize + i]);
            }
        });
}

} // namespace relumine::bench
#endif // HWY_ONCE
