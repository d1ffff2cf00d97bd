// The numbers of a light layer, by their names in layer files and key frames.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// The numbers of a layer under one name. Exactly one of the pointers is set.
struct LayerField {
    std::string_view name;
    /// True if a layer file must give the field. Other fields have the default of light_layer.h.
    bool required = false;
    bool* flag = nullptr;
    double* number = nullptr;
    float* single = nullptr;
    glm::vec3* colour = nullptr;
    glm::dvec3* direction = nullptr;
    std::vector<glm::dvec3>* points = nullptr;
};

/// Returns the fields of a layer with this region and effect, in the order in which they are
/// written. The pointers are valid until the region or the effect is replaced.
[[nodiscard]] std::vector<LayerField> fields(LightLayer& layer);

/// Returns a field's numbers: 1 number, 3 numbers, or 3 per point. A flag is 0 or 1.
[[nodiscard]] std::vector<double> values(const LayerField& field);

/// Sets a field from as many numbers as values() returns. Points take any multiple of 3.
void set_values(const LayerField& field, std::span<const double> numbers);

/// Returns "disc", "rectangle", "lasso" or "stroke".
[[nodiscard]] std::string_view type_name(const Region& region);
/// Returns "emit", "gain" or "image".
[[nodiscard]] std::string_view effect_name(const Effect& effect);

} // namespace relumine::cubemap
