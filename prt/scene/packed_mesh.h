// A mesh in few bytes, for pages: docs/prt-format.md.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

/// Writes positions to 1/65,535 of the mesh's longest side, unit normals to 4e-6, and triangles as
/// they are. Triangles in the order of their first vertex take a quarter of the bytes.
void add_packed_mesh(NewSections& sections, const mesh::TriangleMesh& mesh);

[[nodiscard]] bool has_packed_mesh(const SectionReader& reader);

/// Reads positions, normals and triangles.
///
/// Throws:  std::runtime_error "path: section ...: expected X" for bytes that are no such mesh.
///          Triangles may still name vertices that are not there.
void read_packed_mesh(const SectionReader& reader, mesh::TriangleMesh& mesh);

} // namespace relumine::prt
