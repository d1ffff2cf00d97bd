// Meshes of programs with another axis up.
#pragma once

#include <cstdint>

#include "mesh/camera.h"
#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// The axis of a file that points up.
enum class UpAxis : std::uint8_t { X, Y, Z };

/// Turns a mesh so that the axis becomes +Y: Z up turns about X, and what was -Y faces +Z then; X
/// up turns about Z. Y changes nothing.
void turn_up(TriangleMesh& mesh, UpAxis axis);
void turn_up(Camera& camera, UpAxis axis);

} // namespace relumine::mesh
