// The numbers of a light layer, by their names in layer files, key frames, Python and the window.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Numbers from one to another.
struct FieldRange {
    double from = -std::numeric_limits<double>::infinity();
    double to = std::numeric_limits<double>::infinity();
};

/// The numbers of a layer under one name. Exactly one of the pointers is set. The end of a name
/// says the unit: `_degrees`, `_ev` for stops. A name that begins with "softness" is the width of a
/// soft edge, and 0 makes the edge hard.
struct LayerField {
    std::string_view name;
    /// Layer files may say this instead; empty: nothing else.
    std::string_view other_name = {};
    /// True if a layer file must give the field. Other fields have the default of the header.
    bool required = false;
    /// What a `number` may be; every finite number by default.
    FieldRange range = {};
    /// The end of the range is excluded.
    bool below_end = false;
    /// The least number above 0, where the range begins at 0.
    double least_but_zero = 0.0;
    /// What a slider offers, where it is not the range.
    std::optional<FieldRange> slider = {};
    bool logarithmic_slider = false;
    /// The least number of `points`.
    std::size_t at_least = 1;
    bool* flag = nullptr;
    double* number = nullptr;
    float* single = nullptr;
    glm::vec3* colour = nullptr;
    glm::dvec3* direction = nullptr;
    std::vector<glm::dvec3>* points = nullptr;
};

/// The field "direction" of a shape with a centre.
[[nodiscard]] LayerField direction_field(glm::dvec3& direction);
/// The field "points" of a shape that is drawn.
[[nodiscard]] LayerField points_field(std::vector<glm::dvec3>& points, std::size_t at_least);
/// The field "softness", a part of the shape's size.
[[nodiscard]] LayerField softness_field(double& softness);

/// The least size of a shape in degrees, that of a star. Texels are quartered until the shape is
/// not small any more; for a shape without size this would never end.
inline constexpr double SmallestSize = 1e-4;

/// Returns a field's numbers: 1 number, 3 numbers, or 3 per point. A flag is 0 or 1.
[[nodiscard]] std::vector<double> values(const LayerField& field);

/// Sets a field from as many numbers as values() returns. Points take any multiple of 3.
void set_values(const LayerField& field, std::span<const double> numbers);

/// Checks directions, points and numbers: finite, of a length, in their ranges.
/// Throws:  as refuse().
void check(const LayerField& field);

/// Throws std::invalid_argument "expected WHAT EXPECTED, got GOT".
[[noreturn]] void refuse(std::string_view what, std::string_view expected, const std::string& got);

} // namespace relumine::cubemap
