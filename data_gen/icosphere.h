// Evenly triangulated sphere.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// The unit sphere as an icosahedron with every edge cut into `frequency` >= 1 parts: 10 f^2 + 2
/// shared vertices, 20 f^2 triangles, normals not set. Edge lengths differ by a factor of at
/// most 1.6.
[[nodiscard]] mesh::TriangleMesh icosphere(std::uint32_t frequency);

/// The frequency whose vertex count comes closest to a wish, at least 1.
[[nodiscard]] std::uint32_t icosphere_frequency(std::size_t num_vertices);

} // namespace relumine::data_gen
