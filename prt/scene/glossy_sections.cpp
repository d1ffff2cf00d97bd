#include "prt/scene/glossy_sections.h"

#include <algorithm>
#include <string>

#include "prt/clusters/cell_index.h"

namespace relumine::prt {

namespace {

// By GlossyLobe.
constexpr std::array<const char*, NumGlossyLobes> Names = {"g_specular", "g_spec_grazing",
                                                           "g_diff_grazing"};

std::string name_of(std::size_t lobe, char part) {
    return fmt::format("{}_{}", Names[lobe], part);
}

/// Stores all first bytes, then all second bytes, and so on: similar numbers then compress four
/// times better.
template<typename Number>
std::vector<std::byte> byte_planes(const std::vector<Number>& numbers) {
    const std::vector<std::byte> bytes = bytes_of(numbers);
    std::vector<std::byte> planes(bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
        planes[i % sizeof(Number) * numbers.size() + i / sizeof(Number)] = bytes[i];
    return planes;
}

template<typename Number>
std::vector<Number> from_byte_planes(const SectionReader& reader, const std::string& name) {
    const std::vector<std::byte>& planes = reader.bytes(name);
    if (planes.size() % sizeof(Number) != 0)
        reader.fail(name, fmt::format("a multiple of {} bytes", sizeof(Number)));
    std::vector<Number> numbers(planes.size() / sizeof(Number));
    std::vector<std::byte> bytes(planes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = planes[i % sizeof(Number) * numbers.size() + i / sizeof(Number)];
    if (!bytes.empty())
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

/// Returns each cell minus the one before, modulo 2^32: neighbours on the Z curve differ by little.
std::vector<std::uint32_t> differences(std::vector<std::uint32_t> cells) {
    for (std::size_t i = cells.size(); i-- > 1;)
        cells[i] -= cells[i - 1];
    return cells;
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

LobeCuts read_lobe(const SectionReader& reader, std::size_t lobe, std::size_t num_blocks) {
    LobeCuts cuts;
    const std::string begin = name_of(lobe, 'b');
    const std::string cells = name_of(lobe, 'c');
    const std::string scales = name_of(lobe, 's');
    cuts.begin = reader.elements<std::uint64_t>(begin, num_blocks + 1);
    cuts.cells = sums(from_byte_planes<std::uint32_t>(reader, cells));
    cuts.scales = from_byte_planes<float>(reader, scales);
    if (cuts.begin.front() != 0 || cuts.begin.back() != cuts.num_entries() ||
        !std::is_sorted(cuts.begin.begin(), cuts.begin.end()))
        reader.fail(begin, "ranges of cells");
    if (cuts.scales.size() != cuts.num_entries())
        reader.fail(scales, "one number for each cell");
    cuts.values = reader.elements<std::uint8_t>(name_of(lobe, 'v'), cuts.num_entries() * BlockSize);
    for (std::size_t block = 0; block < num_blocks; ++block)
        if (!is_a_cut(std::span(cuts.cells)
                          .subspan(cuts.begin[block], cuts.begin[block + 1] - cuts.begin[block])))
            reader.fail(cells, "cells in order that do not overlap");
    return cuts;
}

} // namespace

void add_glossy_sections(Sections& sections, const GlossyTransfer& glossy) {
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        const LobeCuts& cuts = glossy.lobes[lobe];
        sections[name_of(lobe, 'b')] = bytes_of(cuts.begin);
        sections[name_of(lobe, 'c')] = byte_planes(differences(cuts.cells));
        sections[name_of(lobe, 's')] = byte_planes(cuts.scales);
        sections[name_of(lobe, 'v')] = bytes_of(cuts.values);
    }
}

bool has_glossy(const SectionReader& reader) {
    return reader.has(name_of(0, 'b'));
}

GlossyTransfer read_glossy(const SectionReader& reader, std::size_t num_blocks) {
    GlossyTransfer glossy;
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe)
        glossy.lobes[lobe] = read_lobe(reader, lobe, num_blocks);
    return glossy;
}

} // namespace relumine::prt
