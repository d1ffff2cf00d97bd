// The glossy part of a transfer as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include "prt/glossy/glossy_transfer.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

void add_glossy_sections(Sections& sections, const GlossyTransfer& glossy);

/// Whether the file has glossy sections.
[[nodiscard]] bool has_glossy(const SectionReader& reader);

/// Reads the glossy part and checks all of it: shapes, cells that exist, in order and apart, finite
/// scales.
///
/// Throws:  as SectionReader.
[[nodiscard]] GlossyTransfer read_glossy(const SectionReader& reader, std::size_t num_blocks);

} // namespace relumine::prt
