#include "prt/scene/section_stream.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include "files/output_file.h"

namespace relumine::prt {

namespace {

/// Most bytes of the file that are read at a time.
constexpr std::uint64_t BytesPerRead = std::uint64_t{1} << 16;

} // namespace

/// What is needed between the first byte and the last.
class SectionStream::Unpacking {
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

SectionStream::SectionStream(StoredSection section) : section_(std::move(section)) {}
SectionStream::~SectionStream() = default;
SectionStream::SectionStream(SectionStream&&) noexcept = default;

void SectionStream::fail() const {
    throw std::runtime_error(
        fmt::format("{}: expected the file that was checked, got another: it changed meanwhile",
                    section_.path.string()));
}

void SectionStream::read(std::span<std::byte> bytes) {
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

} // namespace relumine::prt
