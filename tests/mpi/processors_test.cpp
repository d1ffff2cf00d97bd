#include "mpi/processors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine::mpi {
namespace {

using testing::HasSubstr;

TEST(ProcessorsOfProcesses, ComeBackWhole) {
    const Processors own = processors();
    EXPECT_FALSE(own.allowed.empty());
    EXPECT_GE(own.num_online, own.allowed.size());
    const Processors back = unpacked_processors(packed(own));
    EXPECT_EQ(back.host, own.host);
    EXPECT_EQ(back.allowed, own.allowed);
    EXPECT_EQ(back.num_online, own.num_online);
    EXPECT_TRUE(unpacked_processors({}).allowed.empty());
}

TEST(ProcessorsOfProcesses, IdleOnesAreNamedByHost) {
    const Processors a0{.host = "a", .allowed = {0, 1}, .num_online = 4},
        a1{.host = "a", .allowed = {2, 3}, .num_online = 4},
        b{.host = "b", .allowed = {0}, .num_online = 16};
    EXPECT_EQ(idle_processors(std::vector{a0, a1}), "");
    // Both on the same two: mpirun's default for each of several starts.
    EXPECT_THAT(idle_processors(std::vector{a0, a0}), HasSubstr("a: the processes may use 2 of 4"));
    EXPECT_THAT(idle_processors(std::vector{a0, b, a1}),
                HasSubstr("b: the processes may use 1 of 16 processors"));
    EXPECT_EQ(idle_processors({}), "");
}

} // namespace
} // namespace relumine::mpi
