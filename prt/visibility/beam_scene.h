// Shadows of whole beams of rays: faster than ray by ray, with the same answers bit by bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "mesh/triangle_mesh.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

class RayScene;
class SeeThrough;

/// Answers for a group of receivers and a patch of directions together, with the answers that
/// another tracer gives ray by ray.
///
///            patch of directions
///              \   |   /
///               \  |  /
///         |\     \ | /
///         | \     \|/
///     ----+--o-o-o-o-o----
///          receivers
///
/// The rays of a group of receivers through a patch of directions fill a shaft. Six planes bound
/// it: a triangle outside of one plane blocks none of the rays. One walk of a tree of triangles
/// finds the few triangles that may block a ray. Most shafts meet nothing: 8,192 rays are decided
/// at once. A leaf of the tree in the shaft is tested for all receivers whose own cones it reaches
/// into: the rays that touch its box, then its triangles, 16 at a time.
///
/// Why nothing changes: rounding errors have bounds, and a test here only decides where its result
/// is beyond its bound. A ray hits a triangle for certain, misses all of them for certain, or is in
/// doubt, because it passes an edge within some 1e-6 of its length. `exact` is asked for rays in
/// doubt and where directions meet too many triangles. Triangles that let some rays pass have a
/// tree of their own: a ray that hits one of them for certain passes it or not as it does there.
///
/// A shaft of a fixed angle holds more triangles on a finer mesh, while a group of receivers
/// shrinks there. So a crowded patch is traced direction by direction, all receivers of the group
/// together (parallel_rays.h). The cost hardly depends on the number of triangles then, except for
/// the depth of the tree.
class BeamScene final : public Blockers {
public:
    /// Leaves of up to 16 triangles in a shaft; with more, directions are traced one by one. With
    /// fewer leaves, too, where a direction meets few. Measured (docs/performance.md).
    static constexpr std::size_t CrowdedShaft = 4096;

    /// `exact` traces the triangles of the same mesh and must outlive this object; the mesh need
    /// not. `crowded_shaft`, at most the default, changes no answer.
    ///
    /// Memory:  about 250 bytes per triangle.
    BeamScene(const mesh::TriangleMesh& mesh, const RayScene& exact,
              std::size_t crowded_shaft = CrowdedShaft);
    /// Takes any tracer of the mesh, of which `see_through` says what its rays pass.
    BeamScene(const mesh::TriangleMesh& mesh, const Blockers& exact,
              std::shared_ptr<const SeeThrough> see_through,
              std::size_t crowded_shaft = CrowdedShaft);
    ~BeamScene() override;
    BeamScene(BeamScene&&) noexcept;
    BeamScene& operator=(BeamScene&&) noexcept;

    /// Takes a group of the mesh as it stands there, after `exact` did. Only where its groups move.
    ///
    /// Cost:    O(the group's triangles), and a copy of all trees.
    void follow(const mesh::TriangleMesh& mesh, std::uint32_t group);

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override;
    void clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                       std::span<std::uint64_t> rays) const override;
    [[nodiscard]] const Blockers* settled() const override { return settled_.get(); }
    [[nodiscard]] const RayScene* ray_scene() const override { return exact_->ray_scene(); }

private:
    struct Trees;
    BeamScene(std::unique_ptr<Trees> trees, const Blockers& exact, std::size_t crowded_shaft);

    std::unique_ptr<Trees> trees_;
    const Blockers* exact_;
    std::size_t crowded_shaft_;
    std::unique_ptr<BeamScene> settled_;
};

} // namespace relumine::prt
