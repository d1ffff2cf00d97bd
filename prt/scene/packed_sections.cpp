#include "prt/scene/packed_sections.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <zstd.h>

#include "files/free_memory.h"
#include "files/hash.h"
#include "files/large_vector.h"
#include "files/output_file.h"
#include "files/parallel.h"
#include "prt/scene/section_format.h"

namespace relumine::prt {

namespace {

/// The least size of a section's frames but its last one, in bytes.
constexpr std::size_t LeastFrame = std::size_t{1} << 16;

// What the sections of a file may take in all. Positions alone, which every scene has, pack much
// worse.
constexpr std::uint64_t LeastBudget = std::uint64_t{1} << 28, BudgetPerByte = 256;

std::string name_of(const SectionEntry& entry) {
    return {entry.name.begin(), std::find(entry.name.begin(), entry.name.end(), '\0')};
}

bool is_padded_with_zeros(const SectionEntry& entry) {
    return std::all_of(std::find(entry.name.begin(), entry.name.end(), '\0'), entry.name.end(),
                       [](char c) { return c == '\0'; });
}

} // namespace

bool begins_as_sections(const std::filesystem::path& path) {
    if (files::size(path) < SectionFileHeader::Magic.size())
        return false;
    const std::vector<std::byte> first = files::read(path, 0, SectionFileHeader::Magic.size());
    return std::memcmp(first.data(), SectionFileHeader::Magic.data(),
                       SectionFileHeader::Magic.size()) == 0;
}

PackedSections::PackedSections(const std::filesystem::path& path)
    : PackedSections(path, files::read(path)) {}

PackedSections::PackedSections(std::filesystem::path path, std::vector<std::byte> bytes)
    : path_(std::move(path)), bytes_(std::move(bytes)),
      budget_(
          std::min(std::max(LeastBudget, BudgetPerByte * bytes_.size()), files::free_memory())) {
    SectionFileHeader header;
    if (bytes_.size() < sizeof header || std::memcmp(bytes_.data(), SectionFileHeader::Magic.data(),
                                                     SectionFileHeader::Magic.size()) != 0)
        fail("a .prt scene", "another kind of file");
    std::memcpy(&header, bytes_.data(), sizeof header);
    if (header.byte_order_mark == std::uint32_t{0x04030201})
        fail("a little-endian .prt scene", "a big-endian one");
    if (header.byte_order_mark != SectionFileHeader::ByteOrderMark)
        fail("a .prt scene", "a damaged header");
    if (header.version != SceneFileVersion)
        fail(fmt::format(".prt version {}", SceneFileVersion),
             fmt::format("version {}, made by {}", header.version,
                         header.version > SceneFileVersion
                             ? "a newer relumine"
                             : "an older relumine: run precompute again"));
    if (header.file_size != bytes_.size())
        fail(fmt::format("{} bytes", header.file_size),
             fmt::format("{} (truncated or damaged)", bytes_.size()));
    if (header.num_sections > SectionFileHeader::MaxSections ||
        sizeof header + header.num_sections * sizeof(SectionEntry) > bytes_.size() ||
        header.reserved != 0)
        fail("a .prt scene", "a damaged header");

    std::vector<SectionEntry> table(header.num_sections);
    if (!table.empty())
        std::memcpy(table.data(), bytes_.data() + sizeof header,
                    table.size() * sizeof(SectionEntry));
    if (table_checksum(header, table) != header.checksum)
        fail("a matching checksum", "a damaged section table");
    std::uint64_t end = sizeof header + table.size() * sizeof(SectionEntry);
    std::string last_name;
    for (const SectionEntry& entry : table) {
        // Sections follow each other without gaps, so they are inside the file and every byte
        // belongs to one.
        if (entry.offset != end || entry.stored_size > bytes_.size() - end)
            fail("sections inside the file", "a damaged section table");
        end += entry.stored_size;
        const std::string name = name_of(entry); // A name goes into messages.
        if (!std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~'; }))
            fail("names of sections", "a damaged section table");
        if (name <= last_name || !is_padded_with_zeros(entry))
            fail("names of sections in ascending order", "a damaged section table");
        last_name = name;
        entries_[name] = {.stored = std::span(bytes_).subspan(entry.offset, entry.stored_size),
                          .size = entry.size,
                          .checksum = entry.checksum};
    }
    if (end != bytes_.size())
        fail("sections that fill the file", "a damaged section table");
    files::parallel_for(std::size_t{0}, table.size(), [&](std::size_t i) {
        const std::string name = name_of(table[i]);
        if (files::hash_of(entries_.at(name).stored) != table[i].checksum)
            fail("a matching checksum", fmt::format("a damaged section '{}'", name));
    });
}

void PackedSections::fail(std::string_view expected, std::string_view got) const {
    throw std::runtime_error(fmt::format("{}: expected {}, got {}", path_.string(), expected, got));
}

std::vector<std::string> PackedSections::names() const {
    std::vector<std::string> names;
    for (const auto& [name, entry] : entries_)
        names.push_back(name);
    return names;
}

StoredSection PackedSections::stored(const std::string& name) const {
    const Entry& of_name = entry(name, 1);
    return {.path = path_,
            .offset = static_cast<std::uint64_t>(of_name.stored.data() - bytes_.data()),
            .stored_size = of_name.stored.size(),
            .size = of_name.size,
            .checksum = of_name.checksum};
}

const PackedSections::Entry& PackedSections::entry(const std::string& name,
                                                   std::uint64_t cost) const {
    const auto found = entries_.find(name);
    if (found == entries_.end())
        fail(fmt::format("a section '{}'", name), "none");
    if (found->second.size > budget_ / cost)
        fail(fmt::format("sections that a file of {} bytes can have", bytes_.size()),
             fmt::format("{} bytes in section '{}'", found->second.size, name));
    return found->second;
}

std::vector<std::byte> PackedSections::bytes(const std::string& name, std::uint64_t cost) const {
    std::vector<std::byte> result;
    unpack(name, cost, [&result](std::size_t size) {
        result = files::large_vector<std::byte>(size);
        return std::span(result);
    });
    return result;
}

void PackedSections::unpack(
    const std::string& name, std::uint64_t cost,
    const std::function<std::span<std::byte>(std::size_t size)>& make_room) const {
    const std::vector<Frame> frames = take(name, cost);
    const std::span<std::byte> room = make_room(entries_.at(name).size);
    files::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
        unpack_frame(name, frames[i], room.subspan(frames[i].begin, frames[i].size));
    });
}

void PackedSections::unpack_pieces(
    const std::string& name, std::uint64_t cost,
    const std::function<void(std::uint64_t begin, std::span<const std::byte>)>& on_piece) const {
    const std::vector<Frame> frames = take(name, cost);
    files::parallel_for(
        files::IndexRange<std::size_t>(0, frames.size()), [&](const auto& of_thread) {
            std::vector<std::byte> room;
            for (std::size_t i = of_thread.begin(); i < of_thread.end(); ++i) {
                room.resize(std::max<std::size_t>(room.size(), frames[i].size));
                const std::span<std::byte> piece = std::span(room).first(frames[i].size);
                unpack_frame(name, frames[i], piece);
                on_piece(frames[i].begin, piece);
            }
        });
}

/// Finds a section's frames, whose sizes add up to `size`. All but the last have at least
/// LeastFrame bytes, so that a file cannot have millions of frames. Returns none for a section
/// that breaks one of these rules.
std::vector<PackedSections::Frame>
PackedSections::frames_of(std::span<const std::byte> stored_bytes, std::uint64_t size) {
    std::vector<Frame> frames;
    std::uint64_t done = 0;
    while (!stored_bytes.empty()) {
        const std::size_t stored =
            ZSTD_findFrameCompressedSize(stored_bytes.data(), stored_bytes.size());
        if (ZSTD_isError(stored) != 0 || (!frames.empty() && frames.back().size < LeastFrame))
            return {};
        const unsigned long long own = ZSTD_getFrameContentSize(stored_bytes.data(), stored);
        // The two errors are larger than any size.
        if (own > size - done)
            return {};
        frames.push_back({.stored = stored_bytes.first(stored), .begin = done, .size = own});
        done += own;
        stored_bytes = stored_bytes.subspan(stored);
    }
    return done == size ? frames : std::vector<Frame>();
}

/// Takes a section from the budget. Returns its frames.
std::vector<PackedSections::Frame> PackedSections::take(const std::string& name,
                                                        std::uint64_t cost) const {
    const auto& [stored, size, checksum] = entry(name, cost);
    budget_ -= size * cost;
    std::vector<Frame> frames = frames_of(stored, size);
    if (frames.empty())
        fail("zstd data", fmt::format("a damaged section '{}'", name));
    return frames;
}

/// Unpacks a frame into bytes of its size.
void PackedSections::unpack_frame(const std::string& name, const Frame& frame,
                                  std::span<std::byte> bytes) const {
    const std::size_t size =
        ZSTD_decompress(bytes.data(), bytes.size(), frame.stored.data(), frame.stored.size());
    if (ZSTD_isError(size) != 0 || size != bytes.size())
        fail("zstd data", fmt::format("a damaged section '{}'", name));
}

void PackedSections::stream(const std::string& name, std::optional<std::uint64_t> wanted_size,
                            const std::function<void(std::span<const std::byte>)>& on_piece) const {
    const auto& [stored, whole_size, checksum] = entry(name, 1);
    if (wanted_size && whole_size != *wanted_size)
        fail(fmt::format("a section '{}' of {} bytes", name, *wanted_size), "another");
    const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                          ZSTD_freeDCtx);
    if (!context)
        throw std::bad_alloc();
    ZSTD_inBuffer in{.src = stored.data(), .size = stored.size(), .pos = 0};
    std::vector<std::byte> piece(SectionPiece);
    for (std::uint64_t done = 0; done < whole_size;) {
        const std::size_t size = std::min<std::uint64_t>(SectionPiece, whole_size - done);
        ZSTD_outBuffer out{.dst = piece.data(), .size = size, .pos = 0};
        while (out.pos < size) {
            const std::size_t before = out.pos + in.pos;
            if (ZSTD_isError(ZSTD_decompressStream(context.get(), &out, &in)) != 0 ||
                out.pos + in.pos == before)
                fail("zstd data", fmt::format("a damaged section '{}'", name));
        }
        on_piece(std::span(piece).first(size));
        done += size;
    }
}

Sections read_sections(const std::filesystem::path& path) {
    const PackedSections packed(path);
    Sections sections;
    for (const std::string& name : packed.names())
        sections.emplace(name, packed.bytes(name));
    return sections;
}

} // namespace relumine::prt
