#include "mesh/formats/gltf_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

constexpr const char* Name = "KHR_lights_punctual";

/// Pictures of such lights, with room for exposure, stay within what a float holds.
constexpr double Brightest = 1e9;

double in_range(const Json& object, const char* key, double fallback, double low, double high) {
    const double value = number(object, key, fallback);
    if (!(value >= low && value <= high))
        throw std::runtime_error(fmt::format("expected {:g} to {:g} as \"{}\" of a light, got {:g}",
                                             low, high, key, value));
    return value;
}

PunctualLight::Kind kind_of(const Json& light) {
    const std::string type = text(light, "type");
    if (type == "point")
        return PunctualLight::Kind::Point;
    if (type == "spot")
        return PunctualLight::Kind::Spot;
    if (type == "directional")
        return PunctualLight::Kind::Directional;
    throw std::runtime_error(fmt::format(
        "expected point, spot or directional as \"type\" of a light, got {}", excerpt(type)));
}

void read_cones(const Json& spot, PunctualLight& light) {
    constexpr double RightAngle = 0.5 * std::numbers::pi;
    // A float of it may be a rounding above.
    const double outer =
        std::min(in_range(spot, "outerConeAngle", 0.25 * std::numbers::pi, 0.0, RightAngle + 1e-6),
                 RightAngle);
    const double inner = in_range(spot, "innerConeAngle", 0.0, 0.0, RightAngle);
    if (!(inner < outer))
        throw std::runtime_error(fmt::format(
            "expected an \"innerConeAngle\" below the outer one ({:g}), got {:g}", outer, inner));
    light.inner_cone = static_cast<float>(inner);
    light.outer_cone = static_cast<float>(outer);
}

} // namespace

std::optional<PunctualLight> light_at(const Document& document, const Json& node,
                                      const glm::dmat4& world) {
    const Json& own = child(child(node, "extensions"), Name);
    if (own.find("light") == nullptr)
        return std::nullopt;
    const Json::Array& lights = items(child(child(document.root(), "extensions"), Name), "lights");
    const std::uint64_t index = whole(own, "light");
    if (index >= lights.size())
        throw std::runtime_error(
            fmt::format("expected indices of lights below {}, got {}", lights.size(), index));
    const Json& description = lights[index];
    PunctualLight light{.kind = kind_of(description)};
    light.name = text(node, "name");
    if (light.name.empty())
        light.name = text(description, "name", fmt::format("light {}", index));
    const std::vector<double> color = numbers(description, "color", {1.0, 1.0, 1.0});
    const double intensity = in_range(description, "intensity", 1.0, 0.0, Brightest);
    for (int channel = 0; channel < 3; ++channel) {
        const double value = color[static_cast<std::size_t>(channel)];
        if (!is_fraction(value))
            throw std::runtime_error(
                fmt::format("expected 0 to 1 in \"color\" of a light, got {:g}", value));
        light.intensity[channel] = static_cast<float>(intensity * std::clamp(value, 0.0, 1.0));
    }
    if (description.find("range") != nullptr) {
        const double range = number(description, "range", 0.0);
        if (!(range > 0.0))
            throw std::runtime_error(
                fmt::format("expected more than 0 as \"range\" of a light, got {:g}", range));
        light.range = static_cast<float>(range);
    }
    if (light.kind == PunctualLight::Kind::Spot)
        read_cones(child(description, "spot"), light);
    // The extension keeps range and intensity out of the node's scale.
    const glm::dvec3 forward = -glm::dvec3(world[2]);
    const double length = glm::length(forward);
    if (length > 0.0)
        light.direction = glm::vec3(forward / length);
    light.position = glm::vec3(world[3]);
    return light;
}

} // namespace relumine::mesh::gltf
