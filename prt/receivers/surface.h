// How a receiver's surface reflects light.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace relumine::prt {

/// The kind of a surface's highlight.
enum class Highlight : std::uint8_t {
    /// Lambert.
    None,
    /// Metallic-roughness as glTF 2.0 defines it in its Appendix B.
    Ggx,
    /// Normalised Blinn-Phong, from OBJ materials.
    BlinnPhong,
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

    bool operator==(const Surface&) const = default;
};

} // namespace relumine::prt
