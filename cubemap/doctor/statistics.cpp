#include "cubemap/doctor/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "cubemap/image/image_layout.h"
#include "cubemap/luminance.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

bool is_good(const glm::vec3& radiance) {
    const auto good = [](float value) {
        return value >= 0.0f && std::isfinite(value);
    };
    return good(radiance.x) && good(radiance.y) && good(radiance.z);
}

/// Sums over some pixels.
struct Sums {
    glm::dvec3 radiance{0.0};
    double solid_angle = 0.0;
    std::array<glm::dvec3, 6> axis_irradiance{};
    double below = 0.0;
    double smallest = std::numeric_limits<double>::infinity();
    /// The first of the brightest ones.
    struct Brightest {
        double luminance = 0.0;
        std::size_t pixel = 0;
        glm::dvec3 direction{0.0};

        void include(const Brightest& other) {
            if (other.luminance > luminance ||
                (other.luminance == luminance && other.pixel < pixel))
                *this = other;
        }
    } brightest;

    void add(std::size_t index, const glm::vec3& pixel, const PixelPlace& place) {
        const glm::dvec3 power = glm::dvec3(pixel) * place.solid_angle;
        radiance += power;
        solid_angle += place.solid_angle;
        for (int axis = 0; axis < 3; ++axis) {
            const double cosine = place.direction[axis];
            const int side = 2 * axis + static_cast<int>(cosine < 0.0);
            axis_irradiance[static_cast<std::size_t>(side)] += power * std::abs(cosine);
        }
        const double value = luminance(pixel);
        if (place.direction.y <= 0.0)
            below += (place.direction.y < 0.0 ? 1.0 : 0.5) * value * place.solid_angle;
        if (value > 0.0) {
            brightest.include({value, index, place.direction});
            smallest = std::min(smallest, value);
        }
    }
    void add(const Sums& other) {
        radiance += other.radiance;
        solid_angle += other.solid_angle;
        for (std::size_t i = 0; i < axis_irradiance.size(); ++i)
            axis_irradiance[i] += other.axis_irradiance[i];
        below += other.below;
        brightest.include(other.brightest);
        smallest = std::min(smallest, other.smallest);
    }
};

} // namespace

EnvironmentStatistics statistics(const EnvironmentImage& image) {
    const PixelRows rows(shape_of(image));
    std::vector<Sums> of_rows(rows.size());
    files::parallel_for(std::uint32_t{0}, rows.size(), [&](std::uint32_t row) {
        rows.visit(row, [&](std::size_t index, const PixelPlace& place) {
            if (is_good(image.pixels[index]))
                of_rows[row].add(index, image.pixels[index], place);
        });
    });
    Sums sums;
    for (const Sums& of_row : of_rows)
        sums.add(of_row);

    EnvironmentStatistics result;
    result.mean_radiance = sums.radiance;
    if (sums.solid_angle > 0.0)
        result.mean_radiance /= sums.solid_angle;
    result.mean_luminance = luminance(result.mean_radiance);
    if (result.mean_luminance > 0.0)
        result.light_from_below = sums.below / (sums.solid_angle * result.mean_luminance);
    result.axis_irradiance = sums.axis_irradiance;
    result.brightest_direction = sums.brightest.direction;
    result.max_luminance = sums.brightest.luminance;
    if (result.max_luminance > 0.0) {
        result.min_positive_luminance = sums.smallest;
        result.dynamic_range_ev = std::log2(result.max_luminance / sums.smallest);
    }
    return result;
}

} // namespace relumine::cubemap
