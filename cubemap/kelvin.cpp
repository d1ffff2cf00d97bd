#include "cubemap/kelvin.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>

#include "cubemap/luminance.h"

namespace relumine::cubemap {

glm::vec3 kelvin_color(double kelvin) {
    const double t = kelvin, t2 = kelvin * kelvin;
    const double u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t2) /
                     (1.0 + 8.42420235e-4 * t + 7.08145163e-7 * t2);
    const double v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t2) /
                     (1.0 - 2.89741816e-5 * t + 1.61456053e-7 * t2);
    const double x = 3.0 * u / (2.0 * u - 8.0 * v + 4.0), y = 2.0 * v / (2.0 * u - 8.0 * v + 4.0);
    // From XYZ to the primaries of sRGB, IEC 61966-2-1; columns.
    const glm::dmat3 rgb_from_xyz(3.2406255, -0.9689307, 0.0557101, -1.5372080, 1.8757561,
                                  -0.2040211, -0.4986286, 0.0415175, 1.0569959);
    const glm::dvec3 rgb =
        glm::max(rgb_from_xyz * glm::dvec3(x / y, 1.0, (1.0 - x - y) / y), glm::dvec3(0.0));
    return {rgb / luminance(rgb)};
}

} // namespace relumine::cubemap
