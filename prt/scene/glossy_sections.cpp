#include "prt/scene/glossy_sections.h"

#include <algorithm>
#include <bit>
#include <span>
#include <string>

#include "prt/scene/section_picker.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

// By GlossyLobe.
constexpr std::array<const char*, NumGlossyLobes> Names = {"g_specular", "g_spec_grazing",
                                                           "g_diff_grazing", "g_coat", "g_sheen"};

/// Lobes that only files with such receivers have.
bool is_optional(std::size_t lobe) {
    return lobe > static_cast<std::size_t>(GlossyLobe::DiffuseGrazing);
}

std::string name_of(std::size_t lobe, char part) {
    return fmt::format("{}_{}", Names[lobe], part);
}

/// Bytes of a section that holds the first bytes of all numbers, then all second bytes, and so on:
/// similar numbers then compress four times better. `number(i)` is a number of 32 bits, one of
/// `size`.
template<typename NumberOf>
SectionContent byte_planes(std::size_t size, const NumberOf& number) {
    return {size * sizeof(std::uint32_t), [=](std::uint64_t begin, std::span<std::byte> piece) {
                auto plane = static_cast<std::uint32_t>(begin / size);
                auto i = static_cast<std::size_t>(begin % size);
                for (std::byte& byte : piece) {
                    byte = static_cast<std::byte>(number(i) >> (8 * plane));
                    if (++i == size) {
                        i = 0;
                        ++plane;
                    }
                }
            }};
}

/// Undoes byte_planes().
template<typename Number>
std::vector<Number> numbers_of(const std::vector<std::byte>& planes) {
    std::vector<Number> numbers(planes.size() / sizeof(Number));
    std::vector<std::byte> bytes(planes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = planes[i % sizeof(Number) * numbers.size() + i / sizeof(Number)];
    if (!bytes.empty())
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

template<typename Number>
std::vector<Number> from_byte_planes(const SectionReader& reader, const std::string& name) {
    const std::vector<std::byte> planes = reader.bytes(name);
    if (planes.size() % sizeof(Number) != 0)
        reader.fail(name, fmt::format("a multiple of {} bytes", sizeof(Number)));
    return numbers_of<Number>(planes);
}

std::vector<std::uint32_t> sums(std::vector<std::uint32_t> cells) {
    for (std::size_t i = 1; i < cells.size(); ++i)
        cells[i] += cells[i - 1];
    return cells;
}

/// Whether the cells of one block have known levels, ascend along the Z curve, and do not overlap.
bool is_a_cut(std::span<const std::uint32_t> cells) {
    std::uint64_t end = 0;
    for (const std::uint32_t cell : cells) {
        if (cell >= num_cells_above(MaxGlossyLevel + 1))
            return false;
        const std::uint32_t level = level_of_index(cell);
        const std::uint32_t shift = 2u * (MaxGlossyLevel - level);
        const std::uint64_t first = std::uint64_t{cell - num_cells_above(level)} << shift;
        if (first < end)
            return false;
        end = first + (std::uint64_t{1} << shift);
    }
    return true;
}

/// Returns the first entry of each block.
std::vector<std::uint64_t> read_begin(const SectionReader& reader, std::size_t lobe,
                                      std::size_t num_blocks) {
    const std::string name = name_of(lobe, 'b');
    auto begin = reader.elements<std::uint64_t>(name, num_blocks + 1);
    // More would not fit the sections, whose sizes must not overflow.
    constexpr std::uint64_t MostEntries = std::uint64_t{1} << 48;
    if (begin.front() != 0 || begin.back() > MostEntries ||
        !std::is_sorted(begin.begin(), begin.end()))
        reader.fail(name, "ranges of cells");
    return begin;
}

void require_cuts(const SectionReader& reader, std::size_t lobe, const LobeCuts& cuts) {
    for (std::size_t block = 0; block + 1 < cuts.begin.size(); ++block)
        if (!is_a_cut(std::span(cuts.cells)
                          .subspan(cuts.begin[block], cuts.begin[block + 1] - cuts.begin[block])))
            reader.fail(name_of(lobe, 'c'), "cells in order that do not overlap");
}

LobeCuts read_lobe(const SectionReader& reader, std::size_t lobe, std::size_t num_blocks) {
    LobeCuts cuts;
    const std::string scales = name_of(lobe, 's');
    cuts.begin = read_begin(reader, lobe, num_blocks);
    cuts.cells = sums(from_byte_planes<std::uint32_t>(reader, name_of(lobe, 'c')));
    cuts.scales = from_byte_planes<float>(reader, scales);
    if (cuts.begin.back() != cuts.num_entries())
        reader.fail(name_of(lobe, 'b'), "ranges of cells");
    if (cuts.scales.size() != cuts.num_entries())
        reader.fail(scales, "one number for each cell");
    cuts.values = reader.elements<std::uint8_t>(name_of(lobe, 'v'), cuts.num_entries() * BlockSize);
    require_cuts(reader, lobe, cuts);
    return cuts;
}

/// Reads the cells of all blocks.
std::vector<std::uint32_t> stream_cells(const SectionReader& reader, std::size_t lobe,
                                        std::uint64_t num_entries) {
    std::vector<std::uint32_t> cells;
    std::size_t entry = 0;
    std::uint32_t shift = 0;
    reader.stream(name_of(lobe, 'c'), num_entries * sizeof(std::uint32_t),
                  [&](std::span<const std::byte> piece) {
                      // Pieces come once the section has the right size.
                      cells.resize(static_cast<std::size_t>(num_entries));
                      for (const std::byte byte : piece) {
                          cells[entry] |= std::to_integer<std::uint32_t>(byte) << shift;
                          if (++entry == cells.size()) {
                              entry = 0;
                              shift += 8;
                          }
                      }
                  });
    return sums(std::move(cells));
}

/// Picks entries out of a section: `size` bytes each, or as many planes of single bytes.
std::vector<std::byte> picked(const SectionReader& reader, const std::string& name,
                              std::uint64_t num_entries, std::size_t size, bool in_planes,
                              std::span<const SectionPicker::Range> entries) {
    std::vector<SectionPicker::Range> ranges;
    const std::size_t num_planes = in_planes ? size : 1, width = in_planes ? 1 : size;
    for (std::size_t plane = 0; plane < num_planes; ++plane)
        for (const SectionPicker::Range& range : entries)
            ranges.push_back({plane * num_entries + range.begin * width,
                              plane * num_entries + range.end * width});
    SectionPicker picker(std::move(ranges));
    reader.stream(name, num_entries * size, [&](auto piece) { picker.take(piece); });
    return picker.elements<std::byte>();
}

LobeCuts read_lobe_part(const SectionReader& reader, std::size_t lobe, std::size_t num_blocks,
                        std::span<const BlockRange> blocks, std::uint32_t& depth) {
    const std::vector<std::uint64_t> begin = read_begin(reader, lobe, num_blocks);
    const std::uint64_t num_entries = begin.back();
    LobeCuts cuts;
    std::vector<SectionPicker::Range> entries;
    for (const BlockRange& range : blocks) {
        entries.push_back({begin[range.begin], begin[range.end]});
        for (std::size_t block = range.begin; block < range.end; ++block)
            cuts.begin.push_back(cuts.begin.back() + begin[block + 1] - begin[block]);
    }
    const std::vector<std::uint32_t> cells = stream_cells(reader, lobe, num_entries);
    for (const std::uint32_t cell : cells) {
        if (cell >= num_cells_above(MaxGlossyLevel + 1))
            reader.fail(name_of(lobe, 'c'), "cells in order that do not overlap");
        depth = std::max(depth, level_of_index(cell));
    }
    for (const SectionPicker::Range& range : entries)
        cuts.cells.insert(cuts.cells.end(),
                          cells.begin() + static_cast<std::ptrdiff_t>(range.begin),
                          cells.begin() + static_cast<std::ptrdiff_t>(range.end));
    cuts.scales = numbers_of<float>(
        picked(reader, name_of(lobe, 's'), num_entries, sizeof(float), true, entries));
    const std::vector<std::byte> values =
        picked(reader, name_of(lobe, 'v'), num_entries, BlockSize, false, entries);
    cuts.values.resize(values.size());
    std::transform(values.begin(), values.end(), cuts.values.begin(),
                   [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
    require_cuts(reader, lobe, cuts);
    return cuts;
}

} // namespace

void add_glossy_sections(NewSections& sections, const GlossyTransfer& glossy) {
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        const LobeCuts& cuts = glossy.lobes[lobe];
        if (is_optional(lobe) && cuts.num_entries() == 0)
            continue;
        sections[name_of(lobe, 'b')] = SectionContent::view(cuts.begin);
        // Each cell minus the one before, modulo 2^32: neighbours on the Z curve differ by little.
        sections[name_of(lobe, 'c')] = byte_planes(cuts.cells.size(), [&cuts](std::size_t i) {
            return cuts.cells[i] - (i == 0 ? 0 : cuts.cells[i - 1]);
        });
        sections[name_of(lobe, 's')] = byte_planes(cuts.scales.size(), [&cuts](std::size_t i) {
            return std::bit_cast<std::uint32_t>(cuts.scales[i]);
        });
        sections[name_of(lobe, 'v')] = SectionContent::view(cuts.values);
    }
}

bool has_glossy(const SectionReader& reader) {
    return reader.has(name_of(0, 'b'));
}

GlossyTransfer read_glossy(const SectionReader& reader, std::size_t num_blocks) {
    GlossyTransfer glossy;
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe)
        if (is_optional(lobe) && !reader.has(name_of(lobe, 'b')))
            glossy.lobes[lobe].begin.assign(num_blocks + 1, 0);
        else
            glossy.lobes[lobe] = read_lobe(reader, lobe, num_blocks);
    return glossy;
}

GlossyTransfer read_glossy_part(const SectionReader& reader, std::size_t num_blocks,
                                std::span<const BlockRange> blocks) {
    GlossyTransfer glossy;
    std::size_t num_own = 0;
    for (const BlockRange& range : blocks)
        num_own += range.end - range.begin;
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe)
        if (is_optional(lobe) && !reader.has(name_of(lobe, 'b')))
            glossy.lobes[lobe].begin.assign(num_own + 1, 0);
        else
            glossy.lobes[lobe] =
                read_lobe_part(reader, lobe, num_blocks, blocks, glossy.whole_depth);
    return glossy;
}

void check_highlights(const SceneCheck& check, const GlossyTransfer& glossy) {
    // Larger than the transfer of the narrowest highlight at the most grazing angle, 1/sr.
    constexpr float MaxTransfer = 1e9f;
    for (const LobeCuts& lobe : glossy.lobes)
        check.all(
            fmt::format("highlights of a transfer within {}", MaxTransfer), lobe.scales,
            [](float scale) { return scale >= 0.0f && scale * 255.0f * 255.0f <= MaxTransfer; });
}

const SectionGroup GlossySections = {
    .add =
        [](NewSections& sections, const Scene& scene) {
            if (scene.transfer.glossy && scene.settings.glossy_tolerance)
                add_glossy_sections(sections, *scene.transfer.glossy);
        },
    .read =
        [](const SectionReader& reader, Scene& scene) {
            if (has_glossy(reader))
                scene.transfer.glossy = read_glossy(reader, scene.transfer.counts.num_blocks());
        },
    .check =
        [](const SceneCheck& check, const Scene& scene) {
            // Without cells it is that of set_surfaces().
            const auto& glossy = scene.transfer.glossy;
            const bool is_glossy =
                glossy && (scene.settings.glossy_tolerance ||
                           std::any_of(glossy->lobes.begin(), glossy->lobes.end(),
                                       [](const LobeCuts& l) { return l.num_entries() != 0; }));
            // A plan knows how its highlights will be.
            const bool is_plan = scene.transfer.counts.num_receivers == 0;
            check.that(is_glossy == scene.settings.glossy_tolerance.has_value() ||
                           (is_plan && !is_glossy),
                       is_glossy ? "a tolerance of the highlights" : "highlights", "none");
            const Receivers& receivers = scene.receivers;
            check.that(!scene.settings.glossy_tolerance ||
                           (!receivers.to_eye.empty() && !receivers.surfaces.empty()),
                       "directions to the eye and surfaces with highlights", "none");
            if (is_glossy)
                check_highlights(check, *scene.transfer.glossy);
        },
    .is_light = true};

} // namespace relumine::prt
