// Light lists as text for other programs. docs/light-lists.md and the head of each file state units
// and axes.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "lights/light_file.h"

namespace relumine::lights {

/// The formats of a light list. Only Json can be read back.
enum class LightFormat {
    /// .json, see lights/light_file.h.
    Json,
    /// .csv: direction, irradiance and solid angle per line.
    Csv,
    /// .pbrt: pbrt-v4, LightSource "distant".
    Pbrt,
    /// .xml: Mitsuba 3, emitter "directional".
    Mitsuba,
    /// .usda: UsdLux DistantLight.
    Usd,
    /// .py: a script that makes sun lamps in Blender 2.8 or newer.
    Blender,
    /// .gltf: KHR_lights_punctual, directional.
    Gltf,
};
inline constexpr std::array AllLightFormats = {
    LightFormat::Json, LightFormat::Csv,     LightFormat::Pbrt, LightFormat::Mitsuba,
    LightFormat::Usd,  LightFormat::Blender, LightFormat::Gltf};

/// Returns "json", "csv", "pbrt", "mitsuba", "usd", "blender" or "gltf".
[[nodiscard]] std::string_view name(LightFormat format);
/// Returns ".json", ".csv", ".pbrt", ".xml", ".usda", ".py" or ".gltf".
[[nodiscard]] std::string_view extension(LightFormat format);
/// Returns the format of a name. Nothing for an unknown name.
[[nodiscard]] std::optional<LightFormat> light_format_named(std::string_view name);
/// Returns the format of a path's extension. Nothing for any other extension.
[[nodiscard]] std::optional<LightFormat> light_format_of(const std::filesystem::path& path);

/// Returns true if a light of the format has a size: its solid angle or an angle.
[[nodiscard]] bool holds_soft_lights(LightFormat format);

/// Choices of the formats that have them.
struct ExportOptions {
    /// True: lights are as wide as the part of the sphere they stand for, in formats with an angle
    /// (holds_soft_lights()), and shadows are softer. False: all light comes from one direction; in
    /// USD from the width of the sun, the least that all its renderers take.
    bool soft = false;
    /// Factor for glTF, whose unit is the lux. 1 suits most viewers, which take the lux for the
    /// unit of the materials and other lights. 683 gives true lux for an environment in W/(m^2 sr).
    double lumens_per_watt = 1.0;
};

/// Returns the file's text. All numbers read back to the same doubles; only colours times intensity
/// may not, in formats that have both.
/// Throws:  std::invalid_argument for lists that validate() refuses.
[[nodiscard]] std::string light_text(const LightList& list, LightFormat format,
                                     const ExportOptions& options = {});

/// Writes light_text(). The file appears whole or not at all.
/// Throws:  as light_text(), and std::runtime_error naming the file.
void export_lights(const std::filesystem::path& path, const LightList& list, LightFormat format,
                   const ExportOptions& options = {});

} // namespace relumine::lights
