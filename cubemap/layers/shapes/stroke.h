// Brush strokes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/arc_tree.h"
#include "cubemap/layers/layer_shape.h"

namespace relumine::cubemap {

template<typename Arcs>
class StrokeRamps;

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

    using Prepared = StrokeRamps<ArcTree>;
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

/// A stroke with all arcs of its line (ArcTree), or with the arcs that matter in a ball (NearArcs).
template<typename Arcs>
class StrokeRamps {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    explicit StrokeRamps(const Stroke& stroke) requires std::same_as<Arcs, ArcTree>;

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    [[nodiscard]] double smallest_feature() const { return size_.outer / 64.0; }
    [[nodiscard]] StrokeRamps<NearArcs> within(const glm::dvec3& w, double chord) const {
        return {size_, NearArcs(line_, w, chord)};
    }

private:
    /// Chords.
    struct Size {
        double outer, inner, squared_outer, inverse_band;
    };
    template<typename>
    friend class StrokeRamps;
    template<typename OtherSize>
    StrokeRamps(const OtherSize& size, const Arcs& line)
        : size_{size.outer, size.inner, size.squared_outer, size.inverse_band}, line_(line) {}

    Size size_;
    Arcs line_;
};

} // namespace relumine::cubemap
