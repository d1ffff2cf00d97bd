// Spherical harmonics: light from all directions as 1, 4 or 9 coefficients a channel, and the
// irradiance of any normal from them. docs/harmonics.md says basis, order, sign and scale.
// Based on: R. Ramamoorthi, P. Hanrahan, "An Efficient Representation for Irradiance Environment
// Maps", SIGGRAPH 2001 [RH].
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// Orders have order^2 coefficients: 1, 4 and 9.
inline constexpr std::uint32_t MaxHarmonicOrder = 3;
inline constexpr std::size_t MaxHarmonics = 9;

[[nodiscard]] constexpr std::size_t num_harmonics(std::uint32_t order) {
    return std::size_t{order} * order;
}

/// Returns the band of a coefficient: 0, 1 or 2.
[[nodiscard]] constexpr std::size_t band_of(std::size_t coefficient) {
    return coefficient == 0 ? 0 : coefficient < 4 ? 1 : 2;
}

/// The factors that turn arriving light into irradiance, by band: pi, 2 pi / 3, pi / 4 [RH, Eqs. 8
/// and 9].
inline constexpr std::array<double, 3> IrradianceFactors = {
    std::numbers::pi, 2.0 * std::numbers::pi / 3.0, std::numbers::pi / 4.0};

/// Names of the coefficients: band and index.
inline constexpr std::array<std::string_view, MaxHarmonics> HarmonicNames = {
    "L0", "L1m1", "L1_0", "L1p1", "L2m2", "L2m1", "L2_0", "L2p1", "L2p2"};

/// Returns the real, orthonormal basis functions at a unit direction, all signs positive [RH, Eq.
/// 3]: 1; y, z, x; xy, yz, 3 z^2 - 1, xz, x^2 - y^2, with their constants.
[[nodiscard]] std::array<double, MaxHarmonics> harmonics(const glm::dvec3& direction);

/// Returns the basis functions, each times its band's factor: the irradiance that a coefficient of
/// 1 gives to a normal.
[[nodiscard]] std::array<double, MaxHarmonics> irradiance_harmonics(const glm::vec3& normal);

/// Returns the irradiance of a normal under arriving light, which the coefficients are. It may be a
/// little below zero, because nine coefficients ring.
///
/// Shape:   light is [order^2].
[[nodiscard]] glm::dvec3 irradiance(std::span<const glm::vec3> light, const glm::vec3& normal);

/// Changes the coefficients as little as possible, so that a normal's irradiance is what it is
/// known to be. A zero normal changes nothing.
///
/// Shape:   light is [order^2].
void bind_irradiance(std::span<glm::vec3> light, const glm::vec3& normal,
                     const glm::dvec3& irradiance);

/// Returns the mean radiance over the sphere, which the first coefficient tells: the fluence over
/// 4 pi.
[[nodiscard]] inline glm::vec3 mean_radiance(const glm::vec3& first) {
    return first * static_cast<float>(0.5 * std::numbers::inv_sqrtpi);
}

/// Throws std::invalid_argument unless the order is 2 or 3.
void require_order(std::uint32_t order);

} // namespace relumine::relight
