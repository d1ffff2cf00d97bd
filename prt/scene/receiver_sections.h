// Receivers and their layout as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include "mesh/triangle_mesh.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

/// Adds what the mesh alone does not tell: nothing for plain vertices; surfaces and directions to
/// the eye where there are any; for pixels and texels also the layout, positions, normals and
/// points. Throws std::invalid_argument for arrays of different lengths or a layout that does not
/// fit them.
void add_receiver_sections(Sections& sections, const Receivers& receivers,
                           const ReceiverLayout& layout);

/// The layout alone, its places checked to be as many as the receivers. Without its sections:
/// vertices. Fails as SectionReader does.
[[nodiscard]] ReceiverLayout read_layout(const SectionReader& reader);

/// The receivers of a layout, all checked: for vertices the mesh's.
[[nodiscard]] Receivers read_receivers(const SectionReader& reader, const ReceiverLayout& layout,
                                       const mesh::TriangleMesh& mesh);

} // namespace relumine::prt
