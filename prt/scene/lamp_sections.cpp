#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "prt/scene/json_members.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

using files::Json;
using Kind = mesh::PunctualLight::Kind;

/// Three numbers of each emitter: its triangle, its part, its group.
using EmitterNumbers = std::array<std::uint32_t, 3>;

Json json_of(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

/// The profiles of the lights, each once.
using Profiles = std::vector<mesh::LightProfile>;

std::size_t index_of(const mesh::LightProfile& profile, Profiles& profiles) {
    const auto found = std::find(profiles.begin(), profiles.end(), profile);
    if (found != profiles.end())
        return static_cast<std::size_t>(found - profiles.begin());
    profiles.push_back(profile);
    return profiles.size() - 1;
}

Json json_of(const mesh::PunctualLight& light, Profiles& profiles) {
    Json json = {{"name", light.name},
                 {"kind", static_cast<int>(light.kind)},
                 {"intensity", json_of(light.intensity)},
                 {"position", json_of(light.position)},
                 {"direction", json_of(light.direction)},
                 {"cones", {light.inner_cone, light.outer_cone}}};
    if (std::isfinite(light.range))
        json.set("range", light.range);
    if (light.kind == Kind::Profile) {
        json.set("profile", index_of(light.profile, profiles));
        json.set("right", json_of(light.right));
        json.set("up", json_of(light.up));
    }
    return json;
}

glm::vec3 vector_of(const Json& json) {
    return {real(json.values().at(0)), real(json.values().at(1)), real(json.values().at(2))};
}

mesh::PunctualLight light_of(const Json& json, const Profiles& profiles) {
    mesh::PunctualLight light{.name = json.at("name").string(),
                              .kind = static_cast<Kind>(natural(json.at("kind"))),
                              .intensity = vector_of(json.at("intensity")),
                              .position = vector_of(json.at("position")),
                              .direction = vector_of(json.at("direction"))};
    if (const Json* range = json.find("range"))
        light.range = real(*range);
    light.inner_cone = real(json.at("cones").values().at(0));
    light.outer_cone = real(json.at("cones").values().at(1));
    if (light.kind > Kind::Profile)
        throw std::out_of_range("expected a kind of light");
    if (light.kind == Kind::Profile) {
        light.profile = profiles.at(natural(json.at("profile")));
        light.right = vector_of(json.at("right"));
        light.up = vector_of(json.at("up"));
    }
    return light;
}

/// Adds the numbers of profiles: vertical angles, horizontal angles and candela of each.
/// Returns how many angles each has.
Json add_profiles(NewSections& sections, const Profiles& profiles) {
    Json sizes = Json::Array{};
    std::vector<float> numbers;
    for (const mesh::LightProfile& profile : profiles) {
        const mesh::LightProfileTable& table = profile.table();
        sizes.push_back({table.vertical.size(), table.horizontal.size()});
        for (const std::vector<float>* part : {&table.vertical, &table.horizontal, &table.candela})
            numbers.insert(numbers.end(), part->begin(), part->end());
    }
    sections["light_profiles"] = bytes_of(numbers);
    return sizes;
}

/// `sizes` has how many angles each profile has, if the file has any.
Profiles profiles_of(const SectionReader& reader, const Json* sizes) {
    Profiles profiles;
    if (sizes == nullptr)
        return profiles;
    const auto numbers = reader.elements<float>("light_profiles");
    std::size_t at = 0;
    const auto take = [&](std::size_t count) {
        if (count > numbers.size() - at)
            throw std::out_of_range("expected numbers of profiles");
        const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(at);
        at += count;
        return std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    for (const Json& size : sizes->values()) {
        mesh::LightProfileTable table;
        table.vertical = take(natural(size.values().at(0)));
        table.horizontal = take(natural(size.values().at(1)));
        table.candela = take(table.vertical.size() * table.horizontal.size());
        profiles.emplace_back(std::move(table));
    }
    if (at != numbers.size())
        throw std::out_of_range("expected numbers of profiles");
    return profiles;
}

void add_lamps(NewSections& sections, const Scene& scene) {
    const Lamps& lamps = scene.lamps;
    if (lamps.empty())
        return;
    Json groups = Json::Array{}, lights = Json::Array{};
    Profiles profiles;
    for (const std::string& group : lamps.groups)
        groups.push_back(group);
    for (const mesh::PunctualLight& light : lamps.lights)
        lights.push_back(json_of(light, profiles));
    Json json = {{"groups", groups}, {"lights", lights}};
    if (!profiles.empty())
        json.set("profiles", add_profiles(sections, profiles));
    const std::string text = json.text(2);
    sections["lamps"] = bytes_of(text);
    std::vector<EmitterNumbers> numbers;
    std::vector<glm::vec3> radiance;
    for (const Emitter& emitter : lamps.emitters) {
        numbers.push_back({emitter.triangle, emitter.part, emitter.group});
        radiance.push_back(emitter.radiance);
    }
    sections["emitters"] = bytes_of(numbers);
    sections["e_radiance"] = bytes_of(radiance);
}

void read_lamps(const SectionReader& reader, Scene& scene) {
    if (!reader.has("lamps"))
        return;
    const Json json = reader.json("lamps");
    try {
        for (const Json& group : json.at("groups").values())
            scene.lamps.groups.push_back(group.string());
        const Profiles profiles = profiles_of(reader, json.find("profiles"));
        for (const Json& light : json.at("lights").values())
            scene.lamps.lights.push_back(light_of(light, profiles));
    } catch (const std::exception&) {
        reader.fail("lamps", "JSON with lamps");
    }
    const auto numbers = reader.elements<EmitterNumbers>("emitters");
    const auto radiance = reader.elements<glm::vec3>("e_radiance", numbers.size());
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto& [triangle, part, group] = numbers[i];
        if (triangle < before || triangle >= scene.mesh.num_triangles() || part == 0 ||
            part >= LastPart || std::bit_width(part) % 2 == 0 || group >= scene.lamps.groups.size())
            reader.fail("emitters", "parts of triangles, in their order");
        before = triangle;
        scene.lamps.emitters.push_back({triangle, part, group, radiance[i]});
    }
}

bool has_axes(const mesh::PunctualLight& light) {
    const auto are_across = [](const glm::vec3& a, const glm::vec3& b) {
        return std::abs(glm::dot(a, b)) <= RangeSlack;
    };
    return !light.profile.empty() && is_unit(light.right) && is_unit(light.up) &&
           are_across(light.right, light.up) && are_across(light.right, light.direction) &&
           are_across(light.up, light.direction);
}

bool is_light(const mesh::PunctualLight& light) {
    constexpr float RightAngle = 1.5708f;
    return light.range > 0.0f && light.inner_cone >= 0.0f && light.inner_cone < light.outer_cone &&
           light.outer_cone <= RightAngle && is_unit(light.direction) &&
           is_finite(light.position) && (light.kind != Kind::Profile || has_axes(light));
}

void check_lamps(const SceneCheck& check, const Scene& scene) {
    constexpr float MaxRadiance = 1e9f;
    const auto is_good = [](const glm::vec3& v) {
        return is_within(v, 0.0f, MaxRadiance);
    };
    check.all("emitters of radiance 0 to 1e9", scene.lamps.emitters, is_good,
              [](const Emitter& emitter) { return emitter.radiance; });
    check.all("lights of intensity 0 to 1e9", scene.lamps.lights, is_good,
              [](const mesh::PunctualLight& light) { return light.intensity; });
    for (const mesh::PunctualLight& light : scene.lamps.lights)
        check.that(is_light(light), "lights with a place, a direction, a range and cones",
                   "another: " + light.name);
}

} // namespace

const SectionGroup LampSections = {.add = add_lamps, .read = read_lamps, .check = check_lamps};

} // namespace relumine::prt
