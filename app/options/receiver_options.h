// What a scene computes the transfer of, in words: vertices, pixels of a view, texels of a
// lightmap.
#pragma once

#include <string>

#include "app/session.h"
#include "relumine/in/precompute.h"

namespace relumine::app {

/// The layout for people and for --json: size, camera, coverage. Empty for vertices.
[[nodiscard]] Report layout_json(const prt::Scene& scene);

/// The part of the places of a layout that have a receiver. Not for vertices.
[[nodiscard]] double coverage_of(const prt::Scene& scene);

/// How a mesh's uvs fit the lightmap, for --json.
[[nodiscard]] Report atlas_json(const prt::AtlasReport& atlas, const prt::TexelLayout& texels);

/// Throws std::runtime_error "path: expected a scene whose receivers are vertices, got ..." for
/// other layouts.
void require_vertices(const prt::Scene& scene, const std::string& path);

} // namespace relumine::app
