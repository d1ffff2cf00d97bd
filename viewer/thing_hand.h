// What the pointer does with the things of the scene, the groups of its mesh: it drags and turns
// them, or takes them away. Works without a window.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/in/move.h"
#include "viewer/light_desk.h"
#include "viewer/orbit_camera.h"

namespace relumine::viewer {

/// A thing that the eye sees, and the point of it, as the mesh has it.
struct SeenThing {
    std::string name;
    glm::vec3 point{0.0f};
};

/// Returns what a ray of the eye meets first; nothing where it meets no mesh.
///
/// Throws:  std::invalid_argument for a scene whose things cannot move.
[[nodiscard]] std::optional<SeenThing> thing_at(const LitScene& lit, const Ray& ray);

/// Returns how far a point goes within a plane through it to where a ray meets the plane; nothing
/// where that is behind the eye or beyond `reach`.
[[nodiscard]] std::optional<glm::dvec3> step_to(const glm::dvec3& point, const Ray& ray,
                                                const glm::vec3& normal, double reach);

/// Drags one thing after the other, each a step of undo.
class ThingHand {
public:
    /// The desk must outlive this object.
    explicit ThingHand(LightDesk& desk) : desk_(desk) {}

    /// Takes hold of what a ray of the eye meets. Returns false where it meets nothing.
    ///
    /// Throws:  as thing_at().
    bool begin(const Ray& ray);
    [[nodiscard]] bool is_dragging() const { return step_.has_value(); }
    /// How the thing has moved so far, as `relumine move` takes it.
    [[nodiscard]] const std::optional<GroupStep>& step() const { return step_; }

    /// Lets the point that was taken follow the pointer, within the plane through it with this
    /// normal, and turns the thing about the vertical through its middle. Shows it there quickly.
    ///
    /// Throws:  as SceneMoves::drag(); the drag is then taken back.
    void move_to(const Ray& ray, const glm::vec3& normal, double turn_degrees = 0.0);
    /// Puts the thing down where it is.
    void end();
    /// Takes the thing that is held out of the scene.
    void take_away();

    /// Seconds of every event of a drag so far.
    [[nodiscard]] std::span<const double> seconds() const { return seconds_; }

private:
    void let_go();

    LightDesk& desk_;
    std::optional<GroupStep> step_;
    /// The thing's middle when it was taken, and the point that was, now
    glm::dvec3 middle_{0.0}, point_{0.0};
    /// Whether the scene shows the drag.
    bool is_shown_ = false;
    std::vector<double> seconds_;
};

} // namespace relumine::viewer
