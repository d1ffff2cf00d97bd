// Scenes that were precomputed before, kept in a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "relumine/in/mesh.h"
#include "relumine/in/precompute.h"

namespace relumine {

struct SceneCache {
    std::filesystem::path folder;
    /// The scenes that were used last stay within this.
    std::uint64_t max_bytes = std::uint64_t{4} << 30;
};

/// The user's folder: $RELUMINE_CACHE, or relumine in $XDG_CACHE_HOME or in ~/.cache. None where
/// none of them is set, or RELUMINE_CACHE is empty.
[[nodiscard]] std::optional<SceneCache> user_cache();

/// Returns the file of the scene that precompute() makes of a mesh with these options. Its name
/// follows from all of the mesh, textures included, from the options but output and checkpoints,
/// and from the version of the program.
///
/// Throws:  std::invalid_argument for surfaces in the options: they are functions.
[[nodiscard]] std::filesystem::path cached_file(const SceneCache& cache, const Mesh& mesh,
                                                const PrecomputeOptions& options = {});

/// Loads the scene from the cache, or precomputes it and keeps it there. A file that cannot be read
/// is made anew. Where the folder cannot be written, a warning says so, and the scene is not kept.
/// Processes may use one cache at the same time.
///
/// before:  looks at the mesh where the scene is not there, before the precompute. May be empty.
/// Report:  num_vertices is 0 where the scene was there.
/// Throws:  as precompute() and cached_file().
[[nodiscard]] Scene cached_precompute(const SceneCache& cache, Mesh mesh,
                                      const PrecomputeOptions& options = {},
                                      const PrecomputeWork& work = {},
                                      PrecomputeReport* report = nullptr,
                                      const std::function<void(const Mesh&)>& before = {});

} // namespace relumine
