// How a receiver's surface reflects light.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "mesh/materials/brdf_table.h"

namespace relumine::prt {

/// The kind of a surface's highlight.
enum class Highlight : std::uint8_t {
    /// Lambert.
    None,
    /// GGX as glTF 2.0 publishes it in its Appendix B: one scattering, which loses energy.
    Ggx,
    /// Normalised Blinn-Phong, from OBJ materials.
    BlinnPhong,
    /// GGX that keeps its energy: what one scattering loses comes back, and the diffuse part has
    /// what the highlight leaves.
    GgxWhole,
    /// A table of any BRDF: Surface::table.
    Measured,
};

/// Reflection of one receiver. Colours may change after a precompute; the kind and width of the
/// highlight may not.
struct Surface {
    /// Diffuse reflectance, 0..1.
    glm::vec3 albedo{1.0f};
    /// GGX: F0, the reflectance at normal incidence. Blinn-Phong: Ks. Measured: the factor on what
    /// the table has beyond the albedo.
    glm::vec3 specular{0.0f};
    /// Gives `roughness_or_exponent` its meaning.
    Highlight highlight = Highlight::None;
    /// GGX: glTF's roughness, 0..1 (alpha is its square). Blinn-Phong: the exponent, >= 0.
    /// Measured: the roughness of a GGX that is about as wide.
    float roughness_or_exponent = 1.0f;
    /// GgxWhole: the part of the surface that is bare metal, 0..1; specular is the mean of both.
    float metallic = 0.0f;
    /// Radiance of its own, >= 0.
    glm::vec3 emission{0.0f};
    /// GgxWhole, where metallic is neither 0 nor 1: F0 of the part that is not metal.
    float dielectric_f0 = 0.04f;
    /// GgxWhole: what the part that is not metal mirrors at grazing angles.
    float dielectric_f90 = 1.0f;
    /// GgxWhole: the part that a clear coat of F0 0.04 covers, 0..1, and its roughness.
    float coat = 0.0f;
    float coat_roughness = 0.0f;
    /// Zero: the receiver's own.
    glm::vec3 coat_normal{0.0f};
    /// GgxWhole: the colour of sheen, under the coat, 0..1, and its roughness.
    glm::vec3 sheen{0.0f};
    float sheen_roughness = 0.0f;
    /// GgxWhole: the part that a thin film covers, 0..1, its index of refraction, >= 1, and how
    /// thick it is, in nanometres.
    float film = 0.0f;
    float film_ior = 1.3f;
    float film_thickness = 400.0f;
    /// GgxWhole: how far the highlight is stretched along the tangent, 0..1. The tangent has unit
    /// length and is about across the normal; zero: there is none.
    float anisotropy = 0.0f;
    glm::vec3 tangent{0.0f};
    /// Measured: never null.
    std::shared_ptr<const mesh::BrdfTable> table = {};

    bool operator==(const Surface&) const = default;
};

/// Whether a surface's highlight is stretched. GGX as published has none.
[[nodiscard]] inline bool is_stretched(const Surface& surface) {
    return surface.highlight == Highlight::GgxWhole && surface.anisotropy > 0.0f &&
           surface.tangent != glm::vec3(0.0f);
}

/// Returns right-handed unit axes: the part of a tangent that is across a unit normal, the
/// bitangent, and the normal.
[[nodiscard]] inline glm::mat3 tangent_frame(const glm::vec3& tangent, const glm::vec3& normal) {
    const glm::vec3 flat = tangent - glm::dot(normal, tangent) * normal;
    constexpr float Shortest = 1e-4f;
    if (const float length = glm::length(flat); length > Shortest) {
        const glm::vec3 along = flat / length;
        return {along, glm::cross(normal, along), normal};
    }
    return tangent_frame(std::abs(normal.x) < 0.9f ? glm::vec3(1.0f, 0.0f, 0.0f)
                                                   : glm::vec3(0.0f, 1.0f, 0.0f),
                         normal);
}

/// Cosines between the direction to the eye and the normals of a surface.
struct EyeCosines {
    EyeCosines(float of_both = 0.0f) : base(of_both), coat(of_both) {}
    EyeCosines(const Surface& surface, const glm::vec3& normal, const glm::vec3& to_eye)
        : base(glm::dot(normal, to_eye)),
          coat(surface.coat_normal == glm::vec3(0.0f) ? base
                                                      : glm::dot(surface.coat_normal, to_eye)) {
        if (!is_stretched(surface))
            return;
        const glm::vec3 eye = to_eye * tangent_frame(surface.tangent, normal);
        if (const float across2 = eye.x * eye.x + eye.y * eye.y; across2 > 0.0f)
            along = eye.x * eye.x / across2;
    }
    float base, coat;
    /// The squared cosine between the tangent and the direction to the eye, seen along the normal.
    float along = 0.0f;
};

} // namespace relumine::prt
