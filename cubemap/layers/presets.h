// Lights to begin with, as a studio has them.
#pragma once

#include <span>
#include <string_view>

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

struct LayerPreset {
    /// In layer files: `"preset": "strip"`.
    std::string_view name;
    /// In the window.
    std::string_view hint;
    /// Has the preset's name. Its radiance says how strong it is beside the others.
    LightLayer layer;
};

/// Returns all presets.
[[nodiscard]] std::span<const LayerPreset> layer_presets();

/// Returns the preset of this name, or null.
[[nodiscard]] const LayerPreset* find_preset(std::string_view name);

/// Returns a preset's layer with its middle at a direction of any length but zero.
[[nodiscard]] LightLayer placed(const LayerPreset& preset, const glm::dvec3& direction);

} // namespace relumine::cubemap
