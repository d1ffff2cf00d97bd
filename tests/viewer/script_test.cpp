#include "viewer/script.h"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Script, ReadsCommandsCommentsAndQuotedNames) {
    const auto commands =
        parse_script("# a comment\n\nwait 3\n  drag_layer \"Key light\" 1,0.5,-2 7 # there\n"
                     "screenshot out.png\r\nquit",
                     "s");
    ASSERT_EQ(commands.size(), 4u);
    EXPECT_EQ(commands[0].name(), "wait");
    EXPECT_EQ(commands[0].num_frames(), 3u);
    EXPECT_EQ(commands[1].name(), "drag_layer");
    EXPECT_EQ(commands[1].text, "Key light");
    EXPECT_THAT(commands[1].numbers, ElementsAre(1.0, 0.5, -2.0, 7.0));
    EXPECT_EQ(commands[1].num_frames(), 7u);
    EXPECT_EQ(commands[1].line, 4u);
    EXPECT_EQ(commands[2].text, "out.png");
    EXPECT_EQ(commands[3].name(), "quit");
}

TEST(Script, RefusesWhatItDoesNotKnowWithTheLine) {
    for (const std::string line :
         {"dance", "wait", "wait x", "wait nan", "undo 1", "drag_layer Key", "drag_layer Key 1,2",
          "drag_layer Key 0,0,0", "drag_layer Key 1,2,3,4", "drag_layer \"Key 1,2,3",
          "click_mesh 1", "screenshot", "screenshot \"\""}) {
        try {
            static_cast<void>(parse_script("wait 1\n" + line, "some.script"));
            ADD_FAILURE() << line;
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr("some.script:2: expected ")) << line;
        }
    }
}

TEST(Script, MissingFileIsNamed) {
    EXPECT_THROW(static_cast<void>(load_script("/nowhere/script")), std::runtime_error);
}

} // namespace
} // namespace relumine::viewer
