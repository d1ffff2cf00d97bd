// A group of a scene while it is dragged.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/moves/scene_change.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/move.h"

namespace relumine {

/// Moves a group of a scene to and fro for a while, quicker than move(). First the scene is counted
/// without the group. At each place, what its receivers see is multiplied with what passes the
/// group there. Bounces stay. The counts are a matter of the place alone, and go back bit by bit.
class GroupDrag {
public:
    /// Takes the group of a move, which stays where it is. The scene, whose rays follow, must
    /// outlive this object, and only this object may change it.
    ///
    /// Throws:  std::invalid_argument as move(); nothing has changed then.
    /// Cost:    as a move.
    GroupDrag(Scene& scene, SceneRays& rays, const GroupMove& to);
    GroupDrag(const GroupDrag&) = delete;
    GroupDrag& operator=(const GroupDrag&) = delete;

    /// Puts the group where a move takes it from where it stood at first. `coarse` is
    /// RecountOptions::coarse. Returns what differs from before the call, as prt::outline().
    ///
    /// Throws:  std::invalid_argument as move(); nothing has changed then.
    prt::SceneChange to(const glm::dmat4& matrix, std::vector<bool> coarse, MoveReport& report);
    /// Takes all of it back. Returns what differs from before the call. Nothing but the destructor
    /// may be called then.
    prt::SceneChange back();

private:
    /// `first` is what the move changes.
    GroupDrag(Scene& scene, SceneRays& rays, const GroupMove& to, prt::SceneChange first);
    void count_without();
    void exchange();

    Scene& scene_;
    SceneRays& rays_;
    std::uint32_t group_;
    /// The group of what blocks light by itself, with its vertices' numbers there
    std::uint32_t group_of_blockers_;
    std::vector<std::uint32_t> vertices_;
    mesh::TriangleMesh mesh_;
    prt::RayScene own_rays_;
    prt::BeamScene own_beams_;
    /// Receivers of the group
    std::vector<bool> receivers_;
    /// What takes back that the group is not counted, and what takes back its last place.
    prt::SceneChange without_;
    std::optional<prt::SceneChange> change_;
};

} // namespace relumine
