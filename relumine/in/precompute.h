// From a mesh to a scene that any environment lights: all of the precompute in one call.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "prt/precompute_options.h"
#include "prt/team.h"
#include "relumine/in/mesh.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"

namespace relumine {

/// Computes which light reaches which receiver [JN, Section 4], highlights included, and writes the
/// scene where an output is given.
///
/// Report:  where given, filled as far as the work got, also when an exception ends it.
/// Throws:  std::invalid_argument for options out of range;
///          TooMuchWork unless max_memory is given; std::runtime_error "SOURCE: ..." for a
///          view that sees nothing, a mesh without uvs for texels, a checkpoint of other work, a
///          file that cannot be written; MemoryLimitExceeded; Cancelled.
/// Cost:    O(receivers times directions) rays: docs/measurements.md has examples.
/// Memory:  the result twice, and half a gigabyte; less with max_memory.
/// Threads: parallel inside; the result is the same bit by bit for any number of threads.
[[nodiscard]] Scene precompute(Mesh mesh, const PrecomputeOptions& options = {},
                               const PrecomputeWork& work = {}, PrecomputeReport* report = nullptr);

/// Helps the first of the processes that share a precompute, whose mesh and options it gets:
/// computes its part and hands it over.
///
/// Memory:  the mesh, all receivers, and twice its share of the result.
/// Throws:  Cancelled when any of the processes was asked to stop; as precompute() does for what
///          goes wrong here; what the team throws where another process has failed.
void assist(const PrecomputeWork& work);

/// Plans a precompute that is done in parts, by any number of processes on any number of machines:
/// chooses the clusters from a sample of the receivers and writes the plan, a file that ends in
/// .plan, to options.output. There are no checkpoints.
///
/// Cost:    a sixteenth of a precompute where receivers are many; see prt::plan_clusters().
/// Throws:  as precompute() does.
void plan(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work = {},
          PrecomputeReport* report = nullptr);

/// One part of a plan.
struct PartOptions {
    /// A file that plan() wrote
    std::filesystem::path plan = {};
    prt::Part part = {};
    /// The file of the part to write
    std::filesystem::path output = {};
};

/// Does one part of a plan and writes its file. Parts know nothing of each other: they run in any
/// order, anywhere, and again if one is lost.
///
/// Memory:  the mesh and all receivers, and the part's share of the counts twice.
/// Throws:  std::runtime_error "path: expected X, got Y"; std::invalid_argument for a part that is
///          none; Cancelled.
void precompute_part(const PartOptions& options, const PrecomputeWork& work = {},
                     prt::PrecomputeStatistics* statistics = nullptr);

/// Puts all parts of a plan together, in any order, and writes the scene. The file is the same byte
/// by byte for any number of parts. Returns its size in bytes.
///
/// Throws:  std::runtime_error that names the part that is missing, given twice, damaged or of
///          another plan.
std::uint64_t join(std::span<const std::filesystem::path> parts,
                   const std::filesystem::path& output);

/// One surface for the whole mesh: PrecomputeOptions{.surface = everywhere({.albedo = ...})}.
[[nodiscard]] prt::SurfaceOverride everywhere(const prt::Surface& surface);

} // namespace relumine
