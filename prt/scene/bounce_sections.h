// The bounces of a scene as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include <cstddef>
#include <optional>

#include "prt/bounces/bounce_matrix.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

void add_bounce_sections(Sections& sections, const BounceMatrix& matrix);

[[nodiscard]] bool has_bounces(const SectionReader& reader);

/// Reads the bounces; check_scene() looks at what they say. Empty where the file has none.
///
/// Throws:  as SectionReader.
[[nodiscard]] std::optional<BounceMatrix> read_bounces(const SectionReader& reader,
                                                       std::size_t num_receivers);

} // namespace relumine::prt
