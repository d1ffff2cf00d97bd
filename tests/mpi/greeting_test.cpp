#include "mpi/greeting.h"

#include <gtest/gtest.h>

namespace relumine::mpi {
namespace {

TEST(Greeting, OfThisProcessComesBackWhole) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{}, {"precompute", "a mesh.ply", ""}, {""}}) {
        const Greeting own = greeting(arguments);
        EXPECT_FALSE(own.version.empty());
        EXPECT_FALSE(own.instruction_set.empty());
        const Greeting back = unpacked(packed(own));
        EXPECT_EQ(back.version, own.version);
        EXPECT_EQ(back.instruction_set, own.instruction_set);
        EXPECT_EQ(back.arguments, arguments);
        EXPECT_EQ(difference(back, own), "");
    }
    EXPECT_NE(difference(unpacked({}), greeting({})), "");
}

TEST(Greeting, SaysWhatDiffers) {
    const Greeting first{
        .version = "1.2.0", .instruction_set = "AVX2", .arguments = {"precompute", "a.ply"}};
    Greeting other = first;
    EXPECT_EQ(difference(first, other), "");
    other.arguments[1] = "b.ply";
    EXPECT_EQ(difference(first, other), "expected the arguments 'precompute a.ply' of the first "
                                        "process, got 'precompute b.ply'");
    other.instruction_set = "SSE4";
    EXPECT_EQ(difference(first, other),
              "expected the instruction set 'AVX2' of the first process, got 'SSE4'");
    other.version = "1.1.0";
    EXPECT_EQ(difference(first, other),
              "expected the version '1.2.0' of the first process, got '1.1.0'");
}

} // namespace
} // namespace relumine::mpi
