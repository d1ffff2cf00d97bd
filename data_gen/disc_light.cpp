// Round lights with exact coverage of the texels at the rim.
#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/layer_composite.h"
#include "data_gen/environments.h"

namespace relumine::data_gen {

void add_disc(cubemap::CubeMap& map, const glm::dvec3& direction, double angular_radius_degrees,
              const glm::vec3& radiance) {
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
        throw std::invalid_argument("disc light: expected a direction other than zero");
    }
    if (!(angular_radius_degrees > 0.0 && angular_radius_degrees <= 90.0)) {
        throw std::invalid_argument(fmt::format(
            "disc light: expected an angular radius above 0 and up to 90 degrees, got {}",
            angular_radius_degrees));
    }
    const cubemap::LightLayer light{.name = "disc",
                                    .region =
                                        cubemap::Disc{.direction = direction / length,
                                                      .radius_degrees = angular_radius_degrees},
                                    .effect = cubemap::Emit{radiance}};
    cubemap::composite(map, std::span(&light, 1), cubemap::touched_texels(light, map.resolution),
                       map);
}

cubemap::CubeMap disc_light(std::uint32_t resolution, const glm::dvec3& direction,
                            double angular_radius_degrees, const glm::vec3& radiance) {
    cubemap::CubeMap map(resolution);
    add_disc(map, direction, angular_radius_degrees, radiance);
    return map;
}

} // namespace relumine::data_gen
