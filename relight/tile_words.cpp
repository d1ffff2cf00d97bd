#include "relight/tile_words.h"

#include <array>
#include <bit>

#include <tbb/parallel_for.h>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/tile_words.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Corners of a cell: x, y, z of four directions.
constexpr std::size_t CornerFloats = 12;

/// Whether every receiver with a count has all four corners above its horizon, and so the whole
/// cell.
bool sees_only_above(const std::uint8_t* counts, const BlockNormals& normals,
                     const float* corners) {
    const hn::CappedTag<float, prt::BlockSize> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    for (std::size_t lane = 0; lane < prt::BlockSize; lane += hn::Lanes(d)) {
        const auto x = hn::LoadU(d, normals.axes[0].data() + lane);
        const auto y = hn::LoadU(d, normals.axes[1].data() + lane);
        const auto z = hn::LoadU(d, normals.axes[2].data() + lane);
        auto lowest = hn::Set(d, 1.0f);
        for (const float* corner = corners; corner < corners + CornerFloats; corner += 3) {
            const auto along_z = hn::Mul(z, hn::Set(d, corner[2]));
            const auto along_yz = hn::MulAdd(y, hn::Set(d, corner[1]), along_z);
            lowest = hn::Min(lowest, hn::MulAdd(x, hn::Set(d, corner[0]), along_yz));
        }
        const auto count = hn::PromoteTo(integers, hn::LoadU(bytes, counts + lane));
        const auto counted = hn::RebindMask(d, hn::Gt(count, hn::Zero(integers)));
        if (!hn::AllFalse(d, hn::And(counted, hn::Lt(lowest, hn::Zero(d)))))
            return false;
    }
    return true;
}

/// Whether sees_only_above() holds for all clusters in `mixed`. `counts` and `corners` begin at the
/// word's first entry and cluster.
bool needs_no_clamp(std::uint64_t mixed, const std::uint8_t* counts, const BlockNormals& normals,
                    const float* corners) {
    for (; mixed != 0; mixed &= mixed - 1, counts += prt::BlockSize) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(mixed));
        if (!sees_only_above(counts, normals, corners + bit * CornerFloats))
            return false;
    }
    return true;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {

HWY_EXPORT(needs_no_clamp);

std::vector<std::array<glm::vec3, 4>> corners_of(const prt::Quadtree& quadtree) {
    std::vector<std::array<glm::vec3, 4>> corners;
    corners.reserve(quadtree.leaves().size());
    for (const prt::Cell& cell : quadtree.leaves()) {
        std::array<glm::vec3, 4>& of_cell = corners.emplace_back();
        for (std::uint32_t i = 0; i < 4; ++i)
            of_cell[i] = glm::vec3(cubemap::direction(cell.face, (cell.x + (i & 1u)) * cell.size(),
                                                      (cell.y + (i >> 1u)) * cell.size()));
    }
    return corners;
}

} // namespace

std::vector<TileWord> tile_words(const prt::Transfer& transfer,
                                 std::span<const BlockNormals> normals) {
    const prt::VisibleCounts& counts = transfer.counts;
    const std::vector<std::array<glm::vec3, 4>> corners = corners_of(transfer.quadtree);
    const std::size_t num_words = counts.words_per_block();
    std::vector<TileWord> result(counts.num_tiles() * num_words);
    tbb::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
        const std::size_t begin = counts.tile_begin(tile);
        const std::size_t end = counts.tile_begin(tile + 1);
        for (std::size_t block = begin; block < end; ++block)
            for (std::size_t w = 0; w < num_words; ++w) {
                const std::size_t word = counts.word(block, w);
                const std::uint64_t bit = std::uint64_t{1} << (block - begin);
                TileWord& of_tile = result[tile * num_words + w];
                if (counts.visible[word] != 0)
                    of_tile.visible |= bit;
                if (counts.mixed[word] == 0)
                    continue;
                const bool unclamped = HWY_DYNAMIC_DISPATCH(needs_no_clamp)(
                    counts.mixed[word], counts.mixed_counts(word, 0), normals[block],
                    &corners[w * 64].front().x);
                (unclamped ? of_tile.unclamped : of_tile.clamped) |= bit;
            }
    });
    return result;
}

} // namespace relumine::relight
#endif // HWY_ONCE
