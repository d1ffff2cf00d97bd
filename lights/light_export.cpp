#include "lights/light_export.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "files/counted.h"
#include "files/json.h"
#include "files/output_file.h"

namespace relumine::lights {

namespace {

struct FormatName {
    LightFormat format;
    std::string_view name, extension;
};
constexpr std::array<FormatName, AllLightFormats.size()> FormatNames = {{
    {LightFormat::Json, "json", ".json"},
    {LightFormat::Csv, "csv", ".csv"},
    {LightFormat::Pbrt, "pbrt", ".pbrt"},
    {LightFormat::Mitsuba, "mitsuba", ".xml"},
    {LightFormat::Usd, "usd", ".usda"},
    {LightFormat::Blender, "blender", ".py"},
    {LightFormat::Gltf, "gltf", ".gltf"},
}};

const FormatName& names_of(LightFormat format) {
    return FormatNames.at(static_cast<std::size_t>(format));
}

/// Returns a name for a comment: ASCII, without anything that could end a comment or a string.
std::string harmless(const std::string& name) {
    std::string result;
    for (const char c : name) {
        const bool is_plain = c >= ' ' && c <= '~' && c != '"' && c != '\\';
        result += is_plain ? c : '?';
    }
    for (std::size_t at = result.find("--"); at != std::string::npos; at = result.find("--"))
        result[at + 1] = '_';
    return result;
}

/// Returns the first line of every file's head: "64 lights of grace.hdr by median-cut".
std::string title(const LightList& list) {
    std::string result = files::counted(list.lights.size(), "distant light");
    if (!list.environment.empty())
        result += fmt::format(" of {}", harmless(list.environment));
    if (!list.method.empty())
        result += fmt::format(", {}", harmless(list.method));
    if (list.seed)
        result += fmt::format(", seed {}", *list.seed);
    return result + ", made by relumine.";
}

constexpr std::string_view Unit =
    "Irradiance is that on a surface facing the light, linear RGB (Rec. 709): "
    "the environment's radiance times steradians, "
    "W/m^2 if its radiance is W/(m^2 sr).";
constexpr std::string_view Axes =
    "Axes: right-handed, +Y up, as the environment's: the centre of a lat-long is +Z.";

/// Returns the diameter in radians of a disc with the solid angle 2 pi (1 - cos(diameter / 2)).
double angular_diameter(double solid_angle) {
    return 4.0 * std::asin(std::clamp(std::sqrt(solid_angle / (4.0 * std::numbers::pi)), 0.0, 1.0));
}

/// A colour whose largest channel is 1, and the intensity to multiply it by.
struct ColourAndIntensity {
    glm::dvec3 colour{1.0};
    double intensity = 0.0;
};
ColourAndIntensity split(const glm::dvec3& irradiance) {
    const double largest = std::max({irradiance.r, irradiance.g, irradiance.b});
    return largest > 0.0 ? ColourAndIntensity{irradiance / largest, largest} : ColourAndIntensity{};
}

/// Right, up and back axes of a light. The back axis, local +Z, points at the light, which shines
/// along local -Z.
struct LightFrame {
    glm::dvec3 right, up, back;
};
LightFrame frame_of(const glm::dvec3& direction) {
    const glm::dvec3 helper =
        std::abs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 right = glm::normalize(glm::cross(helper, direction));
    return {right, glm::cross(direction, right), direction};
}

std::string csv_text(const LightList& list) {
    std::string text = fmt::format(
        "# {}\n# {}\n# {} direction_* points from the scene to the light, unit length.\n"
        "# solid_angle: steradians of the environment that the light stands for.\n"
        "direction_x,direction_y,direction_z,irradiance_r,irradiance_g,irradiance_b,solid_angle\n",
        title(list), Unit, Axes);
    for (const auto& [d, e, solid_angle] : list.lights)
        text += fmt::format("{},{},{},{},{},{},{}\n", d.x, d.y, d.z, e.r, e.g, e.b, solid_angle);
    return text;
}

/// Axes as in the pictures that `relumine env convert --to pbrt` writes.
std::string pbrt_text(const LightList& list) {
    std::string text = fmt::format(
        "# {}\n# {}\n"
        "# Axes: +Z up, as `relumine env convert --to pbrt` writes pictures: (x, y, z) of the "
        "environment is (x, -z, y) here.\n"
        "# Meshes with +Y up stand upright after Rotate 90 1 0 0.\n"
        "# pbrt-v4: paste after WorldBegin. \"from\" \"to\" say where the light goes: from\n"
        "# the light's direction to the scene. \"L\" of a distant light is its irradiance on a "
        "surface "
        "facing it; a white diffuse\n"
        "# surface shows L / pi. No \"illuminance\": it would replace the strengths given here.\n",
        title(list), Unit);
    for (const auto& [d, e, solid_angle] : list.lights)
        text += fmt::format(
            "LightSource \"distant\" \"point3 from\" [ {} {} {} ] \"point3 to\" [ 0 0 0 ] \"rgb "
            "L\" [ {} {} {} ]\n",
            d.x, 0.0 - d.z, d.y, e.r, e.g, e.b);
    return text;
}

std::string mitsuba_text(const LightList& list) {
    std::string text = fmt::format("<!-- {}\n     {}\n     {}\n"
                                   "     Mitsuba 3: a scene to <include>, or paste its emitters. "
                                   "\"direction\" is where the light goes: "
                                   "away from the light, towards\n"
                                   "     the scene. \"irradiance\" is that on a surface normal to "
                                   "it. -->\n<scene version=\"3.0.0\">\n",
                                   title(list), Unit, Axes);
    for (const auto& [d, e, solid_angle] : list.lights)
        text += fmt::format("    <emitter type=\"directional\"><vector name=\"direction\" x=\"{}\" "
                            "y=\"{}\" z=\"{}\"/>"
                            "<rgb name=\"irradiance\" value=\"{}, {}, {}\"/></emitter>\n",
                            0.0 - d.x, 0.0 - d.y, 0.0 - d.z, e.r, e.g, e.b);
    return text + "</scene>\n";
}

std::string usd_text(const LightList& list, const ExportOptions& options) {
    // UsdLux's own angle is 0.53, the sun's. Renderers disagree about 0, and beyond a half-sphere
    // intensity with `normalize` is no longer the irradiance.
    constexpr double SmallestAngle = 0.53, LargestAngle = 180.0;
    std::string text = fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"Lights\"\n    upAxis = \"Y\"\n    doc = "
        "\"\"\"{}\n{}\n{}\n"
        "A DistantLight shines along its local -Z. With inputs:normalize = 1, intensity times "
        "color is the "
        "irradiance on a surface\n"
        "facing the light, whatever inputs:angle (degrees across, {} to {}).\"\"\"\n)\n\n"
        "def Scope \"Lights\"\n{{\n",
        title(list), Unit, Axes, SmallestAngle, LargestAngle);
    std::size_t index = 0;
    for (const DistantLight& light : list.lights) {
        const auto [colour, intensity] = split(light.irradiance);
        const auto [right, up, back] = frame_of(light.direction);
        const double degrees =
            options.soft
                ? std::clamp(angular_diameter(light.solid_angle) * 180.0 / std::numbers::pi,
                             SmallestAngle, LargestAngle)
                : SmallestAngle;
        text += fmt::format(
            "    def DistantLight \"Light_{}\"\n    {{\n"
            "        float inputs:angle = {}\n        color3f inputs:color = ({}, {}, {})\n"
            "        float inputs:intensity = {}\n        bool inputs:normalize = 1\n"
            "        matrix4d xformOp:transform = ( ({}, {}, {}, 0), ({}, {}, {}, 0), ({}, {}, "
            "{}, 0), (0, 0, 0, 1) )\n"
            "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n",
            index++, degrees, colour.r, colour.g, colour.b, intensity, right.x, right.y, right.z,
            up.x, up.y, up.z, back.x, back.y, back.z);
    }
    return text + "}\n";
}

std::string blender_text(const LightList& list, const ExportOptions& options) {
    std::string text = fmt::format(
        "# {}\n# {}\n# {}\n"
        "# Blender 2.8 or newer: run in the text editor, or blender SCENE.blend --python "
        "THIS_FILE. Blender's world is +Z up: the script\n"
        "# takes (x, y, z) to (x, -z, y), as Blender's importers take meshes with +Y up. A sun "
        "lamp shines along its local -Z; its\n"
        "# strength, \"energy\", is irradiance in W/m^2 on a surface facing it, times its "
        "colour; \"angle\" is its diameter in radians.\n"
        "import bpy\nfrom mathutils import Vector\n\n"
        "# direction to the light x, y, z; irradiance r, g, b; angle\nLIGHTS = [\n",
        title(list), Unit, Axes);
    for (const DistantLight& light : list.lights)
        text += fmt::format("    ({}, {}, {}, {}, {}, {}, {}),\n", light.direction.x,
                            light.direction.y, light.direction.z, light.irradiance.r,
                            light.irradiance.g, light.irradiance.b,
                            options.soft ? angular_diameter(light.solid_angle) : 0.0);
    text += "]\n\n"
            "collection = bpy.data.collections.new(\"Relumine lights\")\n"
            "bpy.context.scene.collection.children.link(collection)\n"
            "for index, (x, y, z, r, g, b, angle) in enumerate(LIGHTS):\n"
            "    strength = max(r, g, b)\n"
            "    lamp = bpy.data.lights.new(\"Light %d\" % index, 'SUN')\n"
            "    lamp.energy = strength\n"
            "    lamp.color = (r / strength, g / strength, b / strength) if strength > 0 else (1, "
            "1, 1)\n"
            "    lamp.angle = min(angle, 3.14159)\n"
            "    thing = bpy.data.objects.new(lamp.name, lamp)\n"
            "    thing.rotation_mode = 'QUATERNION'\n"
            "    thing.rotation_quaternion = Vector((x, -z, y)).to_track_quat('Z', 'Y')\n"
            "    collection.objects.link(thing)\n";
    return text;
}

std::string gltf_text(const LightList& list, const ExportOptions& options) {
    using files::Json;
    const std::string comment = fmt::format(
        "{} {} {} A directional light shines along its node's local -Z. glTF's intensity is "
        "illuminance in lux: here irradiance times {} "
        "lm/W; 1 keeps the environment's own unit, as viewers without photometric units expect "
        "it, 683 makes lux of W/m^2.",
        title(list), Unit, Axes, options.lumens_per_watt);
    Json lights = Json::Array{};
    Json nodes = Json::Array{};
    Json indices = Json::Array{};
    for (const DistantLight& light : list.lights) {
        const auto [colour, intensity] = split(light.irradiance);
        const auto [right, up, back] = frame_of(light.direction);
        const glm::dquat turn = glm::normalize(glm::quat_cast(glm::dmat3(right, up, back)));
        const std::string name = fmt::format("Light {}", lights.size());
        indices.push_back(nodes.size());
        nodes.push_back({{"name", name},
                         {"rotation", {turn.x, turn.y, turn.z, turn.w}},
                         {"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}});
        lights.push_back({{"name", name},
                          {"type", "directional"},
                          {"color", {colour.r, colour.g, colour.b}},
                          {"intensity", intensity * options.lumens_per_watt}});
    }
    const Json root = {
        {"asset",
         {{"version", "2.0"}, {"generator", "relumine"}, {"extras", {{"comment", comment}}}}},
        {"extensionsUsed", {"KHR_lights_punctual"}},
        {"extensions", {{"KHR_lights_punctual", {{"lights", lights}}}}},
        {"scene", 0},
        {"scenes", {{{"nodes", indices}}}},
        {"nodes", nodes}};
    return root.text(1, Json::Order::Set, Json::Utf8::Require) + "\n";
}

} // namespace

std::string_view name(LightFormat format) {
    return names_of(format).name;
}

std::string_view extension(LightFormat format) {
    return names_of(format).extension;
}

std::optional<LightFormat> light_format_named(std::string_view wanted) {
    for (const FormatName& entry : FormatNames)
        if (entry.name == wanted)
            return entry.format;
    return std::nullopt;
}

std::optional<LightFormat> light_format_of(const std::filesystem::path& path) {
    for (const FormatName& entry : FormatNames)
        if (entry.extension == path.extension().string())
            return entry.format;
    return std::nullopt;
}

bool holds_soft_lights(LightFormat format) {
    return format != LightFormat::Pbrt && format != LightFormat::Mitsuba &&
           format != LightFormat::Gltf;
}

std::string light_text(const LightList& list, LightFormat format, const ExportOptions& options) {
    validate(list);
    switch (format) {
    case LightFormat::Json:
        return json_text(list);
    case LightFormat::Csv:
        return csv_text(list);
    case LightFormat::Pbrt:
        return pbrt_text(list);
    case LightFormat::Mitsuba:
        return mitsuba_text(list);
    case LightFormat::Usd:
        return usd_text(list, options);
    case LightFormat::Blender:
        return blender_text(list, options);
    case LightFormat::Gltf:
        return gltf_text(list, options);
    }
    throw std::invalid_argument("expected a format");
}

void export_lights(const std::filesystem::path& path, const LightList& list, LightFormat format,
                   const ExportOptions& options) {
    files::save_text(path, light_text(list, format, options));
}

} // namespace relumine::lights
