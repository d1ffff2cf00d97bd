// The environment that lights a scene, as edits make it: base, layers, turn, and the states that
// undo goes back to.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/quick_turns.h"
#include "cubemap/texel_rectangle.h"
#include "relight/relighter.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/light.h"

namespace relumine {

using relight::UpdateReport;

/// How an edit ends.
enum class Ending {
    /// As Quick, but a turn is near, as cubemap::QuickTurns, and that of a map of at most
    /// MovingResolution: for a slider while it moves. Any other edit brings the whole map back.
    Moving,
    /// With what changed. The last bits may depend on the way to the state.
    Quick,
    /// All clusters are summed anew, and all bounces are found: the radiance is that of the state,
    /// bit by bit, whichever edits led to it.
    Exact,
};

/// Texels along a face's edge of maps that turn while a slider moves. Measured: their light differs
/// by at most 0.1 % (relative L2) from the whole map's, by 0.8 % under a sun.
inline constexpr std::uint32_t MovingResolution = 128;

/// Keeps the light of a Relighter that of the present state. All calls take the same one; its
/// environment is nobody else's to change.
class EditedEnvironment {
public:
    /// The environment with its layers and its turn. Its base has no map before the first edit.
    [[nodiscard]] const LightState& state() const { return state_; }
    [[nodiscard]] LightHistory& history() { return history_; }
    [[nodiscard]] bool is_edited() const { return state_.base && state_.base->map(); }

    /// Replaces the environment. Layers and turn stay, and lie over the new one.
    ///
    /// Throws:  std::invalid_argument as LitScene::light(); nothing has changed then.
    UpdateReport light(Light light, relight::Relighter& relighter);
    /// Forgets environment, layers and history.
    void clear();
    /// The environment, not edited so far, is no longer that of its file.
    void forget_file() { state_ = {}; }

    /// Makes the present environment the base of edits to come, and the first mark, unless that
    /// was done or there is none. Returns whether it has: the light is then as if the environment
    /// had just been set.
    bool begin(relight::Relighter& relighter);

    /// What a change of state was.
    struct Change {
        UpdateReport report;
        /// Everything was lit anew.
        bool is_whole = false;
        /// The light is another.
        bool is_other = false;
    };
    /// Goes to another state, after begin(). A state whose base has no map keeps the present one.
    ///
    /// Throws:  std::invalid_argument as LitScene::edit(); nothing has changed then.
    Change change(LightState next, Ending ending, relight::Relighter& relighter);

    /// Returns the state with a rectangle of the base's texels replaced. Only where is_edited().
    ///
    /// Throws:  std::invalid_argument as LitScene::update_region().
    [[nodiscard]] LightState with_region(const cubemap::TexelRectangle& rectangle,
                                         std::span<const glm::vec3> radiance) const;

private:
    UpdateReport relight_all(const LightState& next, relight::Relighter& relighter);
    UpdateReport relight_all(LayerCompositor compositor, relight::Relighter& relighter);
    UpdateReport relight_coarse(const LightState& next, relight::Relighter& relighter);
    Change update(const LightState& next, relight::Relighter& relighter);

    LightState state_;
    LightHistory history_;
    /// Composites state_, once it was edited.
    LayerCompositor compositor_;
    /// Room for the next turn's map.
    cubemap::CubeMap turning_memory_;
    /// What turns while a slider moves: the map of `of`, with fewer texels where it has many.
    struct Coarse {
        std::shared_ptr<const LightBase> of = {};
        std::optional<cubemap::QuickTurns> turns = {};
        /// Whether its light is the present one.
        bool is_shown = false;
    };
    Coarse coarse_;
};

/// Throws std::invalid_argument for a state with a turn that is not finite, or a layer that is not
/// valid.
void require_valid(const LightState& state);

} // namespace relumine
