#include "prt/scene/joined_counts.h"

#include <algorithm>
#include <memory>
#include <new>
#include <numeric>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include "files/output_file.h"
#include "prt/clusters/dealt_tiles.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/small_numbers.h"

namespace relumine::prt {

namespace {

/// What a section is unpacked with between its first byte and its last.
class Unpacking {
public:
    Unpacking() {
        if (!context_ || !hash_)
            throw std::bad_alloc();
        XXH64_reset(hash_.get(), 0);
    }

    /// Unpacks some bytes of the section; false where they are no zstd data.
    bool unpack(const StoredSection& section, std::span<std::byte> bytes) {
        ZSTD_outBuffer out{.dst = bytes.data(), .size = bytes.size(), .pos = 0};
        while (out.pos < out.size) {
            if (in_.pos == in_.size && !read_more(section))
                return false;
            if (ZSTD_isError(ZSTD_decompressStream(context_.get(), &out, &in_)) != 0)
                return false;
        }
        return true;
    }

    /// Reads the rest of the section. Returns whether its bytes are those that were there at first.
    bool is_unchanged(const StoredSection& section) {
        while (read_more(section))
            ;
        return XXH64_digest(hash_.get()) == section.checksum;
    }

private:
    /// Most bytes of the file that are read at a time.
    static constexpr std::uint64_t BytesPerRead = std::uint64_t{1} << 16;

    bool read_more(const StoredSection& section) {
        const std::uint64_t size = std::min(BytesPerRead, section.stored_size - num_read_);
        if (size == 0)
            return false;
        stored_ =
            files::read(section.path, section.offset + num_read_, static_cast<std::size_t>(size));
        num_read_ += size;
        XXH64_update(hash_.get(), stored_.data(), stored_.size());
        in_ = {.src = stored_.data(), .size = stored_.size(), .pos = 0};
        return true;
    }

    const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context_{ZSTD_createDCtx(),
                                                                           ZSTD_freeDCtx};
    const std::unique_ptr<XXH64_state_t, XXH_errorcode (*)(XXH64_state_t*)> hash_{
        XXH64_createState(), XXH64_freeState};
    std::vector<std::byte> stored_;
    ZSTD_inBuffer in_{};
    std::uint64_t num_read_ = 0;
};

/// Unpacks a section from its file, from its begin to its end. The file is open only while bytes
/// are read, so any number of streams may go on together.
///
/// Memory:  what zstd needs for a frame of the section, until the end.
class SectionStream {
public:
    explicit SectionStream(StoredSection section) : section_(std::move(section)) {}

    /// Fills `bytes` with the next bytes of the section.
    ///
    /// Throws:  std::runtime_error that names the path, also where the file has changed since it
    ///          was opened, which shows at the end of the section at the latest.
    void read(std::span<std::byte> bytes) {
        if (bytes.size() > section_.size - done_)
            fail();
        if (bytes.empty())
            return;
        if (!unpacking_)
            unpacking_ = std::make_unique<Unpacking>();
        if (!unpacking_->unpack(section_, bytes))
            fail();
        done_ += bytes.size();
        if (done_ < section_.size)
            return;
        if (!unpacking_->is_unchanged(section_))
            fail();
        unpacking_.reset();
    }

private:
    [[noreturn]] void fail() const {
        throw std::runtime_error(
            fmt::format("{}: expected the file that was checked, got another: it changed meanwhile",
                        section_.path.string()));
    }

    StoredSection section_;
    std::unique_ptr<Unpacking> unpacking_;
    std::uint64_t done_ = 0;
};

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
