// Plans and parts of a precompute, as files and as what processes send each other. docs/scale.md
// shows how they are used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "prt/bounces/bounce_samples.h"
#include "prt/parts/parts.h"
#include "prt/scene/scene_file.h"
#include "prt/team.h"

namespace relumine::prt {

/// What parts must know of the bounces.
struct PlannedBounces {
    /// BounceOptions::tolerance
    float tolerance = 0.0f;
    /// Nobody asked for them: they are left out where there is too little memory.
    bool is_automatic = false;
    /// Radiance of the sample under the probe lights: sampled_receivers() says which of them stands
    /// for a receiver. Empty where processes choose the clusters together.
    std::vector<ProbeRadiance> probes = {};
};

/// All that a process must know to do its part of a precompute.
struct Plan {
    /// Without counts, highlights and bounces. Settings say what is asked for.
    Scene scene = {};
    /// Only where light bounces
    std::optional<PlannedBounces> bounces = {};
    /// The clusters are chosen. Otherwise the processes choose them together, and the quadtree says
    /// nothing.
    bool has_clusters = false;
    /// Tells the files of plans apart: xxHash64 of the bytes.
    std::uint64_t hash = 0;
};

/// Writes a plan whose clusters are chosen, whole or not at all. Returns the file's size in bytes.
///
/// Throws:  as save_scene() does; std::invalid_argument for a scene that has light already.
std::uint64_t save_plan(const std::filesystem::path& path, const Plan& plan);

/// Reads a plan and checks it as load_scene() checks a scene.
///
/// Throws:  std::runtime_error "path: expected X, got Y"; also for a plan of a processor that
///          computes in another way (prt/arithmetic.h).
[[nodiscard]] Plan load_plan(const std::filesystem::path& path);

/// Gives the first process's plan to the others. They get no colours of the mesh.
///
/// Throws:  what the team throws where another process has failed.
void share_plan(Team& team, Plan& plan);

/// Writes the light of a part, whole or not at all. The first part carries the plan as well, so
/// that the parts are all that join_parts() needs. Returns the file's size in bytes.
///
/// Throws:  std::runtime_error that names the path.
std::uint64_t save_part(const std::filesystem::path& path, const Plan& plan, const Part& part,
                        const PartLight& light);

/// Reads all parts of a plan, in any order, and writes the scene, whole or not at all. Returns the
/// file's size in bytes.
///
/// Memory:  the mesh and the receivers, the largest part by itself, 32 MiB and some 2 MiB for each
///          part; highlights and bounces twice.
/// Throws:  std::runtime_error that names the file that is damaged, no part, of another plan or of
///          another number of parts, given twice or missing; as save_scene() does.
std::uint64_t join_parts(std::span<const std::filesystem::path> paths,
                         const std::filesystem::path& output);

/// Gives the first process the light of all processes, by index, and leaves the others without.
/// `scene` has the quadtree.
///
/// Memory:  the light as a file has it, of all processes in the first one.
/// Throws:  what the team throws where another process has failed.
[[nodiscard]] std::vector<PartLight> gather_light(Team& team, const Scene& scene, PartLight&& own);

} // namespace relumine::prt
