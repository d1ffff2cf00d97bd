// What the pointer does with the layers: it drags them, paints strokes and draws lassos.
// Directions are as seen, after the rotation.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/light/layers.h"
#include "viewer/light_desk.h"
#include "viewer/region_edit.h"

namespace relumine::viewer {

struct Held {
    std::size_t index = 0;
    Grip grip = Grip::None;
};

/// Returns the layer under a direction: the selected one first, then from the top. A layer that is
/// off counts only if selected. Grip::None means no layer.
[[nodiscard]] Held held_at(const LightDesk& desk, const glm::dvec3& direction,
                           double tolerance_degrees);

/// One gesture after the other, each an edit in progress until it ends.
class Gestures {
public:
    /// The desk must outlive this object.
    explicit Gestures(LightDesk& desk) : desk_(desk) {}

    /// Takes hold of a layer's body or rim.
    void begin_drag(const Held& held, const glm::dvec3& direction);
    /// Begins a stroke on top of the layers. Points closer than a quarter of the radius to the last
    /// one are left out.
    void begin_stroke(const cubemap::LightLayer& brush, const glm::dvec3& direction);
    /// Draws an outline, at first without any effect.
    void begin_lasso(const glm::dvec3& direction) { lasso_ = {direction}; }
    [[nodiscard]] bool is_dragging() const { return drag_.has_value(); }
    [[nodiscard]] bool is_painting() const { return painting_; }
    /// The outline so far; empty when none is drawn.
    [[nodiscard]] std::span<const glm::dvec3> lasso() const { return lasso_; }

    /// Goes on with what was begun. Points of an outline that are closer than
    /// `lasso_spacing_degrees` to the last one are left out.
    void move_to(const glm::dvec3& direction, double lasso_spacing_degrees = 0.0);

    /// Ends a drag or a stroke: one step of undo.
    void end();
    /// Adds `layer` on top, its lasso with the outline's points, as one step of undo, and selects
    /// it. It returns false, and adds nothing, for too few points.
    ///
    /// Throws:  std::invalid_argument for an outline that no lasso can have.
    bool end_lasso(cubemap::LightLayer layer);

    /// Seconds of every event of a drag or a stroke so far.
    [[nodiscard]] std::span<const double> seconds() const { return seconds_; }

private:
    struct Drag {
        Held held;
        cubemap::Region region;
        glm::dvec3 from{0.0, 0.0, 1.0};
    };

    LightDesk& desk_;
    std::optional<Drag> drag_;
    bool painting_ = false;
    std::vector<glm::dvec3> lasso_;
    std::vector<double> seconds_;
};

} // namespace relumine::viewer
