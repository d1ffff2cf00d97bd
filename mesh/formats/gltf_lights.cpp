#include "mesh/formats/gltf_lights.h"

#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/formats/clamped.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

constexpr const char* Name = "KHR_lights_punctual";

/// Pictures of such lights, with room for exposure, stay within what a float holds.
constexpr double Brightest = 1e9;

/// Reads numbers of one light into their ranges.
class LightNumbers {
public:
    LightNumbers(const std::string& name, std::vector<std::string>& warnings)
        : name_(name), warnings_(warnings) {}

    [[nodiscard]] double within(const Json& object, const char* key, double fallback, double low,
                                double high) const {
        return in_range(key, number(object, key, fallback), low, high);
    }
    [[nodiscard]] double in_range(const char* key, double value, double low, double high) const {
        return clamped("light " + name_, key, value, low, high, warnings_);
    }

private:
    const std::string& name_;
    std::vector<std::string>& warnings_;
};

/// Blender's exporter gives lumens by the peak of the eye, where it gives emission as radiance.
constexpr double LumensPerWattOfBlender = 683.0;

bool is_of_blender(const Document& document) {
    const std::string generator = text(child(document.root(), "asset"), "generator");
    return generator.starts_with("Khronos glTF Blender I/O");
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

void read_cones(const Json& spot, const LightNumbers& numbers, PunctualLight& light) {
    constexpr double RightAngle = 0.5 * std::numbers::pi, Narrowest = 1e-3;
    const double outer =
        numbers.within(spot, "outerConeAngle", 0.25 * std::numbers::pi, Narrowest, RightAngle);
    // The edge of a spot has a width.
    light.inner_cone = static_cast<float>(
        numbers.within(spot, "innerConeAngle", 0.0, 0.0, outer - 0.5 * Narrowest));
    light.outer_cone = static_cast<float>(outer);
}

} // namespace

std::optional<PunctualLight> light_at(const Document& document, const Json& node,
                                      const glm::dmat4& world, std::vector<std::string>& warnings) {
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
    const LightNumbers of_light(light.name, warnings);
    const std::vector<double> color = numbers(description, "color", {1.0, 1.0, 1.0});
    const double intensity = of_light.within(description, "intensity", 1.0, 0.0, Brightest) /
                             (is_of_blender(document) ? LumensPerWattOfBlender : 1.0);
    for (int channel = 0; channel < 3; ++channel)
        light.intensity[channel] = static_cast<float>(
            intensity *
            of_light.in_range("color", color[static_cast<std::size_t>(channel)], 0.0, 1.0));
    if (description.find("range") != nullptr) {
        const double range = number(description, "range", 0.0);
        if (range > 0.0)
            light.range = static_cast<float>(range);
        else
            warnings.push_back(fmt::format(
                "the light {}: expected more than 0 as \"range\", got {:g}: it reaches everywhere",
                light.name, range));
    }
    if (light.kind == PunctualLight::Kind::Spot)
        read_cones(child(description, "spot"), of_light, light);
    // The extension keeps range and intensity out of the node's scale.
    const glm::dvec3 forward = -glm::dvec3(world[2]);
    const double length = glm::length(forward);
    if (length > 0.0)
        light.direction = glm::vec3(forward / length);
    light.position = glm::vec3(world[3]);
    return light;
}

std::optional<std::string> unit_of_lights(const Document& document) {
    if (!is_of_blender(document))
        return std::nullopt;
    return fmt::format("lights are divided by {:g}, with which Blender's exporter multiplies them "
                       "and not emission",
                       LumensPerWattOfBlender);
}

} // namespace relumine::mesh::gltf
