// Directions of a rough surface's facets, as an eye sees them.
//
// Based on: E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
#pragma once

#include <bit>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::relight {

/// Into how many columns hammersley() parts the unit square: of 2^k points, each column has as many
/// rows with one point, or half.
[[nodiscard]] constexpr std::uint32_t hammersley_columns(std::uint32_t n) {
    return 1u << std::bit_width(n) / 2;
}

/// Returns point i of n of Hammersley's, shifted around its column and around the square's height:
/// a point keeps its part of a lobe, from the middle to the tail.
[[nodiscard]] glm::vec2 hammersley(std::uint32_t i, std::uint32_t n, const glm::vec2& shift);

/// Returns a half vector that an eye sees, in the frame of the normal [Heitz 2018, Listing 1].
[[nodiscard]] glm::vec3 visible_half(const glm::vec3& to_eye, float alpha, const glm::vec2& u);

/// Returns the density of directions that are mirrored at half vectors of visible_half():
/// D G1 / (4 n.v).
[[nodiscard]] float mirrored_density(const glm::vec3& half, float n_v, float alpha);

} // namespace relumine::relight
