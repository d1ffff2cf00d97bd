// What rays do not stop at: cut-out and thin surfaces, and backs that are not shown.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/opacity.h"
#include "mesh/triangle_mesh.h"
#include "prt/visibility/mask_cells.h"
#include "prt/visibility/veil_cells.h"

namespace relumine::prt {

/// Whose ray it is, and so what it passes.
enum class RayOf : std::uint8_t {
    /// Cut-out points, and thin surfaces (blended, glass) by chance: as many of the rays as the
    /// surface's mean transmittance over the colours says. Chances of rays from one place are
    /// spread evenly over directions, so that their sums are nearly right.
    Light,
    /// Cut-out points, and thin surfaces that take half of the light or less; of glass with
    /// textures, triangles that do so on average. Clusters are chosen by these rays: chance, and
    /// the grain of a texture, would split them all.
    SettledLight,
    /// What is not drawn: points of no weight, and backs of single-sided triangles.
    Eye,
    /// What Eye passes, but for the backs of what is thin. For an eye that looks through a body of
    /// glass.
    EyeInGlass,
};

[[nodiscard]] constexpr bool is_eye(RayOf of) {
    return of == RayOf::Eye || of == RayOf::EyeInGlass;
}

/// The one place that says which points of triangles a ray passes.
class SeeThrough {
public:
    /// Rays pass nothing.
    SeeThrough() = default;
    /// Copies what it needs of the mesh.
    explicit SeeThrough(const mesh::TriangleMesh& mesh);

    /// Whether some surfaces pass light by chance.
    [[nodiscard]] bool has_thin() const { return has_thin_; }
    /// Whether a triangle is thin: it is seen, and what is behind it, too.
    [[nodiscard]] bool is_thin(std::uint32_t triangle) const {
        return has_thin_ && (kinds_[triangle] & Thin) != 0;
    }
    /// Whether rays may pass a triangle; false for nearly all, and cheap.
    [[nodiscard]] bool may_pass(std::uint32_t triangle, RayOf of) const {
        return !kinds_.empty() &&
               (kinds_[triangle] & (is_eye(of) ? PassesLight | OneSided : PassesLight)) != 0;
    }

    /// Whether the eye sees a triangle's front alone.
    [[nodiscard]] bool is_one_sided(std::uint32_t triangle) const {
        return !kinds_.empty() && (kinds_[triangle] & OneSided) != 0;
    }

    /// Whether a mask cuts out all of a triangle: no ray stops there.
    [[nodiscard]] bool is_cut_out(std::uint32_t triangle) const {
        return !even_.empty() && even_[triangle] == 1.0f && (kinds_[triangle] & Thin) == 0;
    }
    /// What all rays of light do that meet a triangle.
    enum class All : std::uint8_t { Stop, Pass, Differ };
    /// `of` is a ray of light.
    [[nodiscard]] All all_at(std::uint32_t triangle, RayOf of) const;

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
    /// Whether a ray of light passes a triangle, given the corners as seen from the ray's start.
    [[nodiscard]] bool light_passes(std::uint32_t triangle,
                                    const std::array<glm::dvec3, 3>& corners,
                                    const glm::vec3& origin, const glm::vec3& direction,
                                    RayOf of) const;

    /// Returns the veil that a triangle's point is.
    [[nodiscard]] mesh::Veil veil(std::uint32_t triangle, const glm::vec2& barycentric) const;

private:
    /// A triangle that has cells: those of a mask that cuts it in part, or those of a veil, and the
    /// corners' places in the texture.
    struct Mapped {
        std::uint32_t cells = 0;
        bool is_veil = false;
        /// The mean part that passes a triangle of glass without alpha. Settled light takes it for
        /// all of the triangle; alpha has outlines, which clusters must follow.
        std::optional<float> mean;
        std::array<glm::vec2, 3> uvs = {};

        [[nodiscard]] glm::vec2 place(const glm::vec2& barycentric) const {
            const auto& [a, b, c] = uvs;
            return a * (1.0f - barycentric.x - barycentric.y) + b * barycentric.x +
                   c * barycentric.y;
        }
    };

    void find_masks();
    void find_veils();
    /// Gives cells to the triangles of materials that have a number.
    void find_mapped_triangles(const std::vector<std::uint32_t>& of_material, bool are_veils);
    /// Looks it up in the mask's cells.
    [[nodiscard]] MaskCells::Cell cell_at(std::uint32_t triangle,
                                          const glm::vec2& barycentric) const;
    /// Returns a triangle's cells of a veil; null where it has none.
    [[nodiscard]] const Mapped* veil_of(std::uint32_t triangle) const;
    /// Returns the part of light that passes a point.
    [[nodiscard]] float part_at(std::uint32_t triangle, const glm::vec2& barycentric,
                                RayOf of) const;

    static constexpr std::uint8_t PassesLight = 1, OneSided = 2, Thin = 4;

    /// [num_triangles], or empty.
    std::vector<std::uint8_t> kinds_;
    /// [num_triangles] where light passes any: the part that passes if it is the same all over the
    /// triangle, and below 0 if rays must look where they meet it.
    std::vector<float> even_;
    /// mesh::blockers_of() without its positions; empty where no light passes.
    mesh::TriangleMesh mesh_;
    /// Cells of masks that are no glass, and of what is thin and has textures that lie alike.
    std::vector<MaskCells> masks_;
    std::vector<VeilCells> veils_;
    std::vector<Mapped> mapped_;
    static constexpr std::uint32_t NotMapped = 0xffffffff;
    /// [num_triangles] index into mapped_ or NotMapped; empty where there are no cells.
    std::vector<std::uint32_t> mapped_of_;
    bool has_thin_ = false;
};

} // namespace relumine::prt
