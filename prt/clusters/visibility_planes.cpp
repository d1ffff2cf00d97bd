#include "prt/clusters/visibility_planes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <unordered_set>
#include <utility>

#include <glm/common.hpp>

#include "files/parallel.h"
#include "prt/clusters/horizon.h"
#include "prt/visibility/bit_matrix.h"

namespace relumine::prt {

namespace {

/// Receivers of one task: eight words of 64, so that tasks write whole cache lines of each plane.
/// Their rays through one patch start close together and meet the same blockers.
constexpr std::size_t WordsPerTask = 8;
constexpr std::size_t WordsPerGroup = ReceiverGroup::MaxSize / WordSize;

/// Patches of one task: with 512 receivers a million rays, about a twentieth of a second. Tasks
/// also split the directions, which keeps all threads busy when the receivers are few.
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

struct VisibilityPlanes::TracedPatch {
    DirectionPatch directions;
    std::array<LatticePoint, DirectionPatch::Size> points{};
    /// Set when the patch's step starts.
    std::array<std::uint64_t*, DirectionPatch::Size> planes{};
};

VisibilityPlanes::VisibilityPlanes(std::span<const glm::vec3> origins, const NormalArrays& normals,
                                   const Blockers& blockers)
    : origins_(origins), normals_(normals), blockers_(blockers) {}

std::vector<VisibilityPlanes::TracedPatch>
VisibilityPlanes::new_patches(std::span<const LatticePoint> points, double patch_width) const {
    std::vector<TracedPatch> patches;
    std::unordered_set<LatticePoint> seen;
    Extent extent;
    for (const LatticePoint point : points) {
        if (knows(point) || !seen.insert(point).second)
            continue;
        Extent with_point = extent;
        with_point.include(place_on_cube(point));
        if (patches.empty() || patches.back().directions.full() ||
            with_point.side() > patch_width) {
            patches.emplace_back();
            with_point = {};
            with_point.include(place_on_cube(point));
        }
        extent = with_point;
        TracedPatch& patch = patches.back();
        patch.points[patch.directions.num_directions] = point;
        patch.directions.add(direction(point));
    }
    return patches;
}

void VisibilityPlanes::trace(std::span<const LatticePoint> points, double patch_width,
                             const std::function<void(double)>& on_progress,
                             const TraceSteps& steps) {
    std::vector<TracedPatch> patches = new_patches(points, patch_width);
    const auto patches_per_step = static_cast<std::size_t>(
        std::clamp<std::uint64_t>(steps.patches_per_step, 1, patches.size() + 1));
    const std::size_t num_rows = (normals_.num_words() + WordsPerTask - 1) / WordsPerTask;
    const auto num_tasks = [&](std::size_t num_patches) {
        return num_rows * ((num_patches + PatchesPerTask - 1) / PatchesPerTask);
    };
    std::size_t num_all = 0;
    for (std::size_t begin = 0; begin < patches.size(); begin += patches_per_step)
        num_all += num_tasks(std::min(patches_per_step, patches.size() - begin));
    std::atomic<std::size_t> num_done = 0;
    for (std::size_t begin = 0; begin < patches.size(); begin += patches_per_step) {
        if (begin != 0 && steps.between)
            steps.between();
        const std::size_t size = std::min(patches_per_step, patches.size() - begin);
        trace_step(std::span(patches).subspan(begin, size), [&] {
            on_progress(static_cast<double>(++num_done) / static_cast<double>(num_all));
        });
    }
}

void VisibilityPlanes::trace_step(std::span<TracedPatch> patches,
                                  const std::function<void()>& on_task) {
    const std::size_t num_words = normals_.num_words();
    const std::size_t num_rows = (num_words + WordsPerTask - 1) / WordsPerTask;
    const std::size_t num_columns = (patches.size() + PatchesPerTask - 1) / PatchesPerTask;
    std::atomic<std::uint64_t> num_rays_of_step = 0;
    const auto trace_task = [&](std::size_t row, std::size_t column) {
        const std::size_t begin = row * WordsPerTask;
        const std::size_t end = std::min(begin + WordsPerTask, num_words);
        const std::size_t last_patch = std::min((column + 1) * PatchesPerTask, patches.size());
        std::uint64_t num_rays = 0;
        for (std::size_t word = begin; word < end; word += WordsPerGroup)
            for (std::size_t patch = column * PatchesPerTask; patch < last_patch; ++patch)
                num_rays += trace_group(word, patches[patch]);
        num_rays_of_step += num_rays;
        on_task();
    };
    const auto for_each_direction = [&](const auto& action) {
        for (TracedPatch& patch : patches)
            for (std::size_t j = 0; j < patch.directions.num_directions; ++j)
                action(patch.points[j], patch.planes[j]);
    };
    try {
        for_each_direction([&](LatticePoint point, std::uint64_t*& plane) {
            std::vector<std::uint64_t>& words = planes_[point];
            words.resize(num_words);
            plane = words.data();
        });
        files::parallel_for(std::size_t{0}, num_rows * num_columns, [&](std::size_t task) {
            trace_task(task / num_columns, task % num_columns);
        });
    } catch (...) {
        for_each_direction([&](LatticePoint point, std::uint64_t*) { planes_.erase(point); });
        throw;
    }
    for_each_direction([&](LatticePoint, std::uint64_t*) { ++num_directions_; });
    num_rays_ += num_rays_of_step;
}

std::vector<LatticePoint> VisibilityPlanes::points() const {
    std::vector<LatticePoint> points;
    points.reserve(planes_.size());
    for (const auto& [point, plane] : planes_)
        points.push_back(point);
    std::sort(points.begin(), points.end());
    return points;
}

std::uint64_t VisibilityPlanes::trace_group(std::size_t first_word,
                                            const TracedPatch& patch) const {
    const std::size_t first = first_word * WordSize;
    const std::size_t size = std::min(origins_.size() - first, ReceiverGroup::MaxSize);
    std::array<std::uint64_t, ReceiverGroup::MaxSize> rays{}; // [receiver], a bit per direction
    const std::span<std::uint64_t> of_group(rays.data(), size);
    directions_above_horizon(normals_, first, patch.directions, of_group);
    std::uint64_t num_rays = 0;
    glm::vec3 mean_normal(0.0f);
    for (std::size_t i = 0; i < size; ++i) {
        if (of_group[i] == 0)
            continue;
        num_rays += static_cast<std::uint64_t>(std::popcount(of_group[i]));
        mean_normal +=
            glm::vec3(normals_.x[first + i], normals_.y[first + i], normals_.z[first + i]);
    }
    if (num_rays != 0)
        blockers_.clear_blocked({origins_.subspan(first, size), mean_normal}, patch.directions,
                                of_group);

    for (std::size_t word = 0; word < WordsPerGroup && first_word + word < normals_.num_words();
         ++word) {
        const std::span<std::uint64_t, WordSize> square(rays.data() + word * WordSize, WordSize);
        transpose(square); // now [direction], a bit per receiver
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

CellSamples VisibilityPlanes::samples_of(const Cell& cell, bool is_texel) const {
    CellSamples samples;
    const std::array<LatticePoint, SamplesPerCell> points = lattice_points(cell);
    for (std::size_t l = 0; l < SamplesPerCell; ++l) {
        const LatticePoint point = points[is_texel ? CentreSample : l];
        samples.directions[l] = direction(point);
        samples.lit[l] = plane(point);
    }
    return samples;
}

std::vector<LatticePoint> needed_points(const Cell& cell, bool is_texel) {
    const std::array<LatticePoint, SamplesPerCell> points = lattice_points(cell);
    if (is_texel)
        return {points[CentreSample]};
    return {points.begin(), points.end()};
}

} // namespace relumine::prt
