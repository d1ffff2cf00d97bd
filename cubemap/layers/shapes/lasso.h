// Outlines that are drawn around a part of the environment.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/arc_tree.h"
#include "cubemap/layers/shapes/layer_shape.h"

namespace relumine::cubemap {

class LassoShape;

/// A polygon on the sphere. Its edges are arcs of great circles; the last point joins the first. An
/// area that the polygon encloses twice is outside. Coverage rises smoothly from 0 at the outline
/// to 1 at `softness_degrees` inside it.
struct Lasso {
    /// At least 3 directions of any length but zero, all within 89.9 degrees of their mean.
    std::vector<glm::dvec3> points = {};
    /// In [0, 90]. 0: a hard edge.
    double softness_degrees = 0.0;
    bool operator==(const Lasso&) const = default;

    using Prepared = LassoShape;
    static constexpr ShapeWords Words{
        .name = "lasso",
        .label = "lasso",
        .hint = "dims or brightens what you draw an outline around: drag in the environment",
        .about = "A polygon of great-circle arcs."};
    static Lasso as_added() { return {.softness_degrees = 3.0}; }
    [[nodiscard]] std::vector<LayerField> fields();
    void check() const;
    [[nodiscard]] std::vector<glm::dvec3> outline() const;
    void resize(const glm::dvec3& from, const glm::dvec3& to);
    void turn_upright(double) {}
};

/// A lasso with the arcs of its outline that matter.
class LassoShape {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    explicit LassoShape(const Lasso& lasso);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] bool has_kink(std::size_t i, const glm::dvec3& w, double chord) const;
    [[nodiscard]] double smallest_feature() const { return extent_ / 256.0; }
    [[nodiscard]] LassoShape within(const glm::dvec3& w, double chord) const;

private:
    LassoShape(const LassoShape& wider, const NearArcs& outline)
        : mean_(wider.mean_), first_(wider.first_), second_(wider.second_), band_(wider.band_),
          extent_(wider.extent_), outline_(outline), side_(wider.side_) {}
    [[nodiscard]] bool inside(const glm::dvec3& w) const;

    /// Axes of the plane that touches the sphere at the lasso's mean.
    glm::dvec3 mean_, first_, second_;
    /// Chords.
    double band_, extent_ = 0.0;
    /// The tree of the whole lasso's outline; null in a narrowed shape.
    std::shared_ptr<ArcTree> tree_ = nullptr;
    NearArcs outline_;
    /// True or false if all directions in the ball are inside or outside. Empty: the outline may
    /// cross the ball.
    std::optional<bool> side_ = {};
};

} // namespace relumine::cubemap
