// The bounces of a scene as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include <cstddef>
#include <optional>

#include "prt/bounces/bounce_matrix.h"
#include "prt/bounces/bounce_samples.h"
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

/// Adds the samples of a part of a plan.
void add_bounce_samples(Sections& sections, const BounceSamples& samples);

/// Reads the samples of a part with `num_own` of the receivers. Empty where the file has none.
///
/// Throws:  as SectionReader.
[[nodiscard]] std::optional<BounceSamples>
read_bounce_samples(const SectionReader& reader, std::size_t num_own, std::size_t num_receivers);

} // namespace relumine::prt
