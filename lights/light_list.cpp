#include "lights/light_list.h"

namespace relumine::lights {

glm::dvec3 total_irradiance(const std::vector<DistantLight>& lights) {
    glm::dvec3 sum(0.0);
    for (const DistantLight& light : lights)
        sum += light.irradiance;
    return sum;
}

} // namespace relumine::lights
