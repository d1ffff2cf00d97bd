// Our reader of zstd frames beside libzstd.
#include "web/wasm/zstd_frames.h"

#include <bit>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <zstd.h>

namespace relumine::web {
namespace {

using Data = std::vector<std::uint8_t>;

Data packed(Bytes data, int level, bool has_checksum) {
    const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(),
                                                                          ZSTD_freeCCtx);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, has_checksum ? 1 : 0);
    Data frame(ZSTD_compressBound(data.size()));
    const std::size_t size =
        ZSTD_compress2(context.get(), frame.data(), frame.size(), data.data(), data.size());
    EXPECT_EQ(ZSTD_isError(size), 0u);
    frame.resize(size);
    return frame;
}

/// Kinds that lead to all ways in which blocks are coded.
enum class Kind : std::uint8_t { Noise, FewValues, Repetitions, Runs, Skewed };
constexpr std::array Kinds = {Kind::Noise, Kind::FewValues, Kind::Repetitions, Kind::Runs,
                              Kind::Skewed};

Data made(Kind kind, std::size_t size, std::mt19937& random) {
    Data data(size);
    const auto any = [&] {
        return static_cast<std::uint8_t>(random());
    };
    for (std::size_t i = 0; i < size; ++i)
        switch (kind) {
        case Kind::Noise:
            data[i] = any();
            break;
        case Kind::FewValues:
            data[i] = any() % 7;
            break;
        case Kind::Repetitions:
            data[i] = i > 40 && random() % 9 != 0 ? data[i - 1 - random() % 40] : any();
            break;
        case Kind::Runs:
            data[i] = static_cast<std::uint8_t>(i / 100);
            break;
        case Kind::Skewed:
            data[i] = static_cast<std::uint8_t>(std::countr_zero(random() | 256u) * (i % 4));
            break;
        }
    return data;
}

TEST(ZstdFrames, UnpackWhatZstdPacks) {
    std::mt19937 random(1);
    const std::array<std::size_t, 12> sizes = {0,    1,    2,     63,     64,     255,
                                               1000, 5000, 70000, 131072, 131073, 600000};
    for (const Kind kind : Kinds)
        for (const std::size_t size : sizes)
            for (const int level : {-5, 1, 3, 9, 19}) {
                const Data data = made(kind, size, random);
                const Data frame = packed(data, level, level == 3);
                Data got(size);
                ASSERT_EQ(frame_size(frame), frame.size());
                ASSERT_EQ(content_size(frame), size);
                ASSERT_EQ(unpack_frame(frame, got), size);
                ASSERT_EQ(got, data) << size << " bytes at level " << level;
            }
}

TEST(ZstdFrames, RawAndRepeatedBlocks) {
    // By hand: 3 bytes as they are, then 5 times a byte; content size 8 in one byte.
    const Data frame = {0x28, 0xB5, 0x2F, 0xFD, 0x20, 8, 0x18, 0, 0, 1, 2, 3, 0x2B, 0, 0, 9};
    Data got(8);
    EXPECT_EQ(unpack_frame(frame, got), 8u);
    EXPECT_EQ(got, (Data{1, 2, 3, 9, 9, 9, 9, 9}));
}

TEST(ZstdFrames, SizeIsUnknownUntilTheFrameIsWhole) {
    std::mt19937 random(2);
    Data frame = packed(made(Kind::Skewed, 3000, random), 3, true);
    for (std::size_t size = 0; size < frame.size(); ++size)
        ASSERT_EQ(frame_size(Bytes(frame).first(size)), std::nullopt);
    const std::size_t size = frame.size();
    frame.push_back(7);
    EXPECT_EQ(frame_size(frame), size);
}

TEST(ZstdFrames, WrongBytesAreRefused) {
    std::mt19937 random(3);
    const Data data = made(Kind::Repetitions, 20000, random);
    const Data frame = packed(data, 3, true);
    Data got(data.size());
    const auto is_refused = [&](const Data& bytes, std::size_t room) {
        try {
            static_cast<void>(unpack_frame(bytes, std::span(got).first(room)));
            return got != data;
        } catch (const NoFrame&) {
            return true;
        }
    };
    EXPECT_TRUE(is_refused(frame, data.size() - 1));
    EXPECT_FALSE(is_refused(frame, data.size()));
    // The checksum finds every change of the content; a bit of the header may be unused.
    std::size_t num_refused = 0;
    for (std::size_t at = 0; at < frame.size(); ++at) {
        Data damaged = frame;
        damaged[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
        num_refused += is_refused(damaged, data.size()) ? 1 : 0;
        Data cut = frame;
        cut.resize(at);
        ASSERT_TRUE(is_refused(cut, data.size()));
    }
    EXPECT_GE(num_refused, frame.size() - 8);
}

} // namespace
} // namespace relumine::web
