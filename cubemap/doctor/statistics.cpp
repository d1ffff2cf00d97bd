#include "cubemap/doctor/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cubemap/image/image_layout.h"
#include "cubemap/luminance.h"

namespace relumine::cubemap {

namespace {

bool is_good(const glm::vec3& radiance) {
    const auto good = [](float value) {
        return value >= 0.0f && std::isfinite(value);
    };
    return good(radiance.x) && good(radiance.y) && good(radiance.z);
}

} // namespace

EnvironmentStatistics statistics(const EnvironmentImage& image) {
    EnvironmentStatistics result;
    double smallest = std::numeric_limits<double>::infinity();
    double solid_angle = 0.0, below = 0.0;
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        const glm::vec3& radiance = image.pixels[index];
        if (!is_good(radiance))
            return;
        result.mean_radiance += glm::dvec3(radiance) * place.solid_angle;
        solid_angle += place.solid_angle;
        const glm::dvec3 power = glm::dvec3(radiance) * place.solid_angle;
        for (int axis = 0; axis < 3; ++axis) {
            const double cosine = place.direction[axis];
            const int side = 2 * axis + static_cast<int>(cosine < 0.0);
            result.axis_irradiance[static_cast<std::size_t>(side)] += power * std::abs(cosine);
        }
        const double value = luminance(radiance);
        if (place.direction.y <= 0.0)
            below += (place.direction.y < 0.0 ? 1.0 : 0.5) * value * place.solid_angle;
        if (value > result.max_luminance) {
            result.max_luminance = value;
            result.brightest_direction = place.direction;
        }
        if (value > 0.0)
            smallest = std::min(smallest, value);
    });
    if (solid_angle > 0.0)
        result.mean_radiance /= solid_angle;
    result.mean_luminance = luminance(result.mean_radiance);
    if (result.mean_luminance > 0.0)
        result.light_from_below = below / (solid_angle * result.mean_luminance);
    if (result.max_luminance > 0.0) {
        result.min_positive_luminance = smallest;
        result.dynamic_range_ev = std::log2(result.max_luminance / smallest);
    }
    return result;
}

} // namespace relumine::cubemap
