#include "relumine/in/emission.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/joined.h"
#include "prt/lamps/lamps.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

/// Returns the group of lamps of each receiver, [num_receivers]; empty where nothing glows.
std::vector<std::uint32_t> receiver_groups(const Scene& scene) {
    const std::vector<std::uint32_t> of_triangles = prt::lamp_groups(scene.mesh, scene.lamps);
    std::vector<std::uint32_t> result;
    if (of_triangles.empty())
        return result;
    result.assign(scene.receivers.size(), prt::NoGroup);
    if (!scene.receivers.points.empty()) {
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = of_triangles[scene.receivers.points[i].triangle];
        return result;
    }
    // A vertex has the surface of its lowest triangle.
    for (std::size_t i = scene.mesh.num_triangles(); i-- > 0;)
        for (const std::uint32_t vertex : scene.mesh.triangles[i])
            result[vertex] = of_triangles[i];
    return result;
}

/// Returns the factor on each group of lamps, and then that on all else.
std::vector<glm::vec3> group_gains(const Scene& scene, std::span<const EmissionGain> gains) {
    std::vector<glm::vec3> result;
    for (const std::string& name : scene.lamps.groups)
        result.push_back(gain_of(gains, name));
    result.push_back(gain_of(gains, ""));
    return result;
}

/// Whether a light that has a place and no surface has this name.
bool takes_profile(const prt::Lamps& lamps, const std::string& name) {
    return std::any_of(lamps.lights.begin(), lamps.lights.end(), [&](const auto& light) {
        return light.name == name && light.kind != mesh::PunctualLight::Kind::Directional;
    });
}

const glm::vec3& at(const std::vector<glm::vec3>& gains, std::uint32_t group) {
    return group == prt::NoGroup ? gains.back() : gains[group];
}

} // namespace

EmissionGain EmissionText::read(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos)
        return {.gain = ColorText::read(text)};
    EmissionGain result{.name = text.substr(0, equals)};
    const std::string value = text.substr(equals + 1);
    if (!result.name.empty() && files::extension_of(value) == ".ies") {
        result.profile_file = value;
        return result;
    }
    const auto numbers = parse_numbers(value);
    if (result.name.empty() || !numbers || (numbers->size() != 1 && numbers->size() != 4))
        refuse_text("a number, R,G,B, NAME=GAIN[,R,G,B] or NAME=PROFILE.ies", text);
    const std::size_t comma = value.find(',');
    result.gain = ColorText::read(value.substr(0, comma));
    if (comma != std::string::npos)
        result.gain *= ColorText::read(value.substr(comma + 1));
    return result;
}

std::string EmissionText::show(const EmissionGain& gain) {
    if (!gain.profile_file.empty())
        return gain.name + "=" + gain.profile_file;
    std::string color = ColorText::show(gain.gain);
    if (gain.name.empty())
        return color;
    return gain.name + (color.find(',') == std::string::npos ? "=" : "=1,") + color;
}

glm::vec3 gain_of(std::span<const EmissionGain> gains, const std::string& name) {
    glm::vec3 result(1.0f);
    for (const EmissionGain& gain : gains)
        if (gain.name.empty() || gain.name == name)
            result *= gain.gain;
    return result;
}

mesh::LightProfile profile_of(std::span<const EmissionGain> gains, const std::string& name) {
    mesh::LightProfile result;
    for (const EmissionGain& gain : gains)
        if (gain.name == name && !gain.profile_file.empty())
            result = gain.profile;
    return result;
}

void load_profiles(std::vector<EmissionGain>& gains) {
    for (EmissionGain& gain : gains)
        if (!gain.profile_file.empty() && gain.profile.empty())
            gain.profile = mesh::load_light_profile(gain.profile_file).profile;
}

void require_lamps(const Scene& scene, std::span<const EmissionGain> gains) {
    const std::vector<std::string> names = scene.lamps.names();
    for (const EmissionGain& gain : gains) {
        if (gain.name.empty() || std::find(names.begin(), names.end(), gain.name) != names.end()) {
            if (!gain.profile_file.empty() && !takes_profile(scene.lamps, gain.name))
                throw std::invalid_argument(
                    fmt::format("expected a point or a spot without a surface for {}, got '{}'",
                                gain.profile_file, gain.name));
            continue;
        }
        constexpr std::size_t MostNames = 8;
        const auto shown = std::span(names).first(std::min(names.size(), MostNames));
        throw std::invalid_argument(
            names.empty()
                ? fmt::format("expected no name, since the scene has no lamps, got '{}'", gain.name)
                : fmt::format("expected a lamp of the scene ({}{}), got '{}'",
                              files::joined(shown, ", "), names.size() > MostNames ? ", ..." : "",
                              gain.name));
    }
}

void shape(mesh::PunctualLight& light, std::span<const EmissionGain> gains) {
    mesh::LightProfile profile = profile_of(gains, light.name);
    if (profile.empty() || light.kind == mesh::PunctualLight::Kind::Directional)
        return;
    light.kind = mesh::PunctualLight::Kind::Profile;
    light.profile = std::move(profile);
    const float strength = std::max({light.intensity.r, light.intensity.g, light.intensity.b});
    if (strength > 0.0f)
        light.intensity /= strength;
}

prt::Lamps dimmed(prt::Lamps lamps, std::span<const EmissionGain> gains) {
    for (prt::Emitter& emitter : lamps.emitters)
        emitter.radiance *= gain_of(gains, lamps.groups[emitter.group]);
    for (mesh::PunctualLight& light : lamps.lights) {
        shape(light, gains);
        light.intensity *= gain_of(gains, light.name);
    }
    return lamps;
}

std::vector<glm::vec3> triangle_gains(const Scene& scene, std::span<const EmissionGain> gains) {
    const std::vector<glm::vec3> of_groups = group_gains(scene, gains);
    std::vector<glm::vec3> result(scene.mesh.num_triangles(), of_groups.back());
    for (const prt::Emitter& emitter : scene.lamps.emitters)
        result[emitter.triangle] = of_groups[emitter.group];
    return result;
}

std::vector<glm::vec3> emission_of(const Scene& scene, std::span<const EmissionGain> gains) {
    std::vector<glm::vec3> result;
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    const auto is_dark = [](const prt::Surface& surface) {
        return surface.emission == glm::vec3(0.0f);
    };
    // A texture may glow between dark vertices.
    const bool may_glow =
        prt::on_vertices(scene.layout) && !surfaces.empty() &&
        std::any_of(scene.mesh.materials.begin(), scene.mesh.materials.end(),
                    [](const mesh::Material& material) {
                        return material.emission != glm::vec3(0.0f) && material.emission_texture;
                    });
    if (!may_glow && std::all_of(surfaces.begin(), surfaces.end(), is_dark))
        return result;
    const std::vector<std::uint32_t> groups = receiver_groups(scene);
    const std::vector<glm::vec3> of_groups = group_gains(scene, gains);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        result.push_back(surfaces[i].emission *
                         at(of_groups, groups.empty() ? prt::NoGroup : groups[i]));
    return result;
}

} // namespace relumine
