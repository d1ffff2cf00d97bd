#include "cubemap/split_mix64.h"

#include <array>

#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

// The published first numbers for this seed, as the reference program of S. Vigna prints them.
TEST(SplitMix64, GivesThePublishedNumbers) {
    SplitMix64 random(1234567);
    for (const std::uint64_t expected :
         std::array{6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                    4593380528125082431u, 16408922859458223821u})
        EXPECT_EQ(random.next(), expected);
}

TEST(SplitMix64, SeedsOneStepApartStartOneNumberApart) {
    SplitMix64 first(42), second(42 + SplitMix64::Step);
    static_cast<void>(first.next());
    for (int i = 0; i < 10; ++i)
        EXPECT_EQ(first.next(), second.next());
}

TEST(SplitMix64, NumbersBelowABoundAreAllReached) {
    SplitMix64 random(7);
    std::array<int, 5> found{};
    for (int i = 0; i < 1000; ++i)
        ++found.at(random.below(found.size()));
    for (const int count : found)
        EXPECT_NEAR(count, 200, 60); // 4.7 standard deviations
}

} // namespace
} // namespace relumine::cubemap
