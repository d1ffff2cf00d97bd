// Triangles that lie on one another and face opposite ways.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

/// Finds the other side of surfaces that a mesh has twice, with the same corners and one for each
/// side, as exporters write what is seen from both sides. A ray meets either of the two, as
/// rounding has it. The one that faces away is dark.
///
/// Threads: facing() may run from any number of threads at once.
class TwinTriangles {
public:
    /// The mesh must outlive this object. Nothing is looked for before find() or the first hit on a
    /// back.
    explicit TwinTriangles(const mesh::TriangleMesh& mesh) : mesh_(mesh) {}

    /// Finds which triangles lie on others. After it facing() is cheap for hits on all others.
    ///
    /// Cost:    O(n log n), once.
    void find() const;

    /// Returns the same point on the triangle's twin if the ray meets the triangle from behind and
    /// it has one, otherwise the hit as it is.
    ///
    /// Cost:    O(log triangles) for a hit on the back of a triangle that lies on another; the
    ///          first hit on a back calls find().
    [[nodiscard]] Hit facing(const Hit& hit, const glm::vec3& direction) const;

    /// Returns the same point on the triangle's twin; none where it has no twin.
    [[nodiscard]] std::optional<Hit> other_side(const Hit& hit) const;

private:
    /// Whether a triangle may have a twin, after find().
    [[nodiscard]] bool may_have_twin(std::uint32_t triangle) const {
        return !is_one_of_several_.empty() && is_one_of_several_[triangle];
    }
    [[nodiscard]] std::optional<std::uint32_t> twin_of(std::uint32_t triangle) const;
    [[nodiscard]] std::uint64_t key_of(std::uint32_t triangle) const;

    const mesh::TriangleMesh& mesh_;
    mutable std::once_flag once_;
    mutable std::atomic<bool> is_found_ = false;
    /// [num_triangles] whether others have the same corners. Empty: no triangle is one of several.
    mutable std::vector<bool> is_one_of_several_;
    /// Triangles that are: a key of the corners, the same in any order of theirs, and the triangle;
    /// ascending.
    mutable std::vector<std::pair<std::uint64_t, std::uint32_t>> by_key_;
};

} // namespace relumine::prt
