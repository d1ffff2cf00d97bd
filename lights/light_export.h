// Light lists as text for other programs. Units and axes of each: docs/light-lists.md and the head
// of each file.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "lights/light_file.h"

namespace relumine::lights {

/// What a light list can be written as. Only Json is read back.
enum class LightFormat {
    /// .json: lights/light_file.h
    Json,
    /// .csv: direction, irradiance, solid angle per line
    Csv,
    /// .pbrt: pbrt-v4, LightSource "distant"
    Pbrt,
    /// .xml: Mitsuba 3, emitter "directional"
    Mitsuba,
    /// .usda: UsdLux DistantLight
    Usd,
    /// .py: a script for Blender 2.8 or newer that makes sun lamps
    Blender,
    /// .gltf: KHR_lights_punctual, directional
    Gltf,
};
inline constexpr std::array AllLightFormats = {
    LightFormat::Json, LightFormat::Csv,     LightFormat::Pbrt, LightFormat::Mitsuba,
    LightFormat::Usd,  LightFormat::Blender, LightFormat::Gltf};

/// "json", "csv", "pbrt", "mitsuba", "usd", "blender", "gltf".
[[nodiscard]] std::string_view name(LightFormat format);
/// ".json", ".csv", ".pbrt", ".xml", ".usda", ".py", ".gltf".
[[nodiscard]] std::string_view extension(LightFormat format);
/// The format of a name, or of a path's extension; nothing for others.
[[nodiscard]] std::optional<LightFormat> light_format_named(std::string_view name);
[[nodiscard]] std::optional<LightFormat> light_format_of(const std::filesystem::path& path);

struct ExportOptions {
    /// Lights as wide as the part of the sphere they stand for, where the format knows an angle
    /// (USD, Blender): softer shadows. Otherwise all light comes from one direction.
    bool soft = false;
    /// glTF's unit is the lux. Most viewers take it for whatever unit the materials and other
    /// lights are in: 1. For true lux of an environment in W/(m^2 sr): 683.
    double lumens_per_watt = 1.0;
};

/// The file's text; all numbers read back to the same doubles, but colours times intensity where a
/// format has both. Throws std::invalid_argument for lists that validate() refuses.
[[nodiscard]] std::string light_text(const LightList& list, LightFormat format,
                                     const ExportOptions& options = {});

/// Writes light_text(). Whole or not at all. Throws std::runtime_error naming the file, too.
void export_lights(const std::filesystem::path& path, const LightList& list, LightFormat format,
                   const ExportOptions& options = {});

} // namespace relumine::lights
