#include "files/joined.h"

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace relumine::files {
namespace {

TEST(Joined, PutsSeparatorsBetweenWordsOnly) {
    EXPECT_EQ(joined(std::vector<std::string>{"a", "", "c"}, ", "), "a, , c");
    EXPECT_EQ(joined(std::array<const char*, 1>{"one"}, ", "), "one");
    EXPECT_EQ(joined(std::vector<std::string_view>(), ", "), "");
}

} // namespace
} // namespace relumine::files
