#include "files/large_vector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::files {
namespace {

TEST(LargeVector, HoldsTheValueAtAnySize) {
    // Around a page, and around what is taken at once.
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{4097},
                                   std::size_t{4} << 20, (std::size_t{9} << 20) + 13}) {
        const std::vector<std::uint8_t> vector = large_vector<std::uint8_t>(size, 7);
        ASSERT_EQ(vector.size(), size);
        EXPECT_TRUE(std::all_of(vector.begin(), vector.end(), [](auto i) { return i == 7; }));
    }
}

TEST(LargeVector, TakesOnlyWholePagesAndKeepsWhatIsThere) {
    std::vector<std::uint8_t> memory((std::size_t{10} << 20) + 3);
    for (std::size_t i = 0; i < memory.size(); ++i)
        memory[i] = static_cast<std::uint8_t>(i * 31);
    const std::vector<std::uint8_t> before = memory;
    for (const std::size_t begin : {std::size_t{0}, std::size_t{1}, std::size_t{4095}}) {
        const auto part = std::span(memory).subspan(begin);
        take_pages(part.data(), part.size());
    }
    EXPECT_EQ(memory, before);
}

} // namespace
} // namespace relumine::files
