// What rays do not stop at: cut-out and thin surfaces, and backs that are not shown.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// Whose ray it is. Light meets all that is there, of thin surfaces by chance. The eye meets what
/// is drawn: no point whose opacity is 0, and no back of a single-sided triangle.
enum class RayOf : std::uint8_t { Light, Eye };

/// The one place that says which points of triangles a ray passes.
class SeeThrough {
public:
    /// Rays pass nothing.
    SeeThrough() = default;
    /// Copies what it needs of the mesh.
    explicit SeeThrough(const mesh::TriangleMesh& mesh);

    /// Whether any light passes.
    [[nodiscard]] bool has_light() const { return !mesh_.triangle_materials.empty(); }
    /// Whether the eye sees anything through a surface that is there.
    [[nodiscard]] bool has_thin() const { return has_thin_; }
    /// Whether rays may pass a triangle; false for nearly all, and cheap.
    [[nodiscard]] bool may_pass(std::uint32_t triangle, RayOf of) const {
        return !kinds_.empty() &&
               (kinds_[triangle] & (of == RayOf::Light ? PassesLight : PassesLight | OneSided)) !=
                   0;
    }

    /// Where a ray meets such a triangle.
    struct Meeting {
        std::uint32_t triangle = 0;
        /// Weights of the second and third corner
        glm::vec2 barycentric{0.0f};
        glm::vec3 origin{0.0f};
        glm::vec3 direction{0.0f};
        bool is_back = false;
    };
    /// Whether the ray goes on behind it. The same ray and triangle have the same answer.
    [[nodiscard]] bool passes(const Meeting& meeting, RayOf of) const;

    /// Returns the opacity at a triangle's point.
    [[nodiscard]] float opacity(std::uint32_t triangle, const glm::vec2& barycentric) const;

private:
    static constexpr std::uint8_t PassesLight = 1, OneSided = 2;

    /// [num_triangles], or empty.
    std::vector<std::uint8_t> kinds_;
    /// mesh::blockers_of() without its positions; empty where no light passes.
    mesh::TriangleMesh mesh_;
    bool has_thin_ = false;
};

} // namespace relumine::prt
