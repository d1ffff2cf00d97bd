// Receivers and their layout as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

/// Adds what the mesh alone does not tell. Plain vertices add nothing. Surfaces and directions to
/// the eye are added where there are any. Pixels and texels also add their layout, positions,
/// normals and points.
///
/// Throws:  std::invalid_argument for arrays of different lengths, or a layout that does not fit
///          them.
void add_receiver_sections(NewSections& sections, const Receivers& receivers,
                           const ReceiverLayout& layout);

/// Reads the layout alone; a file without its sections has vertices. Checks that there are as many
/// places as receivers.
///
/// Throws:  as SectionReader.
[[nodiscard]] ReceiverLayout read_layout(const SectionReader& reader);

/// Reads the receivers of a layout and checks all of them. Receivers on vertices are the mesh's.
///
/// Throws:  as SectionReader.
[[nodiscard]] Receivers read_receivers(const SectionReader& reader, const ReceiverLayout& layout,
                                       const mesh::TriangleMesh& mesh);

} // namespace relumine::prt
