// How a receiver's surface reflects light.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

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
};

/// Reflection of one receiver. Colours may change after a precompute; the kind and width of the
/// highlight may not.
struct Surface {
    /// Diffuse reflectance, 0..1.
    glm::vec3 albedo{1.0f};
    /// GGX: F0, the reflectance at normal incidence. Blinn-Phong: Ks.
    glm::vec3 specular{0.0f};
    /// Gives `roughness_or_exponent` its meaning.
    Highlight highlight = Highlight::None;
    /// GGX: glTF's roughness, 0..1 (alpha is its square). Blinn-Phong: the exponent, >= 0.
    float roughness_or_exponent = 1.0f;
    /// GgxWhole: the part of the surface that is bare metal, 0..1; specular is the mean of both.
    float metallic = 0.0f;
    /// Radiance of its own, >= 0.
    glm::vec3 emission{0.0f};

    bool operator==(const Surface&) const = default;
};

} // namespace relumine::prt
