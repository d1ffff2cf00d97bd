// Regions of light layers made ready for many questions: axes, squared chords and trees, computed
// once.
//
// A shape answers two questions without arctangents. bound(): is a ball around a direction outside,
// in the flat part, or neither? All distances are chords, so that the triangle inequality holds.
// ramps(): the coverage at a direction is the product of smoothsteps of these numbers (0 and less:
// none, 1 and more: all), which are nearly linear over a small cell.
//
// within() gives a shape that answers the same for directions within a chord of a unit direction,
// bit by bit, but looks only at what of the region matters there: who halves blocks of texels
// narrows the shape on the way down.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/layers/arc_tree.h"
#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

enum class Overlap { None, Part, All };

class DiscShape {
public:
    static constexpr std::size_t NumRamps = 1;
    /// 1 at a cell's corners means 1 all over it
    static constexpr bool HasConcaveRamps = false;
    explicit DiscShape(const Disc& disc);

    /// Of all directions within a chord of a unit direction. None and All are certain, Part is not.
    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    /// Whether ramp i may have a kink that samples within a chord do not show.
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    /// Cells of this chord radius are small against the region's features.
    [[nodiscard]] double smallest_feature() const { return smallest_feature_; }
    [[nodiscard]] const DiscShape& within(const glm::dvec3&, double) const { return *this; }

private:
    glm::dvec3 axis_;
    /// chords
    double outer_, inner_;
    double squared_outer_, inverse_band_, smallest_feature_;
};

class RectangleShape {
public:
    static constexpr std::size_t NumRamps = 2;
    static constexpr bool HasConcaveRamps = true;
    explicit RectangleShape(const Rectangle& rectangle);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] bool has_kink(std::size_t i, const glm::dvec3& w, double chord) const;
    [[nodiscard]] double smallest_feature() const { return smallest_feature_; }
    [[nodiscard]] const RectangleShape& within(const glm::dvec3&, double) const { return *this; }

    /// Position in a picture that fills the rectangle, [0, 1]^2 from the top left, clamped to it.
    [[nodiscard]] glm::dvec2 picture_position(const glm::dvec3& w) const;
    /// Solid angle of a small part of the rectangle around w, over its part of the picture's area.
    [[nodiscard]] double solid_angle_of_picture(const glm::dvec3& w) const;
    [[nodiscard]] const glm::dvec2& half_sides() const { return half_; }

private:
    struct Side {
        double outer_norm, inner, inner_norm, inverse_band;
    };
    glm::dvec3 forward_, right_, up_;
    glm::dvec2 half_;
    std::array<Side, 2> sides_;
    /// Less than the depth (cosine to the axis) anywhere in the rectangle
    double min_depth_;
    double smallest_feature_;
};

/// Axes of the plane that touches the sphere at a lasso's mean.
struct LassoPlane {
    glm::dvec3 mean{0.0}, first{0.0}, second{0.0};
};
struct LassoSize {
    double band = 0.0, extent = 0.0, smallest_feature = 0.0;
};
struct StrokeSize {
    /// chords
    double outer = 0.0, inner = 0.0;
    double squared_outer = 0.0, inverse_band = 0.0, smallest_feature = 0.0;
};

/// With all arcs of its outline (ArcTree), or with those that matter in a ball (NearArcs).
template<typename Arcs>
class LassoRamps {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    /// Only with ArcTree
    explicit LassoRamps(const Lasso& lasso);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] bool has_kink(std::size_t i, const glm::dvec3& w, double chord) const;
    [[nodiscard]] double smallest_feature() const { return size_.smallest_feature; }
    [[nodiscard]] LassoRamps<NearArcs> within(const glm::dvec3& w, double chord) const;

private:
    template<typename>
    friend class LassoRamps;
    LassoRamps(const LassoPlane& plane, const LassoSize& size, const Arcs& outline)
        : plane_(plane), size_(size), outline_(outline) {}
    [[nodiscard]] bool inside(const glm::dvec3& w) const;

    LassoPlane plane_;
    LassoSize size_;
    Arcs outline_;
    /// Of all directions that may be asked for, where the outline is not among them
    std::optional<bool> side_;
};
template<>
LassoRamps<ArcTree>::LassoRamps(const Lasso& lasso);
using LassoShape = LassoRamps<ArcTree>;

template<typename Arcs>
class StrokeRamps {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    /// Only with ArcTree
    explicit StrokeRamps(const Stroke& stroke);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    [[nodiscard]] double smallest_feature() const { return size_.smallest_feature; }
    [[nodiscard]] StrokeRamps<NearArcs> within(const glm::dvec3& w, double chord) const {
        return {size_, NearArcs(line_, w, chord)};
    }

private:
    template<typename>
    friend class StrokeRamps;
    StrokeRamps(const StrokeSize& size, const Arcs& line) : size_(size), line_(line) {}

    StrokeSize size_;
    Arcs line_;
};
template<>
StrokeRamps<ArcTree>::StrokeRamps(const Stroke& stroke);
using StrokeShape = StrokeRamps<ArcTree>;

using RegionShape = std::variant<DiscShape, RectangleShape, LassoShape, StrokeShape>;

/// Throws std::invalid_argument like validate().
[[nodiscard]] RegionShape shape(const Region& region);

/// From 0 at 0 to 1 at 1, level at both and beyond.
[[nodiscard]] double smoothstep(double t);

} // namespace relumine::cubemap
