// Visibility of all receivers in the sample directions: one plane of bits per direction, each
// direction traced once.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/lattice.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Returns the points that the test of a cell needs: nine, or the centre of a cell that is one
/// texel.
[[nodiscard]] std::vector<LatticePoint> needed_points(const Cell& cell, bool is_texel);

/// Splits long work into steps. All known results are complete between two steps.
struct TraceSteps {
    /// Patches of up to 64 directions per step, at least one
    std::uint64_t patches_per_step = std::numeric_limits<std::uint64_t>::max();
    /// Called by the calling thread between steps; may throw to cancel.
    std::function<void()> between = {};
};

/// The planes that the current level needs. A set bit says that the light from this direction
/// reaches this receiver: the direction is above the receiver's horizon and not blocked.
class VisibilityPlanes {
public:
    /// `origins` are the ray starts of the receivers in the order of `normals`, [num_receivers].
    /// The arguments must outlive this object.
    VisibilityPlanes(std::span<const glm::vec3> origins, const NormalArrays& normals,
                     const Blockers& blockers);

    /// Traces the points that are not known yet.
    ///
    /// Points that lie close together should stand close together: neighbours in the list share a
    /// patch of directions if their places on the cube [-1, 1]^3 fit into a box of side
    /// `patch_width`.
    ///
    /// The working threads call `on_progress` many times a second with the fraction of the rays
    /// that is done, in no order. It may throw to cancel. Then the points of finished steps stay
    /// known; the points of the current step do not.
    void trace(std::span<const LatticePoint> points, double patch_width,
               const std::function<void(double)>& on_progress, const TraceSteps& steps = {});

    /// Forgets all points but the given ones.
    void keep_only(std::span<const LatticePoint> points);

    [[nodiscard]] bool knows(LatticePoint point) const { return planes_.contains(point); }
    /// Words of a plane.
    [[nodiscard]] std::size_t num_words() const { return normals_.num_words(); }
    [[nodiscard]] std::size_t num_planes() const { return planes_.size(); }
    /// Returns all known points, ascending.
    [[nodiscard]] std::vector<LatticePoint> points() const;
    /// Takes over a plane that an earlier run traced, [num_words].
    void restore(LatticePoint point, std::vector<std::uint64_t> plane) {
        planes_[point] = std::move(plane);
    }
    /// Takes over an earlier run's counts.
    void restore_counts(std::uint64_t num_directions, std::uint64_t num_rays) {
        num_directions_ = num_directions;
        num_rays_ = num_rays;
    }

    /// Returns the plane of a known point, [num_words].
    [[nodiscard]] const std::uint64_t* plane(LatticePoint point) const {
        return planes_.at(point).data();
    }

    /// Returns the samples of a cell, whose points must be known. A cell that is one texel has its
    /// centre for all of them: a domain of one light has that light's transfer [JN, Section 4.1].
    [[nodiscard]] CellSamples samples_of(const Cell& cell, bool is_texel) const;

    [[nodiscard]] std::uint64_t num_directions() const { return num_directions_; }
    [[nodiscard]] std::uint64_t num_rays() const { return num_rays_; }

private:
    /// Up to 64 new directions and their planes.
    struct TracedPatch;

    std::vector<TracedPatch> new_patches(std::span<const LatticePoint> points,
                                         double patch_width) const;
    void trace_step(std::span<TracedPatch> patches, const std::function<void()>& on_task);
    std::uint64_t trace_group(std::size_t first_word, const TracedPatch& patch) const;

    std::span<const glm::vec3> origins_;
    const NormalArrays& normals_;
    const Blockers& blockers_;
    std::unordered_map<LatticePoint, std::vector<std::uint64_t>> planes_;
    std::uint64_t num_directions_ = 0;
    std::uint64_t num_rays_ = 0;
};

} // namespace relumine::prt
