#include "mesh/text_reader.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine::mesh {
namespace {

TEST(TextReader, LinesAndWords) {
    TextReader reader("a  b\t\n\n\r\nc#d\re", '#');
    ASSERT_TRUE(reader.next_line());
    EXPECT_THAT(reader.words(), testing::ElementsAre("a", "b"));
    ASSERT_TRUE(reader.next_line());
    EXPECT_THAT(reader.words(), testing::ElementsAre("c"));
    EXPECT_EQ(reader.next_word("c"), "c");
    EXPECT_FALSE(reader.at_end());
    EXPECT_EQ(reader.next_word("e"), "e");
    EXPECT_TRUE(reader.at_end());
    EXPECT_FALSE(reader.next_line());
    EXPECT_THROW(static_cast<void>(reader.next_word("more")), std::runtime_error);
}

TEST(TextReader, NumbersAreWholeWords) {
    const TextReader reader("");
    EXPECT_EQ(reader.number("+1.5e-3"), 1.5e-3);
    EXPECT_EQ(reader.number("-.5"), -0.5);
    EXPECT_EQ(reader.number("5."), 5.0);
    EXPECT_EQ(reader.number("1e999"), std::numeric_limits<double>::infinity());
    EXPECT_EQ(reader.number("1e-999"), 0.0);
    EXPECT_EQ(reader.number("4.9406564584124654e-324"), std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(reader.integer("-12"), -12);
    for (const char* word : {"", "+", "-", "+-1", "1x", "1,5", "0x10", "1e", "--1", "e5"})
        EXPECT_THROW(static_cast<void>(reader.number(word)), std::runtime_error) << word;
    for (const char* word : {"", "1.0", "1e2", "99999999999999999999"})
        EXPECT_THROW(static_cast<void>(reader.integer(word)), std::runtime_error) << word;
}

TEST(TextReader, MessagesAreOneShortPrintableLine) {
    EXPECT_EQ(excerpt("a\nb\x80"), "'a?b?'");
    EXPECT_LT(excerpt(std::string(1000, 'x')).size(), 50u);
}

} // namespace
} // namespace relumine::mesh
