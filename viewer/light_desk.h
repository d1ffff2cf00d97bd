// What the window edits: the light of a scene, the selected layer, and the cost of each edit. Works
// without a window.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "relumine/light/edits.h"
#include "relumine/light/layers.h"
#include "relumine/light/lit_scene.h"
#include "relumine/light/scene_moves.h"

namespace relumine::viewer {

/// The effect of the last edit.
struct EditCost {
    UpdateReport report;
    /// Compositing and relighting together.
    double seconds = 0.0;
};

/// Edits the light of a LitScene.
class LightDesk {
public:
    /// The scene must outlive the desk, and only the desk may edit its light. An environment lights
    /// it; the present state becomes the state before all steps of undo.
    explicit LightDesk(LitScene& lit);

    [[nodiscard]] const LitScene& lit() const { return lit_; }
    [[nodiscard]] const LightState& state() const { return lit_.environment().state(); }
    [[nodiscard]] std::span<const cubemap::LightLayer> layers() const { return state().layers; }
    [[nodiscard]] const LightHistory& history() const { return lit_.environment().history(); }

    [[nodiscard]] std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index) { selected_ = index; }

    /// Changes the light. finish() makes all edits since the last step of undo one step.
    void edit(LightState next, Ending ending = Ending::Quick);
    void finish();
    /// Undoes the last step: a change of the light or a move. A drag() is taken back.
    void undo();
    void redo();

    /// Move groups of the scene, as SceneMoves does: move() and drop() are steps of undo.
    ///
    /// Throws:  as LitScene does.
    void move(const GroupMove& to);
    void drag(const GroupMove& to);
    void drop();
    [[nodiscard]] bool is_dragging() const { return lit_.moves().is_dragging(); }
    /// Sets what is called before a group moves: nothing may trace the scene's rays meanwhile.
    void on_move(std::function<void()> stop) { stop_ = std::move(stop); }
    /// Counts changes of the mesh.
    [[nodiscard]] std::uint64_t mesh_version() const { return mesh_version_; }

    /// Dims and colours the scene's own lamps. That is no step of undo.
    ///
    /// Throws:  as LitScene::dim().
    void dim(std::vector<EmissionGain> gains);

    /// Sets the roughness of highlights that follow the eye. That is no step of undo. Nothing may
    /// draw the scene meanwhile.
    ///
    /// Throws:  as LitScene::set_roughness().
    void set_roughness(float roughness);

    /// Brings the next bounce of light where the light changed, or all bounces: to be called once
    /// per frame.
    void bounce(bool all = false);

    [[nodiscard]] const EditCost& last_cost() const { return last_cost_; }
    /// Counts changes of the radiance.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// Returns the environment's texels that changed since the last call.
    [[nodiscard]] std::vector<cubemap::TexelRectangle> take_changed_texels();

private:
    template<typename Edit>
    void timed(Edit edit);
    template<typename Move>
    void moving(Move move);
    bool exchange_move(bool is_undo);
    void note_all_texels();

    LitScene& lit_;
    std::optional<std::size_t> selected_;
    EditCost last_cost_;
    std::vector<cubemap::TexelRectangle> changed_texels_;
    std::uint64_t version_ = 1;
    std::function<void()> stop_ = [] {
    };
    std::uint64_t mesh_version_ = 1;
    /// The light when groups were moved, and when that was undone
    std::vector<LightState> moved_in_, undone_in_;
};

[[nodiscard]] std::optional<std::size_t> find(const LightDesk& desk, const std::string& name);

/// Returns the factor on a lamp; without a name that on all.
[[nodiscard]] glm::vec3 dimmer(const LightDesk& desk, const std::string& name);
/// Sets it. Throws as LitScene::dim().
void set_dimmer(LightDesk& desk, const std::string& name, const glm::vec3& gain);

// Edits in progress, for example while a slider moves.

void change(LightDesk& desk, std::size_t index, const cubemap::LightLayer& layer);
/// Moves a layer so that its middle is at a direction, as seen after the rotation.
void move_middle(LightDesk& desk, std::size_t index, const glm::dvec3& direction);
/// While the slider moves the turn is that of a coarser map: see Ending::Moving.
void set_rotation(LightDesk& desk, double degrees);
void set_base(LightDesk& desk, Environment environment);
/// Adds a layer on top, selects it and returns its index. The name gets a number if a layer has the
/// same name.
std::size_t put_on_top(LightDesk& desk, cubemap::LightLayer layer);

// Each of these functions makes one step of undo.

std::size_t add(LightDesk& desk, cubemap::LightLayer layer);
void remove(LightDesk& desk, std::size_t index);
/// Moves a layer to the place of another one.
void reorder(LightDesk& desk, std::size_t from, std::size_t to);
void set_solo(LightDesk& desk, std::size_t index, bool solo);
/// Replaces all layers.
void replace(LightDesk& desk, std::vector<cubemap::LightLayer> layers);

} // namespace relumine::viewer
