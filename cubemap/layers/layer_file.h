// Light layers in JSON files. The format: docs/light-layers.md.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// A number of a layer at a key frame.
struct KeyedValue {
    /// The layer's name
    std::string layer;
    /// As in the file: "direction", "gain_ev", "radiance", ...
    std::string field;
    /// 1 number; 3 of a vector; 3 per point; "on" as 0 or 1
    std::vector<double> values;
    bool operator==(const KeyedValue&) const = default;
};

struct KeyFrame {
    double frame = 0.0;
    std::vector<KeyedValue> changes;
    bool operator==(const KeyFrame&) const = default;
};

/// What a layer file holds.
struct LightLayers {
    /// The environment below, as the file names it: relative to the file's folder
    /// (`file.parent_path() / *base`).
    std::optional<std::filesystem::path> base = {};
    /// The first lowest; names differ
    std::vector<LightLayer> layers = {};
    /// ascending
    std::vector<KeyFrame> frames = {};
    bool operator==(const LightLayers&) const = default;
};

/// Reads a file and the pictures it names. Throws std::runtime_error "path:line: expected X, got Y"
/// for anything that is not as the format's page says, unknown fields included.
[[nodiscard]] LightLayers load_layers(const std::filesystem::path& path);

/// Writes a file that load_layers() reads back to the same values, bit by bit. Whole or not at all.
/// Pictures are named, not written. Throws std::invalid_argument for what load_layers() would
/// refuse, std::runtime_error naming the file.
void save_layers(const std::filesystem::path& path, const LightLayers& layers);

/// The layers at a frame, whole or between: each keyed field is interpolated between the key frames
/// around it that name it, numbers linearly, directions and points on the great circle, `on` from
/// its key frame on; before the first and after the last it keeps their value. Throws
/// std::invalid_argument if an interpolated layer is invalid.
[[nodiscard]] std::vector<LightLayer> layers_at(const LightLayers& layers, double frame);

} // namespace relumine::cubemap
