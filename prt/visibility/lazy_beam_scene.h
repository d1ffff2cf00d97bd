// Beams for those who trace often: the triangles are prepared once enough rays have been asked for.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "mesh/triangle_mesh.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

/// Asks `exact` until the rays that prepare() announced would have paid for a BeamScene, then a
/// BeamScene. The answers are the same bit by bit: one picture costs what it did, and a light that
/// moves takes half the time.
///
/// Threads: as Blockers.
class LazyBeamScene final : public Blockers {
public:
    /// Both must outlive this object; `exact` traces the triangles of the mesh.
    LazyBeamScene(const mesh::TriangleMesh& mesh, const RayScene& exact);
    ~LazyBeamScene() override;

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override;
    void clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                       std::span<std::uint64_t> rays) const override;
    /// Memory:  about 250 bytes per triangle from some call on; none beyond three gigabytes.
    void prepare(std::uint64_t num_rays) const override;

    [[nodiscard]] bool has_beams() const { return ready_ != nullptr; }
    /// Returns the beams, prepared now if they were not.
    [[nodiscard]] const BeamScene& beams() const;
    /// Takes a group of the mesh as it stands there, after `exact` did (BeamScene::follow()).
    void follow(std::uint32_t group);

private:
    void prepare_beams() const;

    const mesh::TriangleMesh& mesh_;
    const RayScene& exact_;
    mutable std::mutex mutex_;
    mutable std::uint64_t num_rays_ = 0;
    mutable std::unique_ptr<BeamScene> beams_;
    /// beams_, once it is whole.
    mutable std::atomic<const BeamScene*> ready_ = nullptr;
};

} // namespace relumine::prt
