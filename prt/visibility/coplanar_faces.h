// Which of several surfaces in one plane is seen.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// Decides between surfaces that lie in one plane. They are equally far but for roundings, which
/// would show now one and now the other. Of surfaces that share no vertex the one is seen that
/// begins first among the triangles.
///
/// Threads: covers() may run from any number of threads at once.
class CoplanarFaces {
public:
    /// The arrays must outlive this object. Nothing is looked for before the first question.
    CoplanarFaces(std::span<const glm::vec3> positions, std::span<const mesh::Triangle> triangles)
        : positions_(positions), triangles_(triangles) {}

    /// Whether a triangle is seen in place of another one that a ray meets as well: they belong to
    /// two surfaces, lie in one plane, and the first one's surface begins first.
    ///
    /// Cost:    O(1), of the first question O(triangles).
    [[nodiscard]] bool covers(std::uint32_t triangle, std::uint32_t other) const;

private:
    void find_surfaces() const;
    [[nodiscard]] bool are_coplanar(std::uint32_t a, std::uint32_t b) const;

    std::span<const glm::vec3> positions_;
    std::span<const mesh::Triangle> triangles_;
    mutable std::once_flag is_found_;
    /// [num_vertices] the first triangle of a vertex's surface.
    mutable std::vector<std::uint32_t> begins_;
};

} // namespace relumine::prt
