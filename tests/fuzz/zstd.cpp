// The reader of zstd frames that the web has, beside zstd itself: both unpack the same.
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "web/wasm/zstd_frames.h"

RELUMINE_FUZZ_TARGET(zstd) {
    using namespace relumine;
    constexpr std::size_t Room = std::size_t{1} << 18;
    std::vector<std::uint8_t> own(Room), expected(Room);
    const auto own_size = [&]() -> std::optional<std::size_t> {
        try {
            const std::optional<std::size_t> frame = web::frame_size({data, size});
            if (!frame)
                return std::nullopt;
            size = *frame;
            return web::unpack_frame({data, size}, own);
        } catch (const web::NoFrame&) {
            return std::nullopt;
        }
    }();
    // zstd takes some damaged streams, too.
    if (!own_size)
        return 0;
    ++fuzz::num_accepted;
    fuzz::require(ZSTD_findFrameCompressedSize(data, size) == size, "a frame ends where zstd says");
    const std::size_t expected_size = ZSTD_decompress(expected.data(), Room, data, size);
    if (ZSTD_getErrorCode(expected_size) == ZSTD_error_frameParameter_windowTooLarge)
        return 0;
    fuzz::require(expected_size == *own_size, "zstd unpacks as many bytes");
    own.resize(*own_size);
    fuzz::require(std::equal(own.begin(), own.end(), expected.begin()),
                  "zstd unpacks the same bytes");
    return 0;
}
