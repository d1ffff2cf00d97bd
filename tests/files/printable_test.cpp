#include "files/printable.h"

#include <gtest/gtest.h>

namespace relumine::files {
namespace {

TEST(Printable, TextStaysAsItIs) {
    for (const char* text : {"", "key light", "~", "Küche", "\u00a0", "日本語", "\U0001F4A1",
                             "\ud7ff\ue000", "\U0010ffff"})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, NoControlCharactersReachATerminal) {
    EXPECT_EQ(printable("a\x1b[31mb\n\x7f"), "a?[31mb??");
    EXPECT_EQ(printable("\u009b2J"), "??2J") << "control characters beyond ASCII";
    EXPECT_EQ(printable(std::string("a\0b", 3), ' '), "a b");
}

TEST(Printable, WhatIsNoUtf8IsReplacedByteByByte) {
    EXPECT_EQ(printable("a\xff\xfe z"), "a?? z");
    EXPECT_EQ(printable("\x80"), "?");
    EXPECT_EQ(printable("K\xfc"), "K?") << "Latin 1";
    EXPECT_EQ(printable("\xe6\x97"), "??") << "cut off";
    EXPECT_EQ(printable("\xc0\xaf"), "??") << "longer than it need be";
    EXPECT_EQ(printable("\xe0\x80\xaf"), "???");
    EXPECT_EQ(printable("\xf0\x80\x80\xaf"), "????");
    EXPECT_EQ(printable("\xed\xa0\x80"), "???") << "half of a pair";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "????") << "beyond the last character";
    EXPECT_EQ(printable("\xf8\x88\x80\x80\x80"), "?????");
}

} // namespace
} // namespace relumine::files
