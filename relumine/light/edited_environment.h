// The environment that lights a scene, as edits make it: base, layers, turn, and the states that
// undo goes back to.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/texel_rectangle.h"
#include "relight/relighter.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/light.h"

namespace relumine::prt {
struct SceneChange;
} // namespace relumine::prt

namespace relumine {

using relight::UpdateReport;

/// How an edit ends.
enum class Ending {
    /// As Quick, for a slider while it moves: a turn is that of a map of at most MovingResolution.
    /// Any other edit brings the whole map back.
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

/// What an edit of the environment was.
struct EnvironmentChange {
    UpdateReport report = {};
    /// Everything was lit anew.
    bool is_whole = false;
    /// The light is another.
    bool is_other = false;
};

/// What lights a scene anew where a part of it has changed its own light, or the scene: LitScene.
class LightFollower {
public:
    /// The clusters' light was summed anew, as if the environment had just been set.
    virtual void follow_first_edit() = 0;
    /// The clusters have the light of an edited environment.
    virtual void follow(EnvironmentChange& change, Ending ending) = 0;
    /// The scene is another. Quickly: bounced light stays as it is, and goes along with what moves.
    virtual void follow(const prt::SceneChange& change, bool is_quick) = 0;

protected:
    ~LightFollower() = default;
};

/// The clusters' light. Throws std::invalid_argument where there is none: a mesh alone.
[[nodiscard]] relight::Relighter& require_clusters(relight::Relighter* relighter);

/// The environment of a scene that is lit, with its layers and its turn.
class EditedEnvironment {
public:
    /// Keeps the light of a Relighter, or of none, that of the present state. Both must outlive
    /// this object, and the Relighter's environment is nobody else's to change.
    EditedEnvironment(relight::Relighter* relighter, LightFollower& follower)
        : relighter_(relighter), follower_(follower) {}

    /// Base, layers and turn. The base has no map before the first edit.
    [[nodiscard]] const LightState& state() const { return state_; }
    /// Marks of states: see mark() of edits.h.
    [[nodiscard]] LightHistory& history() { return history_; }
    [[nodiscard]] const LightHistory& history() const { return history_; }
    [[nodiscard]] bool is_edited() const { return state_.base && state_.base->map(); }
    /// Whether there is one.
    [[nodiscard]] bool is_lit() const {
        return relighter_ != nullptr && relighter_->environment().resolution != 0;
    }

    /// Changes base, layers or turn, and updates the scene's light where it depends on them [JN,
    /// Section 5.2]. With another turn or resolution everything is relit. Bounces stay those of the
    /// light before, until the next call of LitScene::bounce(). The functions of light/edits.h are
    /// made of it. A base without a map is the present one.
    ///
    /// Throws:  std::invalid_argument for a layer that is not valid, a turn that is not finite,
    ///          radiance that is too large, or no environment; nothing has changed then.
    /// Cost:    proportional to what the changed layers cover. The first call relights everything
    ///          once more.
    UpdateReport edit(LightState next, Ending ending = Ending::Quick);

    /// Replaces a rectangle of the environment's texels, row by row [(x1 - x0) * (y1 - y0)], and
    /// updates the scene's light where it depends on them. Under layers, the environment is the
    /// base, and finding what changed costs a comparison of the whole map.
    ///
    /// Throws:  std::invalid_argument for a rectangle outside of the face, a wrong size, radiance
    ///          that is not finite or negative, or no environment; nothing has changed then.
    UpdateReport update_region(const cubemap::TexelRectangle& rectangle,
                               std::span<const glm::vec3> radiance);

private:
    friend class LitScene;

    /// Replaces the environment. Layers and turn stay, and lie over the new one.
    ///
    /// Throws:  std::invalid_argument as LitScene::light(); nothing has changed then.
    UpdateReport light(Light light);
    /// Forgets environment, layers and history.
    void clear();
    /// Returns the radiance of a level floor in the open under the base alone, for albedo 1.
    [[nodiscard]] glm::dvec3 open_floor_of_base() const;

    void begin();
    [[nodiscard]] EnvironmentChange change(LightState next, Ending ending);
    [[nodiscard]] LightState with_region(const cubemap::TexelRectangle& rectangle,
                                         std::span<const glm::vec3> radiance) const;
    UpdateReport relight_all(const LightState& next);
    UpdateReport relight_all(LayerCompositor compositor);
    UpdateReport relight_coarse(const LightState& next);
    EnvironmentChange update(const LightState& next);

    relight::Relighter* relighter_;
    LightFollower& follower_;
    LightState state_;
    LightHistory history_;
    /// Composites state_, once it was edited.
    LayerCompositor compositor_;
    /// Room for the next turn's map.
    cubemap::CubeMap turning_memory_;
    /// What turns while a slider moves: the map of `of`, with fewer texels.
    struct Coarse {
        std::shared_ptr<const LightBase> of = {};
        std::shared_ptr<const cubemap::CubeMap> map = {};
        /// Whether its light is the present one.
        bool is_shown = false;
    };
    Coarse coarse_;
    /// The base whose open floor is known
    mutable std::shared_ptr<const LightBase> open_of_;
    mutable glm::dvec3 open_of_base_{0.0};
};

/// Throws std::invalid_argument for a state with a turn that is not finite, or a layer that is not
/// valid.
void require_valid(const LightState& state);

} // namespace relumine
