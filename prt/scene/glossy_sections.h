// The glossy part of a transfer as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include <cstddef>
#include <span>

#include "prt/scene/section_group.h"
#include "prt/transfer/glossy_transfer.h"

namespace relumine::prt {

void add_glossy_sections(NewSections& sections, const GlossyTransfer& glossy);

/// Whether the file has glossy sections.
[[nodiscard]] bool has_glossy(const SectionReader& reader);

/// Reads the glossy part and checks all of it: shapes, cells that exist, in order and apart, finite
/// scales.
///
/// Throws:  as SectionReader.
[[nodiscard]] GlossyTransfer read_glossy(const SectionReader& reader, std::size_t num_blocks);

/// Where blocks of 16 receivers begin and end.
struct BlockRange {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// Reads the highlights of some blocks, one range behind the other, and checks them. Long sections
/// are unpacked piece by piece.
///
/// Memory:  the blocks' own highlights, and for a while 4 bytes a cell of all blocks.
/// Throws:  as SectionReader.
[[nodiscard]] GlossyTransfer read_glossy_part(const SectionReader& reader, std::size_t num_blocks,
                                              std::span<const BlockRange> blocks);

/// Checks that highlights can be lit.
void check_highlights(const SceneCheck& check, const GlossyTransfer& glossy);

} // namespace relumine::prt
