#include "prt/scene/section_file.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <xxhash.h>

#include "files/compression.h"
#include "files/output_file.h"
#include "files/parallel.h"
#include "prt/scene/section_format.h"

namespace relumine::prt {

namespace {

// Level 8 packs the counts of the Stanford bunny 4 % smaller than level 6, in half a second on two
// cores. Level 10 saves 1 % more and takes half as long again.
constexpr int CompressionLevel = 8;

/// Levels for sections that are sent to a process beside, and to a browser far away.
constexpr int FastCompressionLevel = 1, BestCompressionLevel = 19;

// A section is cut into frames of this many bytes, the last one shorter, so that all processors
// pack and unpack. The counts of the Stanford bunny are 0.5 % larger for it.
constexpr std::size_t FrameSize = std::size_t{1} << 21;

/// Writes sections frame by frame: a batch of frames is packed in parallel, written and forgotten.
class Writer {
public:
    /// `file`: null keeps the bytes in memory.
    Writer(files::OutputFile* file, const NewSections& sections, int compression_level)
        : table_(checked_table(sections)), file_(file), compression_level_(compression_level) {
        // The table comes first in the file and is known last.
        append(std::vector<std::byte>(sizeof(SectionFileHeader) +
                                      table_.size() * sizeof(SectionEntry)));
        size_ = sizeof(SectionFileHeader) + table_.size() * sizeof(SectionEntry);
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
        if (sections.size() > SectionFileHeader::MaxSections)
            throw std::invalid_argument(fmt::format("expected at most {} sections, got {}",
                                                    SectionFileHeader::MaxSections,
                                                    sections.size()));
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
        SectionFileHeader header{.file_size = size_,
                                 .num_sections = static_cast<std::uint32_t>(table_.size())};
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

} // namespace relumine::prt
