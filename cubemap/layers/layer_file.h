// Light layers in JSON files. docs/light-layers.md describes the format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// The value of one field of a layer at a key frame.
struct KeyedValue {
    /// The layer's name.
    std::string layer;
    /// The field's name in the file: "direction", "gain_ev", "radiance", ...
    std::string field;
    /// 1 number, 3 numbers of a vector, or 3 per point. "on" is 0 or 1.
    std::vector<double> values;
    bool operator==(const KeyedValue&) const = default;
};

/// The values of fields at one frame.
struct KeyFrame {
    double frame = 0.0;
    std::vector<KeyedValue> changes;
    bool operator==(const KeyFrame&) const = default;
};

/// The content of a layer file.
struct LightLayers {
    /// The environment below the layers, relative to the file's folder as the file names it: open
    /// `file.parent_path() / *base`. Empty: the file names none.
    std::optional<std::filesystem::path> base = {};
    /// Turns the environment and the layers together about +Y, degrees, as cubemap::rotated().
    /// Empty: the file does not say.
    std::optional<double> rotate_degrees = {};
    /// Layers, the lowest first. No two have the same name.
    std::vector<LightLayer> layers = {};
    /// Key frames, frame numbers ascending.
    std::vector<KeyFrame> frames = {};
    bool operator==(const LightLayers&) const = default;
};

/// Reads a file and the pictures it names.
///
/// Throws:  std::runtime_error "path:line: expected X, got Y" for anything that the format does not
///          allow, unknown fields included.
[[nodiscard]] LightLayers load_layers(const std::filesystem::path& path);

/// Returns the text of a file that load_layers() reads back to the same values, bit by bit.
///
/// Throws:  std::invalid_argument for layers that load_layers() would refuse.
[[nodiscard]] std::string json_text(const LightLayers& layers);

/// Writes json_text(). The file appears whole or not at all. Pictures are named, not written.
///
/// Throws:  as json_text(), and std::runtime_error naming the file.
void save_layers(const std::filesystem::path& path, const LightLayers& layers);

/// Returns the layers at a frame, which may lie between whole frames. Each keyed field is
/// interpolated between the two key frames around `frame` that name the field: numbers linearly,
/// directions and points on the great circle. `on` holds from its key frame on. Before its first
/// and after its last key frame a field keeps its value there.
///
/// Throws:  std::invalid_argument if an interpolated layer is invalid.
[[nodiscard]] std::vector<LightLayer> layers_at(const LightLayers& layers, double frame);

} // namespace relumine::cubemap
