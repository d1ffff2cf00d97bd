#include "relight/probe_lights.h"

#include <array>
#include <cstddef>
#include <numbers>
#include <span>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "relight/relighter.h"

namespace relumine::relight {

namespace {

/// In the order of prt::NumProbeLights.
constexpr std::array<glm::dvec3, prt::NumProbeLights - 1> SunDirections = {
    glm::dvec3(1, 0, 0),  glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
    glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1),  glm::dvec3(0, 0, -1)};

} // namespace

std::vector<prt::ProbeRadiance> probe_radiance(const prt::Transfer& transfer) {
    Relighter relighter(transfer);
    std::vector<prt::ProbeRadiance> result(transfer.num_receivers());
    const auto keep = [&](std::size_t light) {
        const std::span<const glm::vec3> radiance = relighter.diffuse_radiance();
        for (std::size_t place = 0; place < result.size(); ++place)
            result[place][light] = radiance[transfer.order[place]].g;
    };
    relighter.set_environment(cubemap::CubeMap(1, glm::vec3(1.0f)));
    keep(0);
    for (std::size_t i = 0; i < SunDirections.size(); ++i) {
        const lights::DistantLight sun{.direction = SunDirections[i],
                                       .irradiance = glm::dvec3(std::numbers::pi)};
        relighter.set_lights({&sun, 1});
        keep(i + 1);
    }
    return result;
}

} // namespace relumine::relight
