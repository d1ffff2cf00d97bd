// The bounces of a scene as sections of a .prt file; docs/prt-format.md describes them.
#pragma once

#include <cstddef>
#include <optional>

#include "prt/bounces/bounce_matrix.h"
#include "prt/bounces/bounce_samples.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

void add_bounce_sections(NewSections& sections, const BounceMatrix& matrix);

[[nodiscard]] bool has_bounces(const SectionReader& reader);

/// Reads the bounces; check_scene() looks at what they say. Empty where the file has none.
///
/// Throws:  as SectionReader.
[[nodiscard]] std::optional<BounceMatrix> read_bounces(const SectionReader& reader,
                                                       const Receivers& receivers);

/// Checks that light comes from vertices.
void check_emitters(const SceneCheck& check, const Scene& scene, const BounceMatrix& matrix);

/// The rows of one of several processes that relight a scene.
struct BounceRows {
    /// Whole but for the emitters: those of rows of other processes (has_row()) are left out.
    BounceMatrix matrix;
    /// first_emitter() of all rows
    std::size_t first = 0;
    /// [num_receivers] emitters of all rows
    std::vector<std::uint32_t> num_emitters = {};
};

/// Reads the rows of a process from a scene file. The emitters are unpacked piece by piece.
///
/// Throws:  as SectionReader, also where check_scene() would.
[[nodiscard]] BounceRows read_bounce_rows(const SectionReader& reader, const Receivers& receivers,
                                          const Part& part);

/// Adds the samples of a part of a plan.
void add_bounce_samples(NewSections& sections, const BounceSamples& samples);

/// Reads the samples of a part that has `num_own` of all receivers, `num_own_points` of them points
/// in space. Empty where the file has none.
///
/// Throws:  as SectionReader.
[[nodiscard]] std::optional<BounceSamples> read_bounce_samples(const SectionReader& reader,
                                                               std::size_t num_own,
                                                               std::size_t num_own_points,
                                                               std::size_t num_receivers);

} // namespace relumine::prt
