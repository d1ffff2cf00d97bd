// A mesh drawn for people, with what the mesh doctor found.
#pragma once

#include <filesystem>

#include "mesh/half_edge/diagnosis.h"
#include "mesh/triangle_mesh.h"

namespace relumine::relight {

/// Writes a PNG of 1024 x 768 of the mesh in grey, lit from the eye.
///
/// Colours: triangles that must turn are orange; those without normals that face them, violet.
///          Edges: boundary blue, of three triangles or more magenta, sides
///          that triangles repeat red. Vertices of several fans are yellow points.
///
/// Throws:  std::runtime_error that names the path, also for a mesh that no camera can show.
void save_mesh_picture(const std::filesystem::path& path, const mesh::TriangleMesh& mesh,
                       const mesh::Diagnosis& diagnosis);

} // namespace relumine::relight
