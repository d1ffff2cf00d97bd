// The counts of parts as the sections of one scene, without ever having all of them in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "prt/scene/packed_sections.h"
#include "prt/scene/section_file.h"
#include "prt/scene/section_reader.h"
#include "prt/team.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// Takes the counts of each part once, and reads them again from the parts' files, tile by tile,
/// when the scene is written.
///
/// Memory:  8 bytes a tile, and for each part what zstd needs for a frame of a section.
class JoinedCounts {
public:
    JoinedCounts(std::size_t num_receivers, std::size_t num_leaves, std::size_t num_parts);

    /// Takes a part, in any order. `counts`: what `reader`, which is of a file, has of them.
    ///
    /// Throws:  std::invalid_argument for the counts of other receivers or clusters.
    void add(const SectionReader& reader, const Part& part, const VisibleCounts& counts);

    /// Adds the sections of all counts, once all parts were added.
    void add_to(NewSections& sections) const;

private:
    struct Stored {
        StoredSection visible, mixed, codes;
    };

    [[nodiscard]] std::vector<std::uint64_t> bits_per_tile() const;
    [[nodiscard]] SectionContent woven(StoredSection Stored::* section,
                                       std::vector<std::uint64_t> bytes_per_tile) const;

    /// Without counts
    VisibleCounts shape_;
    /// [parts]
    std::vector<Stored> parts_;
    /// [tiles] mixed pairs of block and cluster
    std::vector<std::uint64_t> pairs_;
    /// Counts of 14: the tile, and the entry in it
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rare_;
};

} // namespace relumine::prt
