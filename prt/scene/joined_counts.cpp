#include "prt/scene/joined_counts.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>

#include "prt/clusters/dealt_tiles.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/section_stream.h"
#include "prt/scene/small_numbers.h"

namespace relumine::prt {

namespace {

/// The tiles of all parts in their order.
class Weave {
public:
    Weave(std::vector<SectionStream> parts, std::vector<std::uint64_t> bytes_per_tile)
        : parts_(std::move(parts)), left_(std::move(bytes_per_tile)) {}

    void next(std::span<std::byte> bytes) {
        while (!bytes.empty()) {
            while (left_[tile_] == 0)
                ++tile_;
            const auto size =
                static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), left_[tile_]));
            parts_[tile_ % parts_.size()].read(bytes.first(size));
            left_[tile_] -= size;
            bytes = bytes.subspan(size);
        }
    }

private:
    std::vector<SectionStream> parts_;
    /// [tiles]
    std::vector<std::uint64_t> left_;
    std::size_t tile_ = 0;
};

} // namespace

JoinedCounts::JoinedCounts(std::size_t num_receivers, std::size_t num_leaves, std::size_t num_parts)
    : shape_{.num_receivers = num_receivers, .num_leaves = num_leaves}, parts_(num_parts),
      pairs_(shape_.num_tiles()) {}

void JoinedCounts::add(const SectionReader& reader, const Part& part, const VisibleCounts& counts) {
    if (counts.num_leaves != shape_.num_leaves ||
        counts.num_receivers != places_of(part, shape_.num_receivers).size())
        throw std::invalid_argument("expected the counts of all tiles");
    const auto pairs_before = [&](std::size_t tile) {
        const std::size_t word = counts.tile_begin(tile) * counts.words_per_block();
        return static_cast<std::size_t>(
            word < counts.mixed_before.size() ? counts.mixed_before[word] : counts.num_mixed());
    };
    for (std::size_t own = 0; own < counts.num_tiles(); ++own) {
        const std::size_t tile = own * part.count + part.index;
        const std::size_t begin = pairs_before(own), end = pairs_before(own + 1);
        pairs_[tile] = end - begin;
        const auto entries =
            std::span(counts.counts).subspan(begin * BlockSize, (end - begin) * BlockSize);
        for (std::size_t i = 0; i < entries.size(); ++i)
            if (entries[i] == RareCount)
                rare_.emplace_back(tile, i);
    }
    parts_[part.index] = {.visible = reader.stored(count_names::Visible),
                          .mixed = reader.stored(count_names::Mixed),
                          .codes = reader.stored(count_names::Codes)};
}

std::vector<std::uint64_t> JoinedCounts::bits_per_tile() const {
    std::vector<std::uint64_t> bytes;
    for (std::size_t tile = 0; tile < pairs_.size(); ++tile)
        bytes.push_back((shape_.tile_begin(tile + 1) - shape_.tile_begin(tile)) *
                        shape_.words_per_block() * sizeof(std::uint64_t));
    return bytes;
}

SectionContent JoinedCounts::woven(StoredSection Stored::* section,
                                   std::vector<std::uint64_t> bytes_per_tile) const {
    const std::uint64_t size =
        std::accumulate(bytes_per_tile.begin(), bytes_per_tile.end(), std::uint64_t{0});
    std::vector<SectionStream> streams;
    for (const Stored& part : parts_)
        streams.emplace_back(part.*section);
    return SectionContent::in_order(
        size, [weave = std::make_shared<Weave>(std::move(streams), std::move(bytes_per_tile))](
                  std::span<std::byte> bytes) { weave->next(bytes); });
}

void JoinedCounts::add_to(NewSections& sections) const {
    sections[count_names::Visible] = woven(&Stored::visible, bits_per_tile());
    sections[count_names::Mixed] = woven(&Stored::mixed, bits_per_tile());
    std::vector<std::uint64_t> code_bytes, entries_before;
    std::uint64_t num_entries = 0;
    for (const std::uint64_t pairs : pairs_) {
        code_bytes.push_back(pairs * BlockSize / 2);
        entries_before.push_back(num_entries);
        num_entries += pairs * BlockSize;
    }
    sections[count_names::Codes] = woven(&Stored::codes, std::move(code_bytes));
    auto rare = rare_;
    std::sort(rare.begin(), rare.end());
    std::vector<std::uint8_t> gaps;
    std::uint64_t next = 0;
    for (const auto& [tile, in_tile] : rare) {
        const std::uint64_t entry = entries_before[tile] + in_tile;
        append_small(gaps, entry - next);
        next = entry + 1;
    }
    sections[count_names::Rare] = bytes_of(gaps);
}

} // namespace relumine::prt
