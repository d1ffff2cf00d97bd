#include "prt/scene/section_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include "files/compression.h"
#include "files/free_memory.h"
#include "files/hash.h"
#include "files/large_vector.h"
#include "files/output_file.h"
#include "files/parallel.h"

namespace relumine::prt {

namespace {

// The file's structures are memory images. A big-endian reader would have to swap them.
static_assert(std::endian::native == std::endian::little, ".prt files are little-endian");

constexpr std::array<char, 8> Magic = {'R', 'E', 'L', 'U', 'M', 'I', 'N', 'E'};
constexpr std::uint32_t ByteOrderMark = 0x01020304;
constexpr std::uint32_t MaxSections = 128;

// Level 8 packs the counts of the Stanford bunny 4 % smaller than level 6, in half a second on two
// cores. Level 10 saves 1 % more and takes half as long again.
constexpr int CompressionLevel = 8;

/// Of sections that are sent to a process beside, and to a browser far away.
constexpr int FastCompressionLevel = 1, BestCompressionLevel = 19;

// A section is cut into frames of this many bytes, the last one shorter, so that all processors
// pack and unpack. The counts of the Stanford bunny are 0.5 % larger for it.
constexpr std::size_t FrameSize = std::size_t{1} << 21;
constexpr std::size_t LeastFrame = std::size_t{1} << 16;

// What the sections of a file may take in all. Positions alone, which every scene has, pack much
// worse.
constexpr std::uint64_t LeastBudget = std::uint64_t{1} << 28, BudgetPerByte = 256;

struct Header {
    std::array<char, 8> magic;
    std::uint32_t byte_order_mark;
    std::uint32_t version;
    std::uint64_t file_size;
    std::uint32_t num_sections;
    std::uint32_t reserved;
    /// xxHash64 of the header up to here and of the section table.
    std::uint64_t checksum;
};
static_assert(sizeof(Header) == 40);

struct SectionEntry {
    /// Padded with zeros.
    std::array<char, 16> name;
    /// From the start of the file.
    std::uint64_t offset;
    /// Compressed.
    std::uint64_t stored_size;
    /// Uncompressed.
    std::uint64_t size;
    /// xxHash64 of the stored bytes.
    std::uint64_t checksum;
};
static_assert(sizeof(SectionEntry) == 48);

std::uint64_t table_checksum(const Header& header, std::span<const SectionEntry> table) {
    std::vector<std::byte> bytes(offsetof(Header, checksum) + table.size_bytes());
    std::memcpy(bytes.data(), &header, offsetof(Header, checksum));
    if (!table.empty())
        std::memcpy(bytes.data() + offsetof(Header, checksum), table.data(), table.size_bytes());
    return files::hash_of(bytes);
}

std::string name_of(const SectionEntry& entry) {
    return {entry.name.begin(), std::find(entry.name.begin(), entry.name.end(), '\0')};
}

bool is_padded_with_zeros(const SectionEntry& entry) {
    return std::all_of(std::find(entry.name.begin(), entry.name.end(), '\0'), entry.name.end(),
                       [](char c) { return c == '\0'; });
}

/// Writes sections frame by frame: a batch of frames is packed in parallel, written and forgotten.
class Writer {
public:
    /// `file`: null keeps the bytes in memory.
    Writer(files::OutputFile* file, const NewSections& sections, int compression_level)
        : table_(checked_table(sections)), file_(file), compression_level_(compression_level) {
        // The table comes first in the file and is known last.
        append(std::vector<std::byte>(sizeof(Header) + table_.size() * sizeof(SectionEntry)));
        size_ = sizeof(Header) + table_.size() * sizeof(SectionEntry);
    }

    std::uint64_t write(const NewSections& sections) {
        std::size_t index = 0;
        for (const auto& [name, content] : sections) {
            std::uint64_t begin = 0;
            do { // An empty section has one frame, too.
                const auto size = static_cast<std::size_t>(
                    std::min<std::uint64_t>(FrameSize, content.size() - begin));
                batch_.push_back({.section = index,
                                  .content = &content,
                                  .begin = begin,
                                  .size = size,
                                  .is_last = begin + size == content.size()});
                content.take_next(size, batch_.back().made);
                begin += size;
                if (batch_.size() == BatchFrames)
                    write_batch();
            } while (begin < content.size());
            ++index;
        }
        write_batch();
        write_table();
        return size_;
    }

    [[nodiscard]] std::vector<std::byte> take_bytes() { return std::move(bytes_); }

private:
    /// Enough for all processors, and 32 MiB.
    static constexpr std::size_t BatchFrames = 16;

    struct Frame {
        std::size_t section;
        const SectionContent* content;
        std::uint64_t begin;
        std::size_t size;
        bool is_last;
        std::vector<std::byte> made = {};
        std::vector<std::byte> stored = {};
    };

    static std::vector<SectionEntry> checked_table(const NewSections& sections) {
        if (sections.size() > MaxSections)
            throw std::invalid_argument(
                fmt::format("expected at most {} sections, got {}", MaxSections, sections.size()));
        std::vector<SectionEntry> table;
        for (const auto& [name, content] : sections) {
            SectionEntry& entry = table.emplace_back();
            if (name.empty() || name.size() > entry.name.size())
                throw std::invalid_argument(
                    fmt::format("expected a section name of 1 to 16 letters, got '{}'", name));
            std::copy(name.begin(), name.end(), entry.name.begin());
            entry.size = content.size();
        }
        return table;
    }

    void write_batch() {
        files::parallel_for(std::size_t{0}, batch_.size(), [&](std::size_t i) {
            Frame& frame = batch_[i];
            frame.stored = files::compressed(
                frame.content->bytes(frame.begin, frame.size, frame.made), compression_level_);
            frame.made = {};
        });
        for (const Frame& frame : batch_) {
            num_packed_ += frame.size;
            num_stored_ += frame.stored.size();
        }
        // The rest will pack as what came before did.
        const auto num_bytes = static_cast<double>(std::accumulate(
            table_.begin(), table_.end(), std::uint64_t{0},
            [](std::uint64_t sum, const SectionEntry& entry) { return sum + entry.size; }));
        if (num_packed_ > 0 && file_ != nullptr)
            file_->expect(static_cast<std::uint64_t>(static_cast<double>(num_stored_) * num_bytes /
                                                     static_cast<double>(num_packed_)));
        for (const Frame& frame : batch_) {
            SectionEntry& entry = table_[frame.section];
            if (entry.stored_size == 0) {
                entry.offset = size_;
                XXH64_reset(hash_.get(), 0);
            }
            XXH64_update(hash_.get(), frame.stored.data(), frame.stored.size());
            append(frame.stored);
            size_ += frame.stored.size();
            entry.stored_size += frame.stored.size();
            if (frame.is_last)
                entry.checksum = XXH64_digest(hash_.get());
        }
        batch_.clear();
    }

    void write_table() {
        Header header{.magic = Magic,
                      .byte_order_mark = ByteOrderMark,
                      .version = SceneFileVersion,
                      .file_size = size_,
                      .num_sections = static_cast<std::uint32_t>(table_.size()),
                      .reserved = 0,
                      .checksum = 0};
        header.checksum = table_checksum(header, table_);
        replace(0, std::as_bytes(std::span(&header, 1)));
        replace(sizeof header, std::as_bytes(std::span(table_)));
    }

    void append(std::span<const std::byte> bytes) {
        if (file_ != nullptr)
            return file_->append(bytes);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }

    void replace(std::uint64_t offset, std::span<const std::byte> bytes) {
        if (file_ != nullptr)
            return file_->replace(offset, bytes);
        std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    }

    std::vector<SectionEntry> table_;
    files::OutputFile* file_;
    std::vector<std::byte> bytes_;
    int compression_level_;
    std::uint64_t size_ = 0;
    std::uint64_t num_packed_ = 0;
    std::uint64_t num_stored_ = 0;
    std::vector<Frame> batch_;
    const std::unique_ptr<XXH64_state_t, XXH_errorcode (*)(XXH64_state_t*)> hash_{
        XXH64_createState(), XXH64_freeState};
};

} // namespace

std::span<const std::byte> SectionContent::bytes(std::uint64_t begin, std::size_t size,
                                                 std::vector<std::byte>& made) const {
    const auto at = static_cast<std::size_t>(begin);
    if (const auto* own = std::get_if<std::vector<std::byte>>(&content_))
        return std::span(*own).subspan(at, size);
    if (const auto* view = std::get_if<std::span<const std::byte>>(&content_))
        return view->subspan(at, size);
    if (std::holds_alternative<InOrder>(content_))
        return made;
    made.resize(size);
    if (size != 0)
        std::get<Maker>(content_).fill(begin, made);
    return made;
}

std::uint64_t SectionContent::size() const {
    if (const auto* own = std::get_if<std::vector<std::byte>>(&content_))
        return own->size();
    if (const auto* view = std::get_if<std::span<const std::byte>>(&content_))
        return view->size();
    if (const auto* in_order = std::get_if<InOrder>(&content_))
        return in_order->size;
    return std::get<Maker>(content_).size;
}

void SectionContent::take_next(std::size_t size, std::vector<std::byte>& made) const {
    if (const auto* in_order = std::get_if<InOrder>(&content_)) {
        made.resize(size);
        in_order->next(made);
    }
}

NewSections to_write(Sections sections) {
    NewSections result;
    for (Sections::value_type& section : sections)
        result.emplace(section.first, std::move(section.second));
    return result;
}

std::uint64_t write_sections(const std::filesystem::path& path, const NewSections& sections) {
    files::OutputFile file(path);
    const std::uint64_t size = Writer(&file, sections, CompressionLevel).write(sections);
    file.commit();
    return size;
}

std::vector<std::byte> packed_sections(const NewSections& sections, Packing packing) {
    Writer writer(nullptr, sections,
                  packing == Packing::Fast ? FastCompressionLevel : BestCompressionLevel);
    static_cast<void>(writer.write(sections));
    return writer.take_bytes();
}

bool begins_as_sections(const std::filesystem::path& path) {
    if (files::size(path) < Magic.size())
        return false;
    const std::vector<std::byte> first = files::read(path, 0, Magic.size());
    return std::memcmp(first.data(), Magic.data(), Magic.size()) == 0;
}

PackedSections::PackedSections(const std::filesystem::path& path)
    : PackedSections(path, files::read(path)) {}

PackedSections::PackedSections(std::filesystem::path path, std::vector<std::byte> bytes)
    : path_(std::move(path)), bytes_(std::move(bytes)),
      budget_(
          std::min(std::max(LeastBudget, BudgetPerByte * bytes_.size()), files::free_memory())) {
    Header header;
    if (bytes_.size() < sizeof header ||
        std::memcmp(bytes_.data(), Magic.data(), Magic.size()) != 0)
        fail("a .prt scene", "another kind of file");
    std::memcpy(&header, bytes_.data(), sizeof header);
    if (header.byte_order_mark == std::uint32_t{0x04030201})
        fail("a little-endian .prt scene", "a big-endian one");
    if (header.byte_order_mark != ByteOrderMark)
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
    if (header.num_sections > MaxSections ||
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
