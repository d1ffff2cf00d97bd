// Moves of groups of a scene that is lit.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "prt/moves/scene_change.h"
#include "relight/relighter.h"
#include "relumine/in/drag.h"
#include "relumine/in/move.h"
#include "relumine/light/edited_environment.h"

namespace relumine {

/// Moves groups of a scene's mesh, undoes that, and drags one of them. Each time the scene is lit
/// again by the light that it has: environment, layers, lists, lamps and bounces. The radiance is
/// bit by bit that of another LitScene of the moved scene in this light.
///
///     lit.moves().move(relumine::move_of(lit.scene(), {.name = "chair", .by = {0.5, 0, 0}}));
///     lit.moves().undo();
class SceneMoves {
public:
    /// `own` is the scene where nobody else has it, otherwise null. `relighter` is null without
    /// clusters. All must outlive this object.
    SceneMoves(const Scene& scene, Scene* own, SceneRays& rays, relight::Relighter* relighter,
               LightFollower& follower)
        : scene_(scene), own_(own), rays_(rays), relighter_(relighter), follower_(follower) {}

    /// Throws:  as relumine::move(); std::logic_error where the scene is shared, by other users or
    ///          processes, or others than its triangles block light.
    /// Cost:    what the move changes. Lamps, bounces, and lists beside an environment are found
    ///          anew (docs/moves.md).
    MoveReport move(const GroupMove& to, const PrecomputeWork& work = {}) {
        return move(std::span(&to, 1), work);
    }
    /// Moves several groups at once, as relumine::move(): one step of undo().
    MoveReport move(std::span<const GroupMove> to, const PrecomputeWork& work = {});

    /// Drags a group: `to` leads from where it stood when the drag began. Quicker than move(), and
    /// for the eye: clusters with little light are sampled in their middle alone, and bounced light
    /// stays as it was. The scene has such counts until drop(), which moves the group there as
    /// move() does. undo(), another move() and a drag of another group take the drag back first.
    ///
    /// Throws:  as move(); drop() std::logic_error where nothing is dragged. A drop() that is
    ///          cancelled takes the drag back.
    MoveReport drag(const GroupMove& to);
    MoveReport drop(const PrecomputeWork& work = {});
    [[nodiscard]] bool is_dragging() const { return dragged_.has_value(); }

    /// Undoes the last move that is not undone, or makes it again. Nothing of it is traced anew but
    /// what lights of their own need. The last 32 moves are kept. Returns whether there was one.
    ///
    /// Throws:  as move().
    bool undo() { return exchange(moves_, undone_); }
    bool redo() { return exchange(undone_, moves_); }

private:
    void require_movable() const;
    void take_back(bool is_quick);
    bool exchange(std::vector<prt::SceneChange>& from, std::vector<prt::SceneChange>& to);

    const Scene& scene_;
    Scene* own_;
    SceneRays& rays_;
    relight::Relighter* relighter_;
    LightFollower& follower_;
    std::optional<GroupDrag> drag_;
    /// The last place of the drag
    std::optional<GroupMove> dragged_;
    /// The last ones are next.
    std::vector<prt::SceneChange> moves_, undone_;
};

} // namespace relumine
