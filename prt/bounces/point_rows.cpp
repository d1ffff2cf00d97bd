#include "prt/bounces/point_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace relumine::prt {

std::vector<glm::dvec3> even_directions(std::uint32_t count) {
    constexpr double Turn = 2.0 * std::numbers::pi * (2.0 - std::numbers::phi);
    std::vector<glm::dvec3> directions;
    directions.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / count;
        const double radius = std::sqrt(1.0 - y * y);
        directions.emplace_back(radius * std::cos(Turn * i), y, radius * std::sin(Turn * i));
    }
    return directions;
}

std::uint32_t num_point_directions(float tolerance) {
    constexpr std::uint32_t Least = 128, Most = 16384;
    // The deviation of light that half of the sphere sends.
    constexpr double Deviation = 0.25;
    const double wanted = std::pow(Deviation / static_cast<double>(tolerance), 2.0);
    return std::bit_ceil(static_cast<std::uint32_t>(
        std::clamp(wanted, static_cast<double>(Least), static_cast<double>(Most))));
}

} // namespace relumine::prt
