// Reads zstd frames of stored blocks, as files::stored_frame() makes them.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "files/stored_frame.h"
#include "web/wasm/headers/zstd.h"

using relumine::files::StoredFrame;

namespace {

constexpr std::size_t Error = ~std::size_t{0};

std::uint32_t little_endian(const std::uint8_t* bytes, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
        value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
    return value;
}

/// Returns the size that the frame's header says, if it is one of a stored frame.
std::optional<std::uint64_t> content_size(std::span<const std::uint8_t> frame) {
    if (frame.size() < StoredFrame::HeaderSize ||
        little_endian(frame.data(), 4) != StoredFrame::Magic || frame[4] != StoredFrame::Descriptor)
        return std::nullopt;
    return little_endian(frame.data() + 5, 4) |
           static_cast<std::uint64_t>(little_endian(frame.data() + 9, 4)) << 32;
}

/// Calls visit(bytes) with each block, and returns where the frame ends.
template<class Visit>
std::optional<std::size_t> for_blocks(std::span<const std::uint8_t> frame, const Visit& visit) {
    if (!content_size(frame))
        return std::nullopt;
    for (std::size_t at = StoredFrame::HeaderSize;;) {
        if (frame.size() - at < StoredFrame::BlockHeaderSize)
            return std::nullopt;
        const std::uint32_t header = little_endian(frame.data() + at, StoredFrame::BlockHeaderSize);
        const std::size_t size = header >> 3;
        at += StoredFrame::BlockHeaderSize;
        if ((header >> 1 & 3u) != 0 || size > frame.size() - at)
            return std::nullopt;
        visit(frame.subspan(at, size));
        at += size;
        if ((header & 1u) != 0)
            return at;
    }
}

std::span<const std::uint8_t> bytes_of(const void* from, std::size_t size) {
    return {static_cast<const std::uint8_t*>(from), size};
}

} // namespace

/// Where a stream stands in its input: so many bytes of a header have come, and so many of a block
/// are still to come.
struct ZSTD_DCtx {
    std::uint8_t header[StoredFrame::HeaderSize];
    std::size_t num_header = 0;
    std::size_t rest = 0;
    bool in_frame = false, is_last = false;
};

size_t ZSTD_compressBound(size_t size) {
    return relumine::files::stored_frame_size(size);
}

size_t ZSTD_compress(void* to, size_t capacity, const void* from, size_t size, int) {
    const auto frame = relumine::files::stored_frame(std::as_bytes(bytes_of(from, size)));
    if (frame.size() > capacity)
        return Error;
    std::memcpy(to, frame.data(), frame.size());
    return frame.size();
}

unsigned ZSTD_isError(size_t code) {
    return code == Error ? 1 : 0;
}

const char* ZSTD_getErrorName(size_t) {
    return "no stored frame";
}

size_t ZSTD_findFrameCompressedSize(const void* from, size_t size) {
    return for_blocks(bytes_of(from, size), [](auto) {}).value_or(Error);
}

unsigned long long ZSTD_getFrameContentSize(const void* from, size_t size) {
    return content_size(bytes_of(from, size)).value_or(ZSTD_CONTENTSIZE_ERROR);
}

size_t ZSTD_decompress(void* to, size_t capacity, const void* from, size_t size) {
    std::size_t done = 0;
    bool fits = true;
    const auto end = for_blocks(bytes_of(from, size), [&](std::span<const std::uint8_t> block) {
        fits = fits && block.size() <= capacity - done;
        if (!fits)
            return;
        if (!block.empty())
            std::memcpy(static_cast<std::uint8_t*>(to) + done, block.data(), block.size());
        done += block.size();
    });
    return end == size && fits ? done : Error;
}

ZSTD_DCtx* ZSTD_createDCtx(void) {
    return new ZSTD_DCtx;
}

size_t ZSTD_freeDCtx(ZSTD_DCtx* context) {
    delete context;
    return 0;
}

size_t ZSTD_decompressStream(ZSTD_DCtx* context, ZSTD_outBuffer* out, ZSTD_inBuffer* in) {
    const auto* from = static_cast<const std::uint8_t*>(in->src);
    while (in->pos < in->size) {
        if (context->rest > 0) {
            const std::size_t size =
                std::min({context->rest, in->size - in->pos, out->size - out->pos});
            if (size == 0)
                return context->rest;
            std::memcpy(static_cast<std::uint8_t*>(out->dst) + out->pos, from + in->pos, size);
            in->pos += size;
            out->pos += size;
            context->rest -= size;
            continue;
        }
        if (context->in_frame && context->is_last)
            context->in_frame = context->is_last = false;
        const std::size_t wanted =
            context->in_frame ? StoredFrame::BlockHeaderSize : StoredFrame::HeaderSize;
        context->header[context->num_header++] = from[in->pos++];
        if (context->num_header < wanted)
            continue;
        context->num_header = 0;
        if (context->in_frame) {
            const std::uint32_t header = little_endian(context->header, wanted);
            if ((header >> 1 & 3u) != 0)
                return Error;
            context->is_last = (header & 1u) != 0;
            context->rest = header >> 3;
        } else {
            if (!content_size({context->header, wanted}))
                return Error;
            context->in_frame = true;
        }
    }
    return context->rest;
}
