#include "relight/kernels/tile_words.h"

#include <algorithm>
#include <array>
#include <bit>

#include <glm/geometric.hpp>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/tile_words.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"
#include "prt/visibility/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Clusters of a word.
constexpr std::size_t WordClusters = 64;
/// Corners of a cell: x, y, z of four directions.
constexpr std::size_t CornerFloats = 12;

/// Whether a receiver has one of the cell's four corners below its horizon.
bool lies_across(const BlockNormals& normals, const float* corners) {
    const hn::CappedTag<float, prt::BlockSize> d;
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
        if (!hn::AllFalse(d, hn::Lt(lowest, hn::Zero(d))))
            return true;
    }
    return false;
}

/// Returns the clusters of a word whose cells may reach below the horizon of a receiver of the
/// block. `bounds` are x, y, z and radius of the word's first cell, `stride` floats apart.
std::uint64_t near_horizon(const float* bounds, std::size_t stride, const glm::vec3& normal,
                           float normal_length, float normal_radius) {
    // Float sums of four terms err by less than this.
    constexpr float Slack = 1e-6f;
    const hn::CappedTag<float, 16> d;
    std::uint64_t near = 0;
    for (std::size_t i = 0; i < WordClusters; i += hn::Lanes(d)) {
        // n.w over the cell and the normals is at least n.c - |n| radius of the cell - radius of
        // the normals.
        const auto along_z = hn::Mul(hn::Set(d, normal.z), hn::LoadU(d, bounds + 2 * stride + i));
        const auto along_yz =
            hn::MulAdd(hn::Set(d, normal.y), hn::LoadU(d, bounds + stride + i), along_z);
        const auto cosine = hn::MulAdd(hn::Set(d, normal.x), hn::LoadU(d, bounds + i), along_yz);
        const auto lowest =
            hn::NegMulAdd(hn::Set(d, normal_length), hn::LoadU(d, bounds + 3 * stride + i), cosine);
        const auto mask = hn::Lt(lowest, hn::Set(d, normal_radius + Slack));
        near |= std::uint64_t{prt::HWY_NAMESPACE::bits_of(d, mask)} << i;
    }
    return near;
}

/// Returns the clusters of `near` that lie across a horizon of the block.
std::uint64_t across_of(std::uint64_t near, const BlockNormals& normals, const float* corners) {
    std::uint64_t across = 0;
    for (; near != 0; near &= near - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(near));
        if (lies_across(normals, corners + bit * CornerFloats))
            across |= std::uint64_t{1} << bit;
    }
    return across;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {

HWY_EXPORT(across_of);
HWY_EXPORT(near_horizon);

/// The cells' places on the sphere.
struct CellBounds {
    /// [num_clusters][4]
    std::vector<std::array<glm::vec3, 4>> corners;
    /// Floats of one array below: whole words.
    std::size_t stride;
    /// [4 * stride] x, y and z of the cells' centres, and the largest distance from a centre to a
    /// point of its cell.
    std::vector<float> bounds;

    explicit CellBounds(const prt::Quadtree& quadtree)
        : corners(quadtree.num_leaves()), stride((quadtree.num_leaves() + 63) / 64 * 64),
          bounds(4 * stride) {
        for (std::size_t leaf = 0; leaf < corners.size(); ++leaf) {
            const prt::Cell& cell = quadtree.leaves()[leaf];
            const auto at = [&](double x, double y) {
                return glm::vec3(cubemap::direction(cell.face, (cell.x + x) * cell.size(),
                                                    (cell.y + y) * cell.size()));
            };
            const glm::vec3 centre = at(0.5, 0.5);
            for (int axis = 0; axis < 3; ++axis)
                bounds[static_cast<std::size_t>(axis) * stride + leaf] = centre[axis];
            for (std::uint32_t i = 0; i < 4; ++i) {
                corners[leaf][i] = at(i & 1u, i >> 1u);
                float& radius = bounds[3 * stride + leaf];
                radius = std::max(radius, glm::distance(centre, corners[leaf][i]));
            }
        }
    }
};

/// The normals of a block differ from `mean` by at most `radius`.
struct NormalBounds {
    glm::vec3 mean{0.0f};
    float length = 0.0f;
    float radius = 0.0f;

    explicit NormalBounds(const BlockNormals& normals) {
        const auto normal = [&](std::size_t i) {
            return glm::vec3(normals.axes[0][i], normals.axes[1][i], normals.axes[2][i]);
        };
        float num_normals = 0.0f;
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            if (normal(i) != glm::vec3(0.0f)) {
                mean += normal(i);
                ++num_normals;
            }
        mean /= std::max(num_normals, 1.0f);
        length = glm::length(mean);
        // A zero normal has no horizon.
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            if (normal(i) != glm::vec3(0.0f))
                radius = std::max(radius, glm::distance(mean, normal(i)));
    }
};

} // namespace

TileWords tile_words(const prt::Transfer& transfer, std::span<const BlockNormals> normals) {
    TileWords result;
    result.words.resize(transfer.counts.num_tiles() * transfer.counts.words_per_block());
    update(result, transfer, normals,
           std::vector<std::uint64_t>(transfer.counts.num_tiles(), ~std::uint64_t{0}));
    return result;
}

void update(TileWords& result, const prt::Transfer& transfer, std::span<const BlockNormals> normals,
            std::span<const std::uint64_t> changed) {
    const prt::VisibleCounts& counts = transfer.counts;
    const CellBounds cells(transfer.quadtree);
    const std::size_t num_words = counts.words_per_block();
    // Where the entries of each tile begin.
    std::vector<std::ptrdiff_t> begins;
    for (std::size_t tile = 0; tile < counts.num_tiles(); ++tile)
        begins.push_back(static_cast<std::ptrdiff_t>(result.words[tile * num_words].across_before));
    begins.push_back(static_cast<std::ptrdiff_t>(result.across.size()));
    std::vector<std::vector<std::uint64_t>> across_of_tiles(counts.num_tiles());
    files::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
        const std::size_t begin = counts.tile_begin(tile);
        if (changed[tile] == 0) {
            across_of_tiles[tile].assign(result.across.begin() + begins[tile],
                                         result.across.begin() + begins[tile + 1]);
            for (std::size_t w = 0; w < num_words; ++w) {
                TileWord& of_tile = result.words[tile * num_words + w];
                of_tile.across_before -= static_cast<std::uint64_t>(begins[tile]);
                of_tile.mixed_before = counts.mixed_before[counts.word(begin, w)];
            }
            return;
        }
        const std::size_t end = counts.tile_begin(tile + 1);
        std::vector<std::uint64_t>& all_across = across_of_tiles[tile];
        std::vector<NormalBounds> blocks;
        for (std::size_t block = begin; block < end; ++block)
            blocks.emplace_back(normals[block]);
        std::vector<std::uint64_t> last(end - begin, 0); // of each block: the word before
        for (std::size_t w = 0; w < num_words; ++w) {
            TileWord& of_tile = result.words[tile * num_words + w];
            of_tile = {};
            of_tile.across_before = all_across.size();
            of_tile.mixed_before = counts.mixed_before[counts.word(begin, w)];
            of_tile.whole_for_all = ~std::uint64_t{0};
            const float* corners = &cells.corners[w * 64].front().x;
            for (std::size_t block = begin; block < end; ++block) {
                const std::size_t word = counts.word(block, w);
                const std::uint64_t bit = std::uint64_t{1} << (block - begin);
                std::uint64_t visible = counts.visible[word];
                of_tile.mixed_for_some |= counts.mixed[word];
                of_tile.seen_by_some |= visible;
                if (counts.mixed[word] != 0)
                    of_tile.mixed |= bit;
                if (visible != 0) {
                    const NormalBounds& of_block = blocks[block - begin];
                    const std::uint64_t near = HWY_DYNAMIC_DISPATCH(near_horizon)(
                        cells.bounds.data() + w * 64, cells.stride, of_block.mean, of_block.length,
                        of_block.radius);
                    const std::uint64_t across =
                        HWY_DYNAMIC_DISPATCH(across_of)(near & visible, normals[block], corners);
                    if (across != 0) {
                        of_tile.across |= bit;
                        all_across.push_back(across);
                        visible &= ~across;
                    }
                }
                of_tile.whole_for_all &= visible;
                if (visible != 0)
                    of_tile.visible |= bit;
                if (visible == ~std::uint64_t{0})
                    of_tile.full |= bit;
                if ((visible ^ (visible << 1 | last[block - begin] >> 63)) != 0)
                    of_tile.edges |= bit;
                last[block - begin] = visible;
            }
        }
    });
    result.across.clear();
    for (std::size_t tile = 0; tile < counts.num_tiles(); ++tile) {
        for (std::size_t w = 0; w < num_words; ++w)
            result.words[tile * num_words + w].across_before += result.across.size();
        result.across.insert(result.across.end(), across_of_tiles[tile].begin(),
                             across_of_tiles[tile].end());
    }
}

} // namespace relumine::relight
#endif // HWY_ONCE
