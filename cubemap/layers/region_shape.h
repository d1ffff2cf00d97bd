// Regions of light layers, prepared for many questions: axes, squared chords and trees are computed
// once.
//
// A shape answers two questions without arctangents.
// - bound(): is a ball around a direction outside the region, in its flat part, or neither? All
//   distances are chords, so the triangle inequality holds.
// - ramps(): numbers that are nearly linear over a small square. Coverage is the product of their
//   smoothsteps: 0 or less is none, 1 or more is all.
//
// within() narrows a shape to the directions within a chord of a unit direction. For these
// directions the narrowed shape gives the same answers, bit by bit, but looks only at the part of
// the region that matters there. Code that halves blocks of texels narrows the shape on the way
// down.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/layers/arc_tree.h"
#include "cubemap/layers/light_layer.h"

namespace relumine::cubemap {

/// How a region meets a set of directions: outside, partly or unknown, in its flat part.
enum class Overlap { None, Part, All };

/// A Disc. The other shapes have the same functions.
class DiscShape {
public:
    static constexpr std::size_t NumRamps = 1;
    /// True if a ramp of 1 at a square's corners is 1 all over the square.
    static constexpr bool HasConcaveRamps = false;
    explicit DiscShape(const Disc& disc);

    /// Returns how the region meets all directions within a chord of a unit direction. None and All
    /// are certain, Part is not.
    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const {
        const double squared = squared_distance(w);
        const double reach = outer_ + chord, room = inner_ - chord;
        if (squared >= reach * reach)
            return Overlap::None;
        return room >= 0.0 && squared <= room * room ? Overlap::All : Overlap::Part;
    }
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const {
        return {(squared_outer_ - squared_distance(w)) * inverse_band_};
    }
    /// Returns true if ramp i may have a kink within a chord that samples there do not show.
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    /// Returns a chord radius at which a square is small against the region's features.
    [[nodiscard]] double smallest_feature() const { return smallest_feature_; }
    [[nodiscard]] const DiscShape& within(const glm::dvec3&, double) const { return *this; }

private:
    [[nodiscard]] double squared_distance(const glm::dvec3& w) const {
        return glm::dot(w - axis_, w - axis_);
    }

    glm::dvec3 axis_;
    /// Chords.
    double outer_, inner_;
    double squared_outer_, inverse_band_, smallest_feature_;
};

/// A Rectangle.
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

    /// Returns the position in a picture that fills the rectangle, in [0, 1]^2 from the top left.
    /// Positions outside are clamped.
    [[nodiscard]] glm::dvec2 picture_position(const glm::dvec3& w) const;
    /// Returns the ratio of solid angle to picture area for a small part of the rectangle around w.
    [[nodiscard]] double solid_angle_of_picture(const glm::dvec3& w) const;
    [[nodiscard]] const glm::dvec2& half_sides() const { return half_; }

private:
    struct Side {
        double outer_norm, inner, inner_norm, inverse_band;
    };
    glm::dvec3 forward_, right_, up_;
    glm::dvec2 half_;
    std::array<Side, 2> sides_;
    /// A bound below the depth (cosine to the axis) anywhere in the rectangle.
    double min_depth_;
    double smallest_feature_;
};

/// Axes of the plane that touches the sphere at a lasso's mean.
struct LassoPlane {
    glm::dvec3 mean{0.0}, first{0.0}, second{0.0};
};
/// Lengths of a lasso as chords.
struct LassoSize {
    double band = 0.0, extent = 0.0, smallest_feature = 0.0;
};
/// Lengths of a stroke.
struct StrokeSize {
    /// Chords.
    double outer = 0.0, inner = 0.0;
    double squared_outer = 0.0, inverse_band = 0.0, smallest_feature = 0.0;
};

/// A lasso with all arcs of its outline (ArcTree), or with the arcs that matter in a ball
/// (NearArcs).
template<typename Arcs>
class LassoRamps {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    /// Only for ArcTree.
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
    /// True or false if all directions in the ball are inside or outside. Empty: the outline may
    /// cross the ball.
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
    /// Only for ArcTree.
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

/// Prepares a region.
/// Throws:  std::invalid_argument as validate() does.
[[nodiscard]] RegionShape shape(const Region& region);

/// Rises from 0 at t = 0 to 1 at t = 1, and is level at both ends and beyond.
[[nodiscard]] double smoothstep(double t);

} // namespace relumine::cubemap
