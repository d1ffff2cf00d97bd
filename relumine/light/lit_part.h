// A scene lit in parts, by processes that know nothing of each other: each reads and lights its own
// receivers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "cubemap/cube_map.h"
#include "prt/team.h"
#include "relight/relighter.h"

namespace relumine {

struct LitPartOptions {
    /// The .prt file
    std::filesystem::path scene = {};
    prt::Part part = {};
    /// The file of the part to write
    std::filesystem::path output = {};
    /// Lights the sun through its cluster too, without shadow rays of its own
    bool clusters_only = false;
    /// Leaves the bounces of the scene out, which parts cannot have. Otherwise it must have none.
    bool is_direct = false;
};

/// Lights a part of a scene's receivers and writes their radiance. The environment may have any
/// resolution. `num_receivers` receives how many the part has.
///
/// Memory:  the mesh, all receivers, and the part's share of the counts: docs/scale.md.
/// Throws:  std::runtime_error "path: expected X, got Y"; std::invalid_argument as
///          LitScene::light().
relight::UpdateReport light_part(const LitPartOptions& options, cubemap::CubeMap environment,
                                 std::size_t* num_receivers = nullptr);

/// Puts the light of all parts together, in any order, and writes it as save() writes an
/// .npy file: the same bytes for any number of parts. Returns the number of receivers.
///
/// Throws:  std::runtime_error that names the part that is missing, given twice, damaged or of
///          other light.
std::size_t join_light(std::span<const std::filesystem::path> parts,
                       const std::filesystem::path& output);

} // namespace relumine
