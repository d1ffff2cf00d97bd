#include "relight/pictures/ground.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace relumine::relight {

namespace {

/// The sweep's own colour ends between these distances, in heights of the camera. It falls with
/// their inverse, as places in a picture do.
constexpr double SweepBegin = 2.5, SweepEnd = 18.0;

} // namespace

glm::dvec3 Ground::point(const glm::vec3& eye, const glm::vec3& direction) const {
    const glm::dvec3 from = glm::dvec3(eye) - camera;
    const glm::dvec3 way = glm::normalize(glm::dvec3(direction));
    if (from.y <= -height)
        return way;
    const double radius = std::max(reach, 4.0 * glm::length(from));
    if (way.y < 0.0) {
        const glm::dvec3 at = from + (-height - from.y) / way.y * way;
        if (glm::dot(at, at) <= radius * radius)
            return at;
    }
    const double along = glm::dot(from, way);
    return from + (std::sqrt(along * along + radius * radius - glm::dot(from, from)) - along) * way;
}

Backdrop grounded_backdrop(Backdrop backdrop, const Ground& ground, const glm::vec3& eye) {
    if (const Chart* own = backdrop.chart()) {
        Chart chart = *own;
        chart.spot = [spot = own->spot, ground, eye](const glm::vec3& direction) {
            return spot(glm::vec3(glm::normalize(ground.point(eye, direction))));
        };
        return Backdrop(std::move(chart));
    }
    return [backdrop = std::move(backdrop), ground, eye](const glm::vec3& direction) {
        return backdrop(glm::vec3(glm::normalize(ground.point(eye, direction))));
    };
}

Backdrop sweep_backdrop(Backdrop backdrop, const glm::vec3& color, const Ground& ground,
                        const glm::vec3& eye) {
    // The part of the backdrop that the sweep hides.
    const auto hidden = [ground, eye](const glm::vec3& direction) {
        const glm::dvec3 way(direction);
        const double drop = double{eye.y} - ground.camera.y + ground.height;
        if (!(way.y < 0.0 && drop > 0.0))
            return 0.0f;
        const glm::dvec3 at = ground.point(eye, direction);
        const double distance = std::max(std::hypot(at.x, at.z) / ground.height, SweepBegin);
        const double t =
            std::max((1.0 / distance - 1.0 / SweepEnd) / (1.0 / SweepBegin - 1.0 / SweepEnd), 0.0);
        return static_cast<float>(t * t * (3.0 - 2.0 * t));
    };
    const Chart* own = backdrop.chart();
    if (own != nullptr && own->hiding == glm::vec3(0.0f)) {
        Chart chart = *own;
        chart.hiding = color;
        chart.spot = [spot = own->spot, hidden](const glm::vec3& direction) {
            return ChartSpot{.place = spot(direction).place, .hidden = hidden(direction)};
        };
        return Backdrop(std::move(chart));
    }
    return [backdrop = std::move(backdrop), color, hidden](const glm::vec3& direction) {
        return glm::mix(backdrop(direction), color, hidden(direction));
    };
}

bool has_ground(const cubemap::CubeMap& map, const glm::vec3& open_ground) {
    constexpr double Below = -0.2; // no hills and no walls, for most of it
    constexpr double Black = 0.02, Even = 0.01;
    // What is so much brighter than white, and stands on the ground, is a lamp or a window: it
    // would lie there. Measured: maps of lawns and squares have at most 0.005 sr of it, others
    // 0.04.
    constexpr double Lamp = 3.0, LampBelow = -0.05, LampAbove = -0.3, MostOfLamps = 0.015;
    const auto brightness = [](const glm::vec3& color) {
        return double{color.r} + double{color.g} + double{color.b};
    };
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(map.resolution);
    double weight = 0.0, sum = 0.0, squares = 0.0, lamps = 0.0;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < map.resolution; ++y)
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const double up = cubemap::texel_direction(face, x, y, map.resolution).y;
                const double own = solid_angles[std::size_t{y} * map.resolution + x];
                const double value = brightness(map.at(face, x, y));
                if (LampAbove < up && up < LampBelow && value > Lamp * brightness(open_ground))
                    lamps += own;
                if (up > Below)
                    continue;
                weight += own;
                sum += own * value;
                squares += own * value * value;
            }
    if (!(weight > 0.0))
        return false;
    const double mean = sum / weight;
    const double spread = std::sqrt(std::max(squares / weight - mean * mean, 0.0));
    return mean > Black * brightness(open_ground) && spread > Even * mean && lamps < MostOfLamps;
}

} // namespace relumine::relight
