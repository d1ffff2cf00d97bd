// Materials and textures as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

/// Adds what gives a textured mesh its colours between the vertices: materials, the image files as
/// they were, materials of triangles, uvs of corners. A mesh without textures adds nothing.
void add_material_sections(NewSections& sections, const mesh::TriangleMesh& mesh);

/// Reads them into a mesh that has its triangles. Without the sections the mesh stays as it is.
///
/// Throws:  as SectionReader.
void read_material_sections(const SectionReader& reader, mesh::TriangleMesh& mesh);

} // namespace relumine::prt
