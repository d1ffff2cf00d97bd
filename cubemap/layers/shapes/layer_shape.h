// What the shape of a layer's region must say of itself. A shape is one pair of files in shapes/
// and one line in region.h.
#pragma once

#include <algorithm>
#include <concepts>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/layer_field.h"

namespace relumine::cubemap {

/// How a shape is called.
struct ShapeWords {
    /// In layer files. Python's class has the same name with a capital letter.
    std::string_view name;
    /// In the window.
    std::string_view label;
    /// In the window, for the button that adds one.
    std::string_view hint;
    /// The docstring of Python's class.
    std::string_view about;
};

/// How a region meets a set of directions: outside, partly or unknown, in its flat part.
enum class Overlap { None, Part, All };

/// A shape prepared for many questions: axes, squared chords and trees are computed once. It
/// answers two questions without arctangents.
///
/// - bound(w, chord): how does the region meet all directions within a chord of a unit direction?
///   None and All are certain, Part is not. All distances are chords, so the triangle inequality
///   holds.
/// - ramps(w): numbers that are nearly linear over a small square. Coverage is the product of their
///   smoothsteps: 0 or less is none, 1 or more is all.
///
/// has_kink(i, w, chord): ramp i may have a kink within a chord that samples there do not show.
/// smallest_feature(): a chord radius at which a square is small against the region's features.
/// HasConcaveRamps: a ramp of 1 at a square's corners is 1 all over the square.
/// within(w, chord): the shape narrowed to the directions within a chord of a unit direction. For
/// these directions it gives the same answers, bit by bit, but looks only at the part of the region
/// that matters there. Code that halves blocks of texels narrows the shape on the way down.
template<typename T>
concept PreparedShape = requires(const T shape, const glm::dvec3 w, double chord) {
    { shape.bound(w, chord) } -> std::same_as<Overlap>;
    { shape.ramps(w).size() == T::NumRamps } -> std::same_as<bool>;
    { shape.has_kink(0, w, chord) } -> std::same_as<bool>;
    { shape.smallest_feature() } -> std::same_as<double>;
    { T::HasConcaveRamps } -> std::convertible_to<bool>;
    shape.within(w, chord);
};

/// The numbers of a shape, and what is done with it.
///
/// fields(): its numbers in the order of layer files, those that are required first. They are
/// written, read, checked, keyed, turned and shown by this list.
/// check(): what the ranges of the fields do not say.
/// as_added(): as the window adds one.
/// outline(): its border as a closed line of unit directions, the first one repeated at the end.
/// resize(from, to): its rim was dragged from one unit direction to another. It stays valid.
/// turn_upright(degrees): called before its directions are turned about +Y, for what no direction
/// says.
template<typename T>
concept LayerShape = std::equality_comparable<T> && PreparedShape<typename T::Prepared> &&
                     std::constructible_from<typename T::Prepared, const T&> &&
                     requires(T shape, const T constant, const glm::dvec3 w, double degrees) {
                         { T::Words } -> std::convertible_to<ShapeWords>;
                         { shape.fields() } -> std::same_as<std::vector<LayerField>>;
                         constant.check();
                         { T::as_added() } -> std::same_as<T>;
                         { constant.outline() } -> std::same_as<std::vector<glm::dvec3>>;
                         shape.resize(w, w);
                         shape.turn_upright(degrees);
                     };

/// Width of a hard edge's ramp relative to the size: far below a texel, far above rounding.
inline constexpr double HardEdge = 1e-9;

/// Returns 1 / (outer^2 - inner^2). The ramp of a disc is linear in squared chords, so in cosines.
inline double inverse_band(double outer, double inner) {
    return 1.0 / std::max((outer - inner) * (outer + inner), HardEdge * outer * outer);
}

} // namespace relumine::cubemap
