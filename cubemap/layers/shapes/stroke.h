// Brush strokes.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/arc_tree.h"
#include "cubemap/layers/shapes/layer_shape.h"

namespace relumine::cubemap {

class StrokeShape;

/// A brush stroke: all directions within `radius` of a line of great-circle arcs from point to
/// point. One point is a dab. Coverage depends on the distance to the line as in a Disc.
struct Stroke {
    /// At least 1 direction of any length but zero. No two neighbours are opposite each other.
    std::vector<glm::dvec3> points = {};
    /// Above 0, up to 90.
    double radius_degrees = 2.0;
    /// In [0, 1]. 0: a hard edge.
    double softness = 0.5;
    bool operator==(const Stroke&) const = default;

    using Prepared = StrokeShape;
    static constexpr ShapeWords Words{.name = "stroke",
                                      .label = "stroke",
                                      .hint = "paint light: drag in the environment",
                                      .about = "A brush stroke along great-circle arcs."};
    static Stroke as_added() { return {.radius_degrees = 4.0}; }
    [[nodiscard]] std::vector<LayerField> fields();
    void check() const;
    /// Both sides of the line and round ends: the border wherever it does not cross itself.
    [[nodiscard]] std::vector<glm::dvec3> outline() const;
    void resize(const glm::dvec3& from, const glm::dvec3& to);
    void turn_upright(double) {}
};

/// A stroke with the arcs of its line that matter.
class StrokeShape {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    explicit StrokeShape(const Stroke& stroke);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    [[nodiscard]] double smallest_feature() const { return outer_ / 64.0; }
    [[nodiscard]] StrokeShape within(const glm::dvec3& w, double chord) const {
        return {*this, NearArcs(line_, w, chord)};
    }

private:
    StrokeShape(const StrokeShape& wider, const NearArcs& line)
        : outer_(wider.outer_), inner_(wider.inner_), squared_outer_(wider.squared_outer_),
          inverse_band_(wider.inverse_band_), line_(line) {}

    /// Chords.
    double outer_, inner_;
    double squared_outer_, inverse_band_;
    /// The tree of the whole stroke's line; null in a narrowed shape.
    std::shared_ptr<ArcTree> tree_ = nullptr;
    NearArcs line_;
};

} // namespace relumine::cubemap
