// Plans and parts of a precompute on disk. docs/scale.md shows how they are used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "prt/bounces/bounce_samples.h"
#include "prt/parts/parts.h"
#include "prt/scene/scene_file.h"

namespace relumine::prt {

/// What parts must know of the bounces.
struct PlannedBounces {
    /// BounceOptions::tolerance
    float tolerance = 0.0f;
    /// Of the sample: sampled_receivers() says which of them stands for a receiver.
    std::vector<ProbeRadiance> probes = {};
};

/// A scene whose clusters are chosen and whose counts are missing.
struct Plan {
    /// Without counts, highlights and bounces.
    Scene scene;
    /// Only where light bounces
    std::optional<PlannedBounces> bounces = {};
    /// Tells plans apart: xxHash64 of the file's bytes.
    std::uint64_t hash = 0;
};

/// Writes a plan, whole or not at all. Returns the file's size in bytes.
///
/// Throws:  as save_scene() does; std::invalid_argument for a scene that has light already.
std::uint64_t save_plan(const std::filesystem::path& path, const Scene& scene,
                        const std::optional<PlannedBounces>& bounces = {});

/// Reads a plan and checks it as load_scene() checks a scene.
///
/// Throws:  std::runtime_error "path: expected X, got Y"; also for a plan of a processor that
///          computes in another way (prt/arithmetic.h).
[[nodiscard]] Plan load_plan(const std::filesystem::path& path);

/// Writes the light of a part, whole or not at all. The first part carries the plan as well, so
/// that the parts are all that join_parts() needs. Returns the file's size in bytes.
///
/// Throws:  std::runtime_error that names the path.
std::uint64_t save_part(const std::filesystem::path& path, const Plan& plan, const Part& part,
                        const PartLight& light);

/// Reads all parts of a plan, in any order, and returns the scene.
///
/// Memory:  twice the light of the scene, and twice its bounces.
/// Throws:  std::runtime_error that names the file that is damaged, no part, of another plan or of
///          another number of parts, given twice or missing.
[[nodiscard]] Scene join_parts(std::span<const std::filesystem::path> paths);

} // namespace relumine::prt
