// The moves of a scene that is lit.
#pragma once

#include <optional>
#include <vector>

#include "prt/moves/scene_change.h"
#include "relight/relighter.h"
#include "relumine/in/drag.h"
#include "relumine/in/move.h"

namespace relumine {

/// Returns the clusters that a quick state samples in their middle alone: those with no more light
/// than a cluster has in the mean.
[[nodiscard]] std::vector<bool> coarse_clusters(const relight::Relighter& relighter);

/// Moves groups of a scene, undoes it, and drags one of them. Each function returns what differs
/// from before the call, good until the next one. While a group is dragged only drag() and
/// take_back() may be called.
class SceneMoves {
public:
    /// They must outlive this object.
    SceneMoves(Scene& scene, SceneRays& rays) : scene_(scene), rays_(rays) {}

    /// Throws:  as relumine::move().
    const prt::SceneChange& move(const GroupMove& to, const PrecomputeWork& work,
                                 MoveReport& report);
    /// Undoes the last move, or makes it again. Returns null where there is none.
    const prt::SceneChange* exchange(bool is_undo);

    /// Begins a drag, or goes on with it: as GroupDrag::to(). The group stays the same.
    const prt::SceneChange& drag(const GroupMove& to, std::vector<bool> coarse, MoveReport& report);
    /// The last place of the drag
    [[nodiscard]] const std::optional<GroupMove>& dragged() const { return dragged_; }
    /// Ends the drag: the group stands where it stood before.
    const prt::SceneChange& take_back();

private:
    Scene& scene_;
    SceneRays& rays_;
    std::optional<GroupDrag> drag_;
    std::optional<GroupMove> dragged_;
    /// The last ones are next.
    std::vector<prt::SceneChange> moves_, undone_;
    prt::SceneChange of_drag_;
};

} // namespace relumine
