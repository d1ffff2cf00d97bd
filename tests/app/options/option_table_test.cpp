// Every option of a picture at every face of the program: the command line and the record of
// frames.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "app/command_table.h"
#include "app/program.h"
#include "app/session.h"
#include "relumine/relumine.h"
#include "tests/app/command.h"
#include "tests/relumine/options/other_value.h"

namespace relumine::app {
namespace {

using testing::HasSubstr;

class OptionTables : public AppTest {
protected:
    OptionTables() : line_("relumine", "") {
        add_commands(line_, session_);
        table_ = options_of(options_);
    }

    /// The rows of one command.
    [[nodiscard]] OptionTable rows_of(const std::string& command) const {
        for (const CommandTable& each : line_.table().commands)
            if (each.name == command)
                return each.options;
        ADD_FAILURE() << "no " << command;
        return {};
    }

    Session session_;
    CommandLine line_;
    relumine::OutputOptions options_;
    OptionTable table_;
};

TEST_F(OptionTables, CommandsHaveAllOptionsOfPicturesWithTheirDefaults) {
    for (const char* command : {"relight", "animate", "edit"}) {
        const OptionTable rows = rows_of(command);
        const std::string help = succeed({command, "--help"}).out;
        for (const OptionRow& option : table_) {
            SCOPED_TRACE(fmt::format("{} {}", command, option.name));
            const auto found = std::find_if(rows.begin(), rows.end(), [&](const OptionRow& each) {
                return each.name == option.name;
            });
            ASSERT_NE(found, rows.end());
            EXPECT_EQ(found->initial, option.initial);
            EXPECT_TRUE(found->shapes_frames);
            const std::size_t line = help.find(fmt::format("\n  {} ", option.name));
            const std::size_t flag = help.find(fmt::format("\n  {}\n", option.name));
            ASSERT_NE(std::min(line, flag), std::string::npos);
            if (!option.is_flag && !option.initial.empty()) {
                EXPECT_THAT(help, HasSubstr("=" + option.initial));
            }
        }
    }
}

TEST_F(OptionTables, ACommandTakesEachAndRefusesWhatIsOutOfRange) {
    for (const OptionRow& option : table_) {
        SCOPED_TRACE(option.name);
        // What is wrong comes before the scene that is missing.
        const std::string taken =
            option.is_flag ? option.name : option.name + "=" + other_value(option);
        fail({"relight", "missing.prt", "missing.exr", "-o", "new.png", taken}, {"missing.prt"});
        if (!option.range().empty() || !option.choices.empty())
            misuse(
                {"relight", "missing.prt", "missing.exr", "-o", "new.png", option.name + "=1e30"},
                option.name + ": expected");
    }
}

TEST_F(OptionTables, TheRecordOfFramesHasEach) {
    CommandLine line("tool", "");
    Command command = line.root().add_command("run", "");
    command.add_all(table_);
    const std::string before = command.settings();
    for (const OptionRow& option : table_) {
        options_ = {};
        option.set(other_value(option));
        EXPECT_NE(command.settings(), before) << option.name;
    }
}

TEST_F(OptionTables, OnlyWhatShapesNoFrameIsNotInTheRecord) {
    std::vector<std::string> others;
    for (const OptionRow& option : rows_of("animate"))
        if (!option.shapes_frames)
            others.push_back(option.long_name());
    EXPECT_THAT(others, testing::UnorderedElementsAre(
                            "FRAMES", "--frames", "--vertices", "--measure", "--mp4", "--fps",
                            "--resume", "--json", "--threads", "--quiet", "--verbose"));
}

TEST_F(OptionTables, ThePageNamesEach) {
    std::ifstream file(RELUMINE_SOURCE_DIR "/docs/command-line.md");
    std::stringstream page;
    page << file.rdbuf();
    for (const OptionRow& option : table_)
        EXPECT_THAT(page.str(), HasSubstr("`" + option.name));
}

} // namespace
} // namespace relumine::app
