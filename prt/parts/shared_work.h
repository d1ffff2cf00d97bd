// What the processes that share a precompute send each other.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/parts/parts.h"
#include "prt/precompute.h"
#include "prt/receivers/receivers.h"
#include "prt/team.h"

namespace relumine::prt {

/// All that a process must know to do its part.
struct SharedWork {
    /// What light bounces from, with normals; without bounces what blocks light, positions and
    /// triangles alone.
    mesh::TriangleMesh mesh = {};
    /// What blocks light, where that is not the mesh; positions and triangles alone
    std::optional<mesh::TriangleMesh> blockers = {};
    /// Without their points on the mesh, unless light bounces
    Receivers receivers = {};
    /// Numbers alone
    PrecomputeOptions clusters = {};
    /// Numbers alone; only where there are highlights
    std::optional<GlossyOptions> highlights = {};
    /// Numbers alone; only where light bounces
    std::optional<BounceOptions> bounces = {};
    /// Whether beams are traced, or single rays
    bool has_beams = true;
    /// Whether there are checkpoints
    bool has_checkpoint = false;
};

/// Returns bytes for other processes on machines of the same kind. They hold the mesh and the
/// receivers as they lie in memory.
[[nodiscard]] std::vector<std::byte> packed_work(const SharedWork& work);
/// Throws: std::runtime_error for other bytes.
[[nodiscard]] SharedWork unpacked_work(std::span<const std::byte> bytes);

/// Gives the first process the light of all processes, by index, and leaves the others without.
///
/// Memory:  32 MiB, and in the first process the light of all.
/// Throws:  what the team throws where another process has failed; std::invalid_argument for counts
///          that contradict themselves.
[[nodiscard]] std::vector<PartLight> gather_light(Team& team, PartLight&& own);

} // namespace relumine::prt
