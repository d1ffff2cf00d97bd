#include "prt/scene/count_sections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "files/large_vector.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "prt/scene/section_group.h"
#include "prt/scene/section_picker.h"
#include "prt/scene/small_numbers.h"

namespace relumine::prt {

namespace {

using count_names::Visible, count_names::Mixed, count_names::Codes, count_names::Rare;

/// Entries [begin, end) of a scene's counts, even numbers.
using EntryRange = SectionPicker::Range;

std::uint8_t code_of(std::uint8_t count) {
    return count == FullCount ? RareCount : count;
}

/// Returns the two counts of each byte of codes, as they lie in memory.
constexpr std::array<std::uint16_t, 256> counts_by_code() {
    const auto count = [](std::uint32_t code) -> std::uint32_t {
        return code == RareCount ? FullCount : code;
    };
    std::array<std::uint16_t, 256> table{};
    for (std::uint32_t codes = 0; codes < table.size(); ++codes)
        table[codes] = static_cast<std::uint16_t>(count(codes & 15u) | count(codes >> 4u) << 8u);
    return table;
}

SectionContent codes_of(const std::vector<std::uint8_t>& counts) {
    return {counts.size() / 2, [&counts](std::uint64_t begin, std::span<std::byte> piece) {
                const std::uint8_t* two = counts.data() + 2 * static_cast<std::size_t>(begin);
                for (std::byte& codes : piece) {
                    codes = static_cast<std::byte>(code_of(two[0]) | code_of(two[1]) << 4u);
                    two += 2;
                }
            }};
}

/// Returns where counts are 14: the number of entries between each and the one before.
std::vector<std::byte> rare_entries(const std::vector<std::uint8_t>& counts) {
    std::vector<std::uint8_t> bytes;
    auto before = counts.begin();
    for (auto at = before; (at = std::find(at, counts.end(), RareCount)) != counts.end();) {
        append_small(bytes, static_cast<std::uint64_t>(at - before));
        before = ++at;
    }
    return bytes_of(bytes);
}

constexpr std::size_t CountsPerCode = 2;

/// Writes two counts for each byte of codes.
void expand(std::span<const std::byte> codes, std::uint8_t* counts) {
    static constexpr std::array<std::uint16_t, 256> Table = counts_by_code();
    for (const std::byte code : codes) {
        std::memcpy(counts, &Table[std::to_integer<std::size_t>(code)], CountsPerCode);
        counts += CountsPerCode;
    }
}

/// Sets the counts of 14 among some of the scene's entries, which have another code's count.
///
/// entries:      ascending; `counts` has one range after the other.
/// num_entries:  all entries of the scene.
void set_rare_counts(const SectionReader& reader, std::span<const EntryRange> entries,
                     std::uint64_t num_entries, std::span<std::uint8_t> counts) {
    SmallNumbers gaps(reader, Rare, "entries of counts");
    std::uint64_t entry = 0;
    std::uint64_t before = 0; // own entries in the ranges before
    for (auto range = entries.begin(); !gaps.at_end(); ++entry) {
        const std::uint64_t gap = gaps.next();
        if (gap >= num_entries - entry)
            reader.fail(Rare, "entries of counts");
        entry += gap;
        for (; range != entries.end() && range->end <= entry; ++range)
            before += range->end - range->begin;
        if (range == entries.end() || entry < range->begin)
            continue;
        std::uint8_t& count = counts[static_cast<std::size_t>(before + entry - range->begin)];
        if (count != FullCount)
            reader.fail(Rare, "entries with the code of 14");
        count = RareCount;
    }
}

} // namespace

void add_counts(NewSections& sections, const VisibleCounts& counts) {
    sections[Visible] = SectionContent::view(counts.visible);
    sections[Mixed] = SectionContent::view(counts.mixed);
    sections[Codes] = codes_of(counts.counts);
    sections[Rare] = rare_entries(counts.counts);
}

void read_counts(const SectionReader& reader, VisibleCounts& counts) {
    counts.visible = reader.elements<std::uint64_t>(Visible);
    counts.mixed = reader.elements<std::uint64_t>(Mixed);
    const EntryRange all{0, CountsPerCode * reader.size(Codes, CountsPerCode)};
    counts.counts = files::large_vector<std::uint8_t>(all.end);
    reader.unpack_pieces(Codes, CountsPerCode,
                         [&](std::uint64_t begin, std::span<const std::byte> codes) {
                             expand(codes, counts.counts.data() + CountsPerCode * begin);
                         });
    set_rare_counts(reader, {&all, 1}, all.end, counts.counts);
    try {
        counts.index();
    } catch (const std::invalid_argument&) {
        reader.fail(Codes, "counts that fit the receivers and the tree");
    }
}

VisibleCounts read_counts_of_tiles(const SectionReader& reader, const VisibleCounts& whole,
                                   std::span<const std::size_t> tiles, std::size_t num_own) {
    constexpr std::uint64_t WordBytes = sizeof(std::uint64_t);
    const auto words_before = [&](std::size_t tile) {
        return std::uint64_t{whole.tile_begin(tile)} * whole.words_per_block();
    };
    const std::size_t num_tiles = whole.num_tiles();
    std::vector<SectionPicker::Range> words;
    for (const std::size_t tile : tiles)
        words.push_back({words_before(tile) * WordBytes, words_before(tile + 1) * WordBytes});
    const std::uint64_t num_bytes = words_before(num_tiles) * WordBytes;

    VisibleCounts counts{.num_receivers = num_own, .num_leaves = whole.num_leaves};
    SectionPicker visible(words);
    reader.stream(Visible, num_bytes, [&](auto piece) { visible.take(piece); });
    counts.visible = visible.elements<std::uint64_t>();

    // Where the counts of a tile begin follows from the mixed pairs of all tiles before.
    SectionPicker mixed(words);
    std::vector<std::uint64_t> pairs(num_tiles + 1);
    std::uint64_t word = 0;
    std::size_t tile = 0;
    reader.stream(Mixed, num_bytes, [&](std::span<const std::byte> piece) {
        mixed.take(piece);
        for (std::size_t at = 0; at < piece.size(); at += WordBytes, ++word) {
            while (word == words_before(tile + 1))
                ++tile;
            std::uint64_t bits = 0;
            std::memcpy(&bits, piece.data() + at, WordBytes);
            pairs[tile + 1] += static_cast<std::uint64_t>(std::popcount(bits));
        }
    });
    counts.mixed = mixed.elements<std::uint64_t>();
    for (std::size_t i = 0; i < num_tiles; ++i)
        pairs[i + 1] += pairs[i];

    std::vector<EntryRange> entries;
    std::vector<SectionPicker::Range> bytes;
    for (const std::size_t own : tiles) {
        entries.push_back({pairs[own] * BlockSize, pairs[own + 1] * BlockSize});
        bytes.push_back({entries.back().begin / 2, entries.back().end / 2});
    }
    const std::uint64_t num_entries = pairs[num_tiles] * BlockSize;
    SectionPicker codes(bytes);
    reader.stream(Codes, num_entries / 2, [&](auto piece) { codes.take(piece); });
    const std::vector<std::byte> own_codes = codes.elements<std::byte>();
    counts.counts = files::large_vector<std::uint8_t>(CountsPerCode * own_codes.size());
    files::parallel_for(files::IndexRange<std::size_t>(0, own_codes.size(), SectionPiece),
                        [&](const files::IndexRange<std::size_t>& piece) {
                            expand(std::span(own_codes).subspan(piece.begin(), piece.size()),
                                   counts.counts.data() + CountsPerCode * piece.begin());
                        });
    set_rare_counts(reader, entries, num_entries, counts.counts);
    try {
        counts.index();
    } catch (const std::invalid_argument&) {
        throw std::runtime_error(
            fmt::format("{}: expected counts that fit the receivers and the tree, got others",
                        reader.path().string()));
    }
    return counts;
}

const SectionGroup CountSections = {
    .add = [](NewSections& sections,
              const Scene& scene) { add_counts(sections, scene.transfer.counts); },
    .read =
        [](const SectionReader& reader, Scene& scene) {
            VisibleCounts& counts = scene.transfer.counts;
            counts.num_receivers = scene.receivers.size();
            counts.num_leaves = scene.transfer.quadtree.num_leaves();
            read_counts(reader, counts);
        },
    .is_light = true};

} // namespace relumine::prt
