// The functions of headers/zstd.h.
#include <algorithm>
#include <new>
#include <vector>

#include <zstd.h>

#include "web/wasm/zstd_frames.h"

using namespace relumine::web;

namespace {

constexpr std::size_t Error = ~std::size_t{0};

Bytes bytes_of(const void* from, std::size_t size) {
    return {static_cast<const std::uint8_t*>(from), size};
}

/// No exception leaves.
template<class Value, class Work>
Value value_or(Value if_failed, const Work& work) noexcept {
    try {
        return work();
    } catch (const NoFrame&) {
        return if_failed;
    } catch (const std::bad_alloc&) {
        return if_failed;
    }
}

} // namespace

/// Input waits until a frame is whole, and its content until it is taken.
struct ZSTD_DCtx {
    std::vector<std::uint8_t> stored, content;
    std::size_t num_taken = 0;
};

size_t ZSTD_compressBound(size_t) {
    return 0;
}
size_t ZSTD_compress(void*, size_t, const void*, size_t, int) {
    return Error;
}
unsigned ZSTD_isError(size_t code) {
    return code == Error ? 1 : 0;
}
const char* ZSTD_getErrorName(size_t) {
    return "expected a zstd frame to read";
}

size_t ZSTD_findFrameCompressedSize(const void* from, size_t size) {
    return value_or(Error, [&] { return frame_size(bytes_of(from, size)).value_or(Error); });
}

unsigned long long ZSTD_getFrameContentSize(const void* from, size_t size) {
    return value_or(ZSTD_CONTENTSIZE_ERROR, [&]() -> unsigned long long {
        return content_size(bytes_of(from, size)).value_or(ZSTD_CONTENTSIZE_UNKNOWN);
    });
}

size_t ZSTD_decompress(void* to, size_t capacity, const void* from, size_t size) {
    return value_or(Error, [&] {
        return unpack_frame(bytes_of(from, size), {static_cast<std::uint8_t*>(to), capacity});
    });
}

ZSTD_DCtx* ZSTD_createDCtx(void) {
    return new (std::nothrow) ZSTD_DCtx;
}

size_t ZSTD_freeDCtx(ZSTD_DCtx* context) {
    delete context;
    return 0;
}

size_t ZSTD_decompressStream(ZSTD_DCtx* context, ZSTD_outBuffer* out, ZSTD_inBuffer* in) {
    return value_or(Error, [&]() -> std::size_t {
        if (context->num_taken == context->content.size()) {
            const auto* from = static_cast<const std::uint8_t*>(in->src);
            // As much of the input as ends this frame: what follows stays with the caller.
            const Bytes rest(from + in->pos, in->size - in->pos);
            const bool has_begun = !context->stored.empty();
            const std::optional<std::size_t> whole = has_begun ? std::nullopt : frame_size(rest);
            context->stored.insert(context->stored.end(), rest.begin(),
                                   rest.begin() +
                                       static_cast<std::ptrdiff_t>(whole.value_or(rest.size())));
            in->pos += whole.value_or(rest.size());
            const std::optional<std::size_t> size = frame_size(context->stored);
            if (!size)
                return 1;
            const Bytes frame = Bytes(context->stored).first(*size);
            const std::optional<std::uint64_t> content = content_size(frame);
            if (!content)
                return Error;
            context->content.resize(static_cast<std::size_t>(*content));
            context->num_taken = 0;
            static_cast<void>(unpack_frame(frame, context->content));
            context->stored.erase(context->stored.begin(),
                                  context->stored.begin() + static_cast<std::ptrdiff_t>(*size));
        }
        const std::size_t size =
            std::min(context->content.size() - context->num_taken, out->size - out->pos);
        std::copy_n(context->content.begin() + static_cast<std::ptrdiff_t>(context->num_taken),
                    size, static_cast<std::uint8_t*>(out->dst) + out->pos);
        out->pos += size;
        context->num_taken += size;
        return context->content.size() - context->num_taken;
    });
}
