// What the window edits: layers over an environment, with the selection and the cost of each edit.
// Works without a window.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/light_layer.h"
#include "cubemap/texel_rectangle.h"
#include "relight/light_editor.h"
#include "viewer/region_edit.h"

namespace relumine::viewer {

/// The effect of the last edit.
struct EditCost {
    relight::UpdateReport report;
    /// Compositing, relighting and publishing together.
    double seconds = 0.0;
};

/// A view of a LightEditor that counts its edits and remembers which layer is selected.
class LightDesk {
public:
    /// The editor must outlive the desk, and only the desk may edit it. The editor's present state
    /// becomes the state before all steps of undo.
    explicit LightDesk(relight::LightEditor& editor);

    [[nodiscard]] const relight::LightEditor& editor() const { return editor_; }
    [[nodiscard]] std::span<const cubemap::LightLayer> layers() const { return editor_.layers(); }

    [[nodiscard]] std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index) { selected_ = index; }

    /// Makes an edit: `work(editor)` changes the editor and returns what that took. Edits become a
    /// step of undo with finish(), all that came since the last one.
    template<typename Work>
    void edit(const Work& work) {
        const auto start = std::chrono::steady_clock::now();
        note_edit(report_of(work(editor_)), start);
    }
    /// Replaces a layer.
    void change(std::size_t index, const cubemap::LightLayer& layer) {
        edit([&](relight::LightEditor& editor) { return editor.set_layer(index, layer); });
    }
    void finish();
    void undo();
    void redo();

    /// Brings the next bounce of light where the light changed: to be called once per frame.
    void go_on();
    /// Brings all bounces.
    void settle();

    [[nodiscard]] const EditCost& last_cost() const { return last_cost_; }
    /// Counts changes of the radiance.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// Returns the environment's texels that changed since the last call.
    [[nodiscard]] std::vector<cubemap::TexelRectangle> take_changed_texels();

private:
    [[nodiscard]] static relight::UpdateReport report_of(const relight::UpdateReport& report) {
        return report;
    }
    /// Of an edit that lights everything anew.
    [[nodiscard]] relight::UpdateReport report_of(const relight::RelightTimes& times) const;
    void note_edit(const relight::UpdateReport& report,
                   std::chrono::steady_clock::time_point start);
    void note_all_texels();

    relight::LightEditor& editor_;
    std::optional<std::size_t> selected_;
    EditCost last_cost_;
    std::vector<cubemap::TexelRectangle> changed_texels_;
    std::uint64_t version_ = 1;
};

/// Returns the layer of a name.
[[nodiscard]] std::optional<std::size_t> find_layer(const LightDesk& desk, const std::string& name);

// Each of these functions makes one edit and one step of undo.

/// Adds a layer on top, selects it and returns its index. The name gets a number if a layer has the
/// same name.
std::size_t add_layer(LightDesk& desk, cubemap::LightLayer layer);
void remove_layer(LightDesk& desk, std::size_t index);
/// Moves a layer to the place of another one.
void reorder_layers(LightDesk& desk, std::size_t from, std::size_t to);
void replace_layers(LightDesk& desk, std::vector<cubemap::LightLayer> layers);

/// Turns environment and layers; not yet a step of undo.
void set_rotation(LightDesk& desk, double degrees);

/// The layer under a direction as seen, after the rotation: the selected one first, then from the
/// top. A layer that is off counts only if selected. Grip::None means no layer.
struct Held {
    std::size_t index = 0;
    Grip grip = Grip::None;
};
[[nodiscard]] Held held_at(const LightDesk& desk, const glm::dvec3& direction,
                           double tolerance_degrees);

/// What the pointer does to the environment from its press to its release: it drags a layer's body
/// or rim, paints a stroke on top of the layers, or draws the outline of a lasso, which has no
/// effect before its end. Directions are as seen. One step of undo.
class Gesture {
public:
    void begin_drag(LightDesk& desk, const Held& held, const glm::dvec3& direction);
    void begin_stroke(LightDesk& desk, const cubemap::LightLayer& brush,
                      const glm::dvec3& direction);
    void begin_lasso(const glm::dvec3& direction) { lasso_ = {direction}; }

    /// Goes on. Points of a stroke closer than a quarter of its radius to the last one are left
    /// out, and those of a lasso closer than `spacing_degrees`.
    void move_to(LightDesk& desk, const glm::dvec3& direction, double spacing_degrees = 0.0);

    /// Ends a drag or a stroke.
    void end(LightDesk& desk);
    /// Adds `layer` on top, its lasso with the outline's points, and selects it. Returns false, and
    /// adds nothing, for too few points.
    ///
    /// Throws:  std::invalid_argument for an outline that no lasso can have.
    bool end_lasso(LightDesk& desk, cubemap::LightLayer layer);

    /// A drag or a stroke is going on.
    [[nodiscard]] bool changes_light() const { return drag_ || painting_; }
    /// The outline so far; empty when none is drawn.
    [[nodiscard]] std::span<const glm::dvec3> lasso() const { return lasso_; }
    /// Seconds of every event of drags and strokes so far.
    [[nodiscard]] const std::vector<double>& seconds() const { return seconds_; }

private:
    struct Drag {
        std::size_t index = 0;
        Grip grip = Grip::Body;
        cubemap::Region region;
        glm::dvec3 from{0.0, 0.0, 1.0};
    };
    std::optional<Drag> drag_;
    bool painting_ = false;
    std::vector<glm::dvec3> lasso_;
    std::vector<double> seconds_;
};

} // namespace relumine::viewer
