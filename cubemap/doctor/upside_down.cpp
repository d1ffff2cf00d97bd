#include "cubemap/doctor/upside_down.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "cubemap/luminance.h"
#include "files/parallel.h"

namespace relumine::cubemap {

double light_from_below(const CubeMap& map) {
    const std::uint32_t resolution = map.resolution;
    struct Sums {
        double all = 0.0, below = 0.0;
    };
    std::vector<Sums> rows(std::size_t{NumFaces} * resolution);
    files::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
        const auto face = static_cast<Face>(i / resolution);
        const auto y = static_cast<std::uint32_t>(i % resolution);
        const glm::vec3* texels = &map.at(face, 0, y);
        const double v = (2.0 * y + 1.0) / resolution - 1.0;
        double sum = 0.0;
        for (std::uint32_t x = 0; x < resolution; ++x) {
            const double u = (2.0 * x + 1.0) / resolution - 1.0;
            const double inverse = 1.0 / (1.0 + u * u + v * v);
            sum += luminance(glm::dvec3(texels[x])) * inverse * std::sqrt(inverse);
        }
        const bool is_side = face != Face::PositiveY && face != Face::NegativeY;
        // A row of texels on the horizon is half below.
        const double part = is_side ? (v > 0.0   ? 1.0
                                       : v < 0.0 ? 0.0
                                                 : 0.5)
                                    : (face == Face::NegativeY ? 1.0 : 0.0);
        rows[i] = {sum, part * sum};
    });
    Sums total;
    for (const Sums& row : rows) {
        total.all += row.all;
        total.below += row.below;
    }
    return total.all > 0.0 ? total.below / total.all : 0.0;
}

std::optional<std::string> upside_down(double light_from_below) {
    constexpr double Doubtful = 0.55;
    if (light_from_below <= Doubtful)
        return std::nullopt;
    return fmt::format("brighter below than above ({:.0f} % of the light from below): upside down? "
                       "--flip y turns it over",
                       100.0 * light_from_below);
}

} // namespace relumine::cubemap
