// An evenly triangulated sphere.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// Returns the unit sphere as an icosahedron whose edges are cut into `frequency` f >= 1 parts. It
/// has 10 f^2 + 2 shared vertices and 20 f^2 triangles, and no normals. Edge lengths differ by a
/// factor of at most 1.6.
[[nodiscard]] mesh::TriangleMesh icosphere(std::uint32_t frequency);

/// Returns the frequency, at least 1, whose vertex count is closest to `num_vertices`.
[[nodiscard]] std::uint32_t icosphere_frequency(std::size_t num_vertices);

} // namespace relumine::data_gen
