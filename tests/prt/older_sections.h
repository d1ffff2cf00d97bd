// Sections of a .prt file as older versions have them.
#pragma once

#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::scenes {

/// Stores counts as versions up to 4 do: a byte for each.
inline void use_bytes_for_counts(prt::Sections& sections, const prt::VisibleCounts& counts) {
    sections.erase("count_codes");
    sections.erase("counts_14");
    sections["counts"] = prt::bytes_of(counts.counts);
}

} // namespace relumine::scenes
