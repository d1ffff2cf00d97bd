#include "lights/light_file.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/json.h"
#include "files/json_reader.h"
#include "files/output_file.h"

namespace relumine::lights {

namespace {

constexpr double Version = 1.0;
constexpr double FullSphere = 12.566370614359172;

/// A fault of a light, for the caller and for messages about a file.
struct Fault {
    std::string_view field;
    std::string expected, got;
};

std::string text(const glm::dvec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

std::optional<Fault> fault(const DistantLight& light) {
    const double length = glm::length(light.direction);
    if (!(std::abs(length - 1.0) <= 1e-3))
        return Fault{"direction", "a direction of length 1",
                     fmt::format("{} of length {:.6g}", text(light.direction), length)};
    for (int channel = 0; channel < 3; ++channel) {
        const double value = light.irradiance[channel];
        if (!(value >= 0.0 && std::isfinite(value)))
            return Fault{"irradiance", "irradiance that is finite and not negative",
                         text(light.irradiance)};
    }
    // Rounding of sums may make a whole sphere a little larger.
    if (!(light.solid_angle >= 0.0 && light.solid_angle <= FullSphere * (1.0 + 1e-9)))
        return Fault{"solid_angle", "a solid angle from 0 to 4 pi",
                     fmt::format("{}", light.solid_angle)};
    return std::nullopt;
}

class LightFileReader {
public:
    explicit LightFileReader(const std::filesystem::path& path)
        : path_(path), json_(path.string()) {}

    LightList read() const {
        const files::Json root = json_.parse(files::read(path_));
        json_.known(
            root,
            std::array<std::string_view, 5>{"version", "environment", "method", "seed", "lights"},
            "a light list");
        json_.require_version(root, Version);
        LightList result;
        if (const auto* value = root.find("environment"))
            result.environment = json_.string(*value, "\"environment\"");
        if (const auto* value = root.find("method"))
            result.method = json_.string(*value, "\"method\"");
        if (const auto* value = root.find("seed"))
            result.seed = seed(*value);
        const files::Json& lights = json_.required(root, "lights");
        for (const files::Json& value : json_.array(lights, "\"lights\""))
            result.lights.push_back(light(value));
        if (result.lights.empty())
            json_.refuse(lights, "one light at least", "none");
        return result;
    }

private:
    /// Numbers beyond 2^53 are not exact in JSON.
    std::uint64_t seed(const files::Json& value) const {
        const double number = json_.number(value, "\"seed\"");
        if (!(number >= 0.0 && number <= 0x1p53 && number == std::floor(number)))
            json_.refuse(value, "\"seed\" to be a whole number from 0 to 2^53",
                         fmt::format("{}", number));
        return static_cast<std::uint64_t>(number);
    }

    DistantLight light(const files::Json& value) const {
        json_.known(value,
                    std::array<std::string_view, 3>{"direction", "irradiance", "solid_angle"},
                    "a light");
        DistantLight result;
        result.direction = json_.vector(json_.required(value, "direction"), "\"direction\"");
        result.irradiance = json_.vector(json_.required(value, "irradiance"), "\"irradiance\"");
        if (const auto* solid_angle = value.find("solid_angle"))
            result.solid_angle = json_.number(*solid_angle, "\"solid_angle\"");
        if (const auto wrong = fault(result))
            json_.refuse(value.at(wrong->field), wrong->expected, wrong->got);
        // Directions written by hand or with few digits are normalised. Our own files stay as they
        // are, bit by bit.
        if (std::abs(glm::length(result.direction) - 1.0) > 1e-12)
            result.direction = glm::normalize(result.direction);
        return result;
    }

    std::filesystem::path path_;
    files::JsonReader json_;
};

} // namespace

LightList load_lights(const std::filesystem::path& path) {
    return LightFileReader(path).read();
}

void validate(const LightList& list) {
    if (list.lights.empty())
        throw std::invalid_argument("light list: expected one light at least, got none");
    if (list.seed && *list.seed > (std::uint64_t{1} << 53))
        throw std::invalid_argument(
            fmt::format("light list: expected a seed of 2^53 at most, got {}", *list.seed));
    for (std::size_t i = 0; i < list.lights.size(); ++i) {
        if (const auto wrong = fault(list.lights[i]))
            throw std::invalid_argument(
                fmt::format("light {}: expected {}, got {}", i, wrong->expected, wrong->got));
    }
}

std::string json_text(const LightList& list) {
    validate(list);
    using files::Json;
    Json head = {{"version", 1}};
    if (!list.environment.empty())
        head.set("environment", list.environment);
    if (!list.method.empty())
        head.set("method", list.method);
    if (list.seed)
        head.set("seed", *list.seed);
    // One light per line keeps a list of hundreds readable, and an error names the line of its
    // light. A file's name may have bytes that JSON cannot hold.
    std::string result = head.text(2, Json::Order::Set);
    result.resize(result.size() - 2); // "\n}"
    result += ",\n  \"lights\": [";
    const char* separator = "\n    ";
    for (const DistantLight& light : list.lights) {
        const Json value = {{"direction", light.direction},
                            {"irradiance", light.irradiance},
                            {"solid_angle", light.solid_angle}};
        result += separator + value.text(-1, Json::Order::Set);
        separator = ",\n    ";
    }
    return result + "\n  ]\n}\n";
}

void save_lights(const std::filesystem::path& path, const LightList& list) {
    files::save_text(path, json_text(list));
}

} // namespace relumine::lights
