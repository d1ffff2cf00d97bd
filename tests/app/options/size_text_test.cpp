#include "app/options/size_text.h"

#include <gtest/gtest.h>

#include "app/command_line/command_line.h"

namespace relumine::app {
namespace {

TEST(SizeText, TwoSidesAreRead) {
    EXPECT_EQ(parse_size_text("640x480"), (SizeText{640, 480}));
    EXPECT_EQ(parse_size_text("1x4294967295"), (SizeText{1, 4294967295u}));
    EXPECT_EQ(parse_size_text("0x0"), (SizeText{0, 0}));
}

TEST(SizeText, AnythingElseIsRefused) {
    for (const char* text : {"", "x", "8", "8x", "x8", "8x8x8", "8X8", "-8x8", "8x-8", "+8x8",
                             " 8x8", "8x8 ", "8 x 8", "8.0x8", "1e2x8", "0x10x8", "4294967296x8"})
        EXPECT_FALSE(parse_size_text(text)) << text;
}

TEST(SizeText, OneSideIsRead) {
    EXPECT_EQ(parse_count("64"), 64u);
    for (const char* text : {"", "64x64", "-1", " 64", "64 ", "4294967296"})
        EXPECT_FALSE(parse_count(text)) << text;
}

} // namespace
} // namespace relumine::app
