#include "files/parallel.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::files {
namespace {

/// Pieces of different sizes, which take differently long.
std::vector<std::byte> piece(std::size_t i) {
    return std::vector<std::byte>(1 + i * 7919 % 5000, static_cast<std::byte>(i));
}

TEST(MakeInOrder, TakesAllInTheirOrderOnAnyNumberOfThreads) {
    for (const std::size_t num_threads : {1u, 2u, 0u}) {
        const ThreadLimit limit(num_threads);
        for (const std::size_t count : {0u, 1u, 3u, 500u}) {
            std::size_t num_taken = 0;
            std::atomic<int> num_takers = 0;
            make_in_order(count, piece, [&](std::span<const std::byte> bytes) {
                EXPECT_EQ(++num_takers, 1);
                const std::vector<std::byte> expected = piece(num_taken++);
                ASSERT_TRUE(
                    std::equal(bytes.begin(), bytes.end(), expected.begin(), expected.end()));
                --num_takers;
            });
            EXPECT_EQ(num_taken, count);
        }
    }
}

TEST(MakeInOrder, ThrowsWhatEitherThrows) {
    const auto fail_at_40 = [](std::size_t i) {
        if (i == 40)
            throw std::runtime_error("40");
        return piece(i);
    };
    std::size_t num_taken = 0;
    EXPECT_THROW(make_in_order(100, fail_at_40, [&](std::span<const std::byte>) { ++num_taken; }),
                 std::runtime_error);
    EXPECT_LE(num_taken, 40u);
    num_taken = 0;
    EXPECT_THROW(make_in_order(100, piece,
                               [&](std::span<const std::byte>) {
                                   if (++num_taken == 10)
                                       throw std::invalid_argument("full");
                               }),
                 std::invalid_argument);
    EXPECT_EQ(num_taken, 10u);
}

} // namespace
} // namespace relumine::files
