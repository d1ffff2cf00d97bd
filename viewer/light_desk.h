// The state that the window edits: layers over an environment, the selection, the drag, and the
// cost of each edit. Works without a window.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
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

/// Edits the layers of a LightEditor. Directions are as seen, after the rotation.
class LightDesk {
public:
    /// The editor must outlive the desk, and only the desk may edit it. The editor's present state
    /// becomes the state before all steps of undo. `base_path` is the file of its base.
    explicit LightDesk(relight::LightEditor& editor, const std::filesystem::path& base_path = {});

    [[nodiscard]] const relight::LightEditor& editor() const { return editor_; }
    [[nodiscard]] std::span<const cubemap::LightLayer> layers() const { return editor_.layers(); }
    [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;

    [[nodiscard]] std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index) { selected_ = index; }

    // Each of these functions makes one edit and one step of undo.

    /// Adds a layer on top, selects it and returns its index. The name gets a number if a layer has
    /// the same name.
    std::size_t add(cubemap::LightLayer layer);
    void remove(std::size_t index);
    /// Moves a layer to the place of another one.
    void reorder(std::size_t from, std::size_t to);
    /// Replaces all layers.
    void replace(std::vector<cubemap::LightLayer> layers);
    void undo();
    void redo();

    // Edits in progress, for example while a slider moves. They become a step of undo with
    // finish().

    void change(std::size_t index, const cubemap::LightLayer& layer);
    void set_rotation(double degrees);
    /// `path` is the base's file; empty where there is none.
    void set_base(cubemap::CubeMap base, const std::filesystem::path& path = {});
    void finish();

    /// Brings the next bounce of light where the light changed: to be called once per frame.
    void go_on();
    /// Brings all bounces.
    void settle();

    /// The file of the present base, also after an undo; empty where there is none.
    [[nodiscard]] std::filesystem::path base_path() const;

    /// The layer under a direction: the selected one first, then from the top. A layer that is off
    /// counts only if selected. Grip::None means no layer.
    struct Held {
        std::size_t index = 0;
        Grip grip = Grip::None;
    };
    [[nodiscard]] Held held_at(const glm::dvec3& direction, double tolerance_degrees) const;

    /// Takes hold of a layer's body or rim, drags it, and lets go.
    void begin_drag(const Held& held, const glm::dvec3& direction);
    void drag_to(const glm::dvec3& direction);
    void end_drag();
    [[nodiscard]] bool is_dragging() const { return drag_.has_value(); }

    /// Begins a stroke on top of the layers, extends it, and ends it. Points closer than a quarter
    /// of the radius to the last one are left out.
    void begin_stroke(const cubemap::LightLayer& brush, const glm::dvec3& direction);
    void stroke_to(const glm::dvec3& direction);
    void end_stroke();
    [[nodiscard]] bool is_painting() const { return painting_; }

    /// Draws an outline, at first without any effect. end_lasso() adds `layer` on top, its lasso
    /// with these points, as one step of undo, and selects it. It returns false, and adds nothing,
    /// for too few points.
    ///
    /// Throws:  std::invalid_argument for an outline that no lasso can have.
    void begin_lasso(const glm::dvec3& direction);
    /// Points closer than `spacing_degrees` to the last one are left out.
    void lasso_to(const glm::dvec3& direction, double spacing_degrees);
    bool end_lasso(cubemap::LightLayer layer);
    /// The outline so far, as seen; empty when none is drawn.
    [[nodiscard]] std::span<const glm::dvec3> lasso() const { return lasso_; }

    [[nodiscard]] const EditCost& last_cost() const { return last_cost_; }
    /// Seconds of every drag event so far.
    [[nodiscard]] std::span<const double> drag_seconds() const { return drag_seconds_; }

    /// Counts changes of the radiance.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// Returns the environment's texels that changed since the last call.
    [[nodiscard]] std::vector<cubemap::TexelRectangle> take_changed_texels();

private:
    struct Drag {
        std::size_t index = 0;
        Grip grip = Grip::Body;
        cubemap::Region region;
        glm::dvec3 from{0.0, 0.0, 1.0};
    };
    template<typename Edit>
    void timed(Edit edit);
    [[nodiscard]] relight::UpdateReport whole(const relight::RelightTimes& times) const;
    void note_all_texels();
    void note_base_path(const std::filesystem::path& path);
    [[nodiscard]] std::string unused_name(const std::string& name) const;
    [[nodiscard]] std::vector<cubemap::LightLayer> copy() const {
        return {layers().begin(), layers().end()};
    }

    relight::LightEditor& editor_;
    std::optional<std::size_t> selected_;
    std::optional<Drag> drag_;
    bool painting_ = false;
    std::vector<glm::dvec3> lasso_;
    /// The files of bases that the history may return to.
    std::vector<std::pair<std::weak_ptr<const cubemap::CubeMap>, std::filesystem::path>>
        base_paths_;
    EditCost last_cost_;
    std::vector<double> drag_seconds_;
    std::vector<cubemap::TexelRectangle> changed_texels_;
    std::uint64_t version_ = 1;
};

} // namespace relumine::viewer
