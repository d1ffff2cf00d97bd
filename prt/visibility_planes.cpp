#include "prt/visibility_planes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "prt/bit_matrix.h"
#include "prt/horizon.h"

namespace relumine::prt {

namespace {

/// Receivers of one task: eight words of 64, so that tasks write whole cache lines of each plane. Their rays through one patch
/// start close together and meet the same blockers.
constexpr std::size_t WordsPerTask = 8;
constexpr std::size_t WordsPerBlock = ReceiverBlock::MaxSize / WordSize;

/// Patches of one task: with 512 receivers a million rays, about a twentieth of a second. Splitting the directions, too, keeps all
/// threads busy when the receivers are few.
constexpr std::size_t PatchesPerTask = 32;

/// Side of the smallest axis-aligned cube around points.
class Extent {
public:
    void include(const glm::dvec3& point) {
        low_ = glm::min(low_, point);
        high_ = glm::max(high_, point);
    }
    [[nodiscard]] double side() const {
        const glm::dvec3 size = high_ - low_;
        return std::max({size.x, size.y, size.z});
    }

private:
    glm::dvec3 low_{std::numeric_limits<double>::infinity()};
    glm::dvec3 high_{-std::numeric_limits<double>::infinity()};
};

} // namespace

struct VisibilityPlanes::Patch {
    DirectionPatch directions;
    std::array<std::uint64_t*, DirectionPatch::Size> planes{};
};

VisibilityPlanes::VisibilityPlanes(std::span<const glm::vec3> origins, const NormalArrays& normals,
                                   const Blockers& blockers)
    : origins_(origins), normals_(normals), blockers_(blockers) {}

std::vector<VisibilityPlanes::Patch> VisibilityPlanes::new_patches(std::span<const LatticePoint> points,
                                                                   double patch_width) {
    std::vector<Patch> patches;
    Extent extent;
    for (const LatticePoint point : points) {
        const auto [entry, is_new] = planes_.try_emplace(point);
        if (!is_new)
            continue;
        entry->second.resize(normals_.num_words());
        Extent with_point = extent;
        with_point.include(place_on_cube(point));
        if (patches.empty() || patches.back().directions.full() || with_point.side() > patch_width) {
            patches.emplace_back();
            with_point = {};
            with_point.include(place_on_cube(point));
        }
        extent = with_point;
        Patch& patch = patches.back();
        patch.planes[patch.directions.num_directions] = entry->second.data();
        patch.directions.add(direction(point));
        ++num_directions_;
    }
    return patches;
}

void VisibilityPlanes::trace(std::span<const LatticePoint> points, double patch_width,
                             const std::function<void(double)>& on_progress) {
    const std::size_t num_words = normals_.num_words();
    const std::vector<Patch> patches = new_patches(points, patch_width);
    const std::size_t num_rows = (num_words + WordsPerTask - 1) / WordsPerTask;
    const std::size_t num_columns = (patches.size() + PatchesPerTask - 1) / PatchesPerTask;
    std::atomic<std::size_t> num_done = 0;
    const auto trace_task = [&](std::size_t row, std::size_t column) {
        const std::size_t begin = row * WordsPerTask;
        const std::size_t end = std::min(begin + WordsPerTask, num_words);
        const std::size_t last_patch = std::min((column + 1) * PatchesPerTask, patches.size());
        std::uint64_t num_rays = 0;
        for (std::size_t word = begin; word < end; word += WordsPerBlock)
            for (std::size_t patch = column * PatchesPerTask; patch < last_patch; ++patch)
                num_rays += trace_block(word, patches[patch]);
        num_rays_ += num_rays;
        on_progress(static_cast<double>(++num_done) / static_cast<double>(num_rows * num_columns));
    };
    tbb::parallel_for(tbb::blocked_range2d<std::size_t>(0, num_rows, 1, 0, num_columns, 1),
                      [&](const tbb::blocked_range2d<std::size_t>& tasks) {
                          for (std::size_t row = tasks.rows().begin(); row < tasks.rows().end(); ++row)
                              for (std::size_t column = tasks.cols().begin(); column < tasks.cols().end();
                                   ++column)
                                  trace_task(row, column);
                      });
}

std::uint64_t VisibilityPlanes::trace_block(std::size_t first_word, const Patch& patch) const {
    const std::size_t first = first_word * WordSize;
    const std::size_t size = std::min(origins_.size() - first, ReceiverBlock::MaxSize);
    std::array<std::uint64_t, ReceiverBlock::MaxSize> rays{}; // a word per receiver, bits are directions
    const std::span<std::uint64_t> of_block(rays.data(), size);
    directions_above_horizon(normals_, first, patch.directions, of_block);
    std::uint64_t num_rays = 0;
    glm::vec3 mean_normal(0.0f);
    for (std::size_t i = 0; i < size; ++i) {
        if (of_block[i] == 0)
            continue;
        num_rays += static_cast<std::uint64_t>(std::popcount(of_block[i]));
        mean_normal += glm::vec3(normals_.x[first + i], normals_.y[first + i], normals_.z[first + i]);
    }
    if (num_rays != 0)
        blockers_.clear_blocked({origins_.subspan(first, size), mean_normal}, patch.directions, of_block);

    for (std::size_t word = 0; word < WordsPerBlock && first_word + word < normals_.num_words(); ++word) {
        const std::span<std::uint64_t, WordSize> square(rays.data() + word * WordSize, WordSize);
        transpose(square); // a word per direction, bits are receivers
        for (std::size_t j = 0; j < patch.directions.num_directions; ++j)
            patch.planes[j][first_word + word] = square[j];
    }
    return num_rays;
}

void VisibilityPlanes::keep_only(std::span<const LatticePoint> points) {
    std::unordered_map<LatticePoint, std::vector<std::uint64_t>> kept;
    for (const LatticePoint point : points)
        if (const auto entry = planes_.find(point); entry != planes_.end())
            kept.insert(planes_.extract(entry));
    planes_ = std::move(kept);
}

} // namespace relumine::prt
