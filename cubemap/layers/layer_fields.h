// The numbers of a light layer by the names they have in layer files and key frames.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// Numbers of a layer under one name. One of the pointers is set.
struct LayerField {
    std::string_view name;
    /// By a layer file; others have the default of light_layer.h
    bool required = false;
    bool* flag = nullptr;
    double* number = nullptr;
    float* single = nullptr;
    glm::vec3* colour = nullptr;
    glm::dvec3* direction = nullptr;
    std::vector<glm::dvec3>* points = nullptr;
};

/// The fields that a layer of this region and effect has, in the order they are written. Valid
/// while neither is replaced.
[[nodiscard]] std::vector<LayerField> fields(LightLayer& layer);

/// A field's numbers: 1, 3, or 3 per point; a flag is 0 or 1.
[[nodiscard]] std::vector<double> values(const LayerField& field);

/// Sets a field from as many numbers as values() has (points: any multiple of 3).
void set_values(const LayerField& field, std::span<const double> numbers);

/// "disc", "rectangle", "lasso", "stroke".
[[nodiscard]] std::string_view type_name(const Region& region);
/// "emit", "gain", "image".
[[nodiscard]] std::string_view effect_name(const Effect& effect);

} // namespace relumine::cubemap
