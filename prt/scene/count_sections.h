// Visible counts as the sections of a .prt file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// Counts are codes of four bits, two in a byte. Counts are 0 to 16, and hardly ever 14: so the
/// code 14 stands for 16, and a list names the entries that are 14 after all. Beside bytes, the
/// file of the Stanford bunny is 7 % smaller for it.
namespace count_names {
inline const std::string Visible = "visible", Mixed = "mixed", Codes = "count_codes",
                         Rare = "counts_14";
} // namespace count_names
inline constexpr std::uint8_t RareCount = 14;

/// Adds the sections of counts, which must last until they are written.
void add_counts(NewSections& sections, const VisibleCounts& counts);

/// Reads and checks the counts of `counts.num_receivers` and `counts.num_leaves`.
///
/// Throws:  std::runtime_error.
void read_counts(const SectionReader& reader, VisibleCounts& counts);

/// Reads and checks the counts of `num_own` receivers in `tiles`, which ascend. No other counts
/// stay in memory.
///
/// whole:   num_receivers and num_leaves of the scene.
/// Throws:  std::runtime_error.
[[nodiscard]] VisibleCounts read_counts_of_tiles(const SectionReader& reader,
                                                 const VisibleCounts& whole,
                                                 std::span<const std::size_t> tiles,
                                                 std::size_t num_own);

} // namespace relumine::prt
