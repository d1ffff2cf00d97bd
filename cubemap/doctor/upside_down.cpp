#include "cubemap/doctor/upside_down.h"

#include <array>
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
    // The sums of each face's rows, whose texels have the same solid angles on all faces.
    std::vector<std::array<Sums, NumFaces>> rows(resolution);
    files::parallel_for(std::uint32_t{0}, resolution, [&](std::uint32_t y) {
        const double v = (2.0 * y + 1.0) / resolution - 1.0;
        std::array<const glm::vec3*, NumFaces> texels{};
        for (std::size_t face = 0; face < NumFaces; ++face)
            texels[face] = &map.at(AllFaces[face], 0, y);
        std::array<double, NumFaces> sums{};
        for (std::uint32_t x = 0; x < resolution; ++x) {
            const double u = (2.0 * x + 1.0) / resolution - 1.0;
            const double inverse = 1.0 / (1.0 + u * u + v * v);
            const double density = inverse * std::sqrt(inverse);
            for (std::size_t face = 0; face < NumFaces; ++face)
                sums[face] += luminance(glm::dvec3(texels[face][x])) * density;
        }
        // A row of texels on the horizon is half below.
        const double part_of_side = v > 0.0 ? 1.0 : v < 0.0 ? 0.0 : 0.5;
        for (std::size_t face = 0; face < NumFaces; ++face) {
            const double part = AllFaces[face] == Face::PositiveY   ? 0.0
                                : AllFaces[face] == Face::NegativeY ? 1.0
                                                                    : part_of_side;
            rows[y][face] = {sums[face], part * sums[face]};
        }
    });
    Sums total;
    for (const auto& faces : rows)
        for (const Sums& row : faces) {
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
