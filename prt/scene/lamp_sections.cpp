#include <array>
#include <bit>
#include <cmath>

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

Json json_of(const mesh::PunctualLight& light) {
    Json json = {{"name", light.name},
                 {"kind", static_cast<int>(light.kind)},
                 {"intensity", json_of(light.intensity)},
                 {"position", json_of(light.position)},
                 {"direction", json_of(light.direction)},
                 {"cones", {light.inner_cone, light.outer_cone}}};
    if (std::isfinite(light.range))
        json.set("range", light.range);
    return json;
}

glm::vec3 vector_of(const Json& json) {
    return {real(json.values().at(0)), real(json.values().at(1)), real(json.values().at(2))};
}

mesh::PunctualLight light_of(const Json& json) {
    mesh::PunctualLight light{.name = json.at("name").string(),
                              .kind = static_cast<Kind>(natural(json.at("kind"))),
                              .intensity = vector_of(json.at("intensity")),
                              .position = vector_of(json.at("position")),
                              .direction = vector_of(json.at("direction"))};
    if (const Json* range = json.find("range"))
        light.range = real(*range);
    light.inner_cone = real(json.at("cones").values().at(0));
    light.outer_cone = real(json.at("cones").values().at(1));
    if (light.kind > Kind::Directional)
        throw std::out_of_range("expected a kind of light");
    return light;
}

void add_lamps(NewSections& sections, const Scene& scene) {
    const Lamps& lamps = scene.lamps;
    if (lamps.empty())
        return;
    Json groups = Json::Array{}, lights = Json::Array{};
    for (const std::string& group : lamps.groups)
        groups.push_back(group);
    for (const mesh::PunctualLight& light : lamps.lights)
        lights.push_back(json_of(light));
    const std::string text = Json({{"groups", groups}, {"lights", lights}}).text(2);
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
        for (const Json& light : json.at("lights").values())
            scene.lamps.lights.push_back(light_of(light));
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

bool is_light(const mesh::PunctualLight& light) {
    constexpr float RightAngle = 1.5708f;
    return light.range > 0.0f && light.inner_cone >= 0.0f && light.inner_cone < light.outer_cone &&
           light.outer_cone <= RightAngle && is_unit(light.direction) && is_finite(light.position);
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
