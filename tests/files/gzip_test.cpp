#include "files/gzip.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

namespace relumine::files {
namespace {

std::vector<std::byte> unzipped(const std::vector<std::byte>& file, std::size_t size) {
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    std::vector<std::byte> bytes(size + 1);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(file.data()));
    stream.avail_in = static_cast<uInt>(file.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    bytes.resize(stream.total_out);
    inflateEnd(&stream);
    return bytes;
}

TEST(Gzip, IsReadBackByZlib) {
    std::mt19937 random(1);
    for (const std::size_t size : {0u, 1u, 1000u, 300'000u}) {
        std::vector<std::byte> bytes(size);
        for (std::byte& byte : bytes)
            byte = static_cast<std::byte>(random() % 5);
        const std::vector<std::byte> file = gzipped(bytes);
        EXPECT_EQ(unzipped(file, size), bytes);
        if (size > 1000) {
            EXPECT_LT(file.size(), size / 2);
        }
        EXPECT_EQ(gzipped(bytes), file);
    }
}

} // namespace
} // namespace relumine::files
