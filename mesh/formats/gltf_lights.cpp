#include "mesh/formats/gltf_lights.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/formats/clamped.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

constexpr const char* Punctual = "KHR_lights_punctual";
constexpr const char* Profiles = "EXT_lights_ies";

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
    /// Returns the object's colour times a strength.
    [[nodiscard]] glm::vec3 colored(const Json& object, double strength) const {
        const std::vector<double> color = numbers(object, "color", {1.0, 1.0, 1.0});
        glm::vec3 result;
        for (int channel = 0; channel < 3; ++channel)
            result[channel] = static_cast<float>(
                strength * in_range("color", color[static_cast<std::size_t>(channel)], 0.0, 1.0));
        return result;
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

/// A light that a node names.
struct Named {
    /// What the node says of it, and what the document does.
    const Json& own;
    const Json& description;
    std::uint64_t index;
    /// The node's, or the light's own.
    std::string name;
};

std::optional<Named> named_light(const Document& document, const Json& node,
                                 const char* extension) {
    const Json& own = child(child(node, "extensions"), extension);
    if (own.find("light") == nullptr)
        return std::nullopt;
    const Json::Array& lights =
        items(child(child(document.root(), "extensions"), extension), "lights");
    const std::uint64_t index = whole(own, "light");
    if (index >= lights.size())
        throw std::runtime_error(
            fmt::format("expected indices of lights below {}, got {}", lights.size(), index));
    std::string name = text(node, "name");
    if (name.empty())
        name = text(lights[index], "name", fmt::format("light {}", index));
    return Named{own, lights[index], index, std::move(name)};
}

/// Returns an axis of unit length without its part along others; zero where nothing is left.
glm::dvec3 across(glm::dvec3 axis, std::initializer_list<glm::dvec3> others) {
    const double whole_length = glm::length(axis);
    for (const glm::dvec3& other : others)
        axis -= glm::dot(axis, other) * other;
    const double length = glm::length(axis);
    return length > 1e-6 * whole_length ? axis / length : glm::dvec3(0.0);
}

/// Places a light by its node's world matrix. A mirrored node mirrors a profile.
void aim(PunctualLight& light, const glm::dmat4& world) {
    light.position = glm::vec3(world[3]);
    const glm::dvec3 forward = across(-glm::dvec3(world[2]), {});
    if (forward == glm::dvec3(0.0))
        return;
    light.direction = glm::vec3(forward);
    glm::dvec3 right = across(glm::dvec3(world[0]), {forward});
    const glm::dvec3 up = across(glm::dvec3(world[1]), {forward, right});
    if (right == glm::dvec3(0.0) || up == glm::dvec3(0.0)) {
        // A flat node has no axes across: any will do.
        right = across(std::abs(forward.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0),
                       {forward});
        light.up = glm::vec3(glm::cross(right, forward));
    } else {
        light.up = glm::vec3(up);
    }
    light.right = glm::vec3(right);
}

} // namespace

std::optional<PunctualLight> light_at(const Document& document, const Json& node,
                                      const glm::dmat4& world, std::vector<std::string>& warnings) {
    const std::optional<Named> named = named_light(document, node, Punctual);
    if (!named)
        return std::nullopt;
    const Json& description = named->description;
    PunctualLight light{.name = named->name, .kind = kind_of(description)};
    const LightNumbers of_light(light.name, warnings);
    light.intensity = of_light.colored(
        description, of_light.within(description, "intensity", 1.0, 0.0, Brightest) /
                         (is_of_blender(document) ? LumensPerWattOfBlender : 1.0));
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
    aim(light, world);
    return light;
}

const LightProfile& ProfiledLights::profile(std::uint64_t index, const Json& description) {
    const auto found = profiles_.find(index);
    if (found != profiles_.end())
        return found->second;
    const std::string uri = text(description, "uri");
    std::optional<std::vector<std::byte>> fetched;
    if (!uri.empty()) {
        fetched = document_.fetch(uri);
        if (!fetched)
            throw std::runtime_error(
                fmt::format("expected the file {} beside it, got none", excerpt(uri)));
    }
    const std::string name =
        uri.empty() || uri.starts_with("data:") ? fmt::format("profile {}", index) : excerpt(uri);
    try {
        const std::span<const std::byte> file =
            fetched ? std::span<const std::byte>(*fetched)
                    : document_.view(whole(description, "bufferView"));
        document_.take_memory(sizeof(float) * file.size());
        ReadLightProfile read = read_light_profile(file);
        for (const std::string& line : read.left_out)
            warnings_.push_back(fmt::format("{} without {}", name, line));
        notes_.push_back(fmt::format("{} has {:.4g} lumen, at most {:.4g} candela", name,
                                     read.profile.flux(), read.profile.largest()));
        return profiles_.emplace(index, std::move(read.profile)).first->second;
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
    }
}

std::optional<PunctualLight> ProfiledLights::at(const Json& node, const glm::dmat4& world) {
    const std::optional<Named> named = named_light(document_, node, Profiles);
    if (!named)
        return std::nullopt;
    PunctualLight light{.name = named->name, .kind = PunctualLight::Kind::Profile};
    const LightNumbers of_light(light.name, warnings_);
    light.profile = profile(named->index, named->description);
    // What leaves the lamp is no more than the brightest other light.
    const double most = Brightest / std::max(1.0, double{light.profile.largest()});
    light.intensity =
        of_light.colored(named->own, of_light.within(named->own, "multiplier", 1.0, 0.0, most));
    aim(light, world);
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
