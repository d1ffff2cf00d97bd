// Commands and options as the program reads them, without the program.
#include "app/command_line/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/command_table.h"

namespace relumine::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CommandParser : public testing::Test {
protected:
    CommandParser() : line_("tool", "Does things.", [] { return "1.2"; }) {
        Command root = line_.root();
        Command run = root.add_command("run", "do it");
        run.add(row("IN", text_, "what to read", {.file = true, .required = true}));
        run.add(row("-n,--number", number_, "how many", {.min = 0, .max = 1000}));
        run.add(row("--seed", seed_, "of chance", {.shows_default = false}));
        run.add(row("--scale", scale_, "how large"));
        run.add(row("--bias", bias_, "how far"));
        run.add(row("--list", list_, "several", {.separator = ','}));
        run.add(row("--mode", mode_, "how", {.choices = {"fast", "exact"}}));
        run.add(row("--size", [this](const std::string& text) { size_ = text; }, "how big",
                    {.type = "SIZE", .bare = ""}));
        quiet_option_ = run.add(row("-q,--quiet", quiet_, "say nothing"));
        run.add(
            row("--volume", volume_, "how loud", {.excludes = "--quiet", .shows_default = false}));
        run.add(row("--echo", echo_, "how long", {.needs = "--volume", .shows_default = false}));
        run.on_run([this] { ++num_runs_; });
        Command group = root.add_command("group", "more of them");
        group.add_command("inner", "below").on_run([this] { ++num_inner_; });
    }

    /// The message of a refused line; empty and a failure for one that is accepted.
    std::string refused(const std::vector<std::string>& arguments) {
        try {
            static_cast<void>(line_.run(arguments));
        } catch (const UsageError& error) {
            EXPECT_EQ(num_runs_, 0);
            return error.what();
        }
        ADD_FAILURE() << "accepted";
        return {};
    }

    CommandLine line_;
    std::string text_;
    std::uint32_t number_ = 7;
    std::uint64_t seed_ = 1;
    float scale_ = 0.0135f;
    std::optional<float> bias_;
    std::vector<std::uint64_t> list_;
    std::string mode_ = "fast";
    std::optional<std::string> size_;
    bool quiet_ = false;
    Option quiet_option_;
    double volume_ = 0.0;
    double echo_ = 0.0;
    int num_runs_ = 0;
    int num_inner_ = 0;
};

TEST_F(CommandParser, ReadsValuesOfAllKinds) {
    EXPECT_EQ(
        line_.run({"run", "a.ply", "-n", "12", "--seed", "18446744073709551615", "--scale",
                   "-1.5e2", "--bias", "0.25", "--list", "16,64", "--mode", "exact", "--size=4x3"}),
        "");
    EXPECT_EQ(num_runs_, 1);
    EXPECT_EQ(text_, "a.ply");
    EXPECT_EQ(number_, 12u);
    EXPECT_EQ(seed_, 18446744073709551615u);
    EXPECT_EQ(scale_, -150.0f);
    EXPECT_EQ(bias_, 0.25f);
    EXPECT_THAT(list_, ElementsAre(16u, 64u));
    EXPECT_EQ(mode_, "exact");
    EXPECT_EQ(size_, "4x3");
    EXPECT_FALSE(quiet_);
    EXPECT_FALSE(quiet_option_.is_given());
    EXPECT_EQ(quiet_option_.name(), "--quiet");
    EXPECT_FALSE(Option().is_given());
}

TEST_F(CommandParser, OptionsThatAreNotGivenKeepTheirValues) {
    EXPECT_EQ(line_.run({"run", "--size", "-q", "--", "-a"}), "");
    EXPECT_EQ(text_, "-a");
    EXPECT_EQ(number_, 7u);
    EXPECT_FALSE(bias_);
    EXPECT_EQ(size_, "");
    EXPECT_TRUE(quiet_);
    EXPECT_TRUE(quiet_option_.is_given());
}

TEST_F(CommandParser, RefusesWrongValues) {
    EXPECT_THAT(refused({"run", "a", "-n", "two"}), HasSubstr("--number"));
    EXPECT_THAT(refused({"run", "a", "-n", "two"}), HasSubstr("got 'two'"));
    EXPECT_THAT(refused({"run", "a", "-n", "1001"}), HasSubstr("expected 0 to 1000, got '1001'"));
    EXPECT_THAT(refused({"run", "a", "-n", "-1"}), HasSubstr("got '-1'"));
    EXPECT_THAT(refused({"run", "a", "-n", "1.5"}), HasSubstr("got '1.5'"));
    EXPECT_THAT(refused({"run", "a", "-n", "4294967296"}), HasSubstr("got '4294967296'"));
    EXPECT_THAT(refused({"run", "a", "--seed", "-1"}), HasSubstr("--seed"));
    EXPECT_THAT(refused({"run", "a", "--seed", "18446744073709551616"}), HasSubstr("--seed"));
    EXPECT_THAT(refused({"run", "a", "--scale", "1x"}),
                HasSubstr("--scale: expected a number, got '1x'"));
    EXPECT_THAT(refused({"run", "a", "--list", "16,x"}), HasSubstr("got 'x'"));
    EXPECT_THAT(refused({"run", "a", "--mode", "slow"}), HasSubstr("slow"));
}

TEST_F(CommandParser, RefusesEmptyValues) {
    EXPECT_THAT(refused({"run", ""}), HasSubstr("IN: expected a value, got ''"));
    for (const std::string option : {"--number", "--seed", "--scale", "--bias", "--list", "--mode"})
        EXPECT_EQ(refused({"run", "a", option, ""}), option + ": expected a value, got ''");
}

TEST_F(CommandParser, RefusesWrongLines) {
    EXPECT_THAT(refused({}), HasSubstr("required"));
    EXPECT_THAT(refused({"walk"}), HasSubstr("expected a command, got 'walk'"));
    EXPECT_THAT(refused({"run"}), HasSubstr("IN"));
    EXPECT_THAT(refused({"run", "a", "b"}), HasSubstr("b"));
    EXPECT_THAT(refused({"run", "a", "--nonsense"}), HasSubstr("--nonsense"));
    EXPECT_EQ(refused({"run", "-n", "two", "--", "a"}),
              "--number: expected a whole number of 0 to 4294967295, got 'two'");
    EXPECT_EQ(refused({"run", "--", "-a", "-b"}), "IN: expected no argument more, got '-b'");
    EXPECT_THAT(refused({"run", "a", "-n", "1", "-n", "2"}), HasSubstr("--number"));
    EXPECT_THAT(refused({"run", "a", "-q", "--volume", "2"}), HasSubstr("--volume"));
    EXPECT_THAT(refused({"run", "a", "--echo", "2"}), HasSubstr("--volume"));
    EXPECT_THAT(refused({"group"}), HasSubstr("required"));
}

TEST_F(CommandParser, WorkIsDoneInItsTurn) {
    int before = 0;
    line_.before_run([&] { before = 10 + num_inner_; });
    EXPECT_EQ(line_.run({"group", "inner"}), "");
    EXPECT_EQ(num_inner_, 1);
    EXPECT_EQ(before, 10);
    line_.root().command("run").on_run([] { throw UsageError("--mode", "not today"); });
    EXPECT_EQ(refused({"run", "a"}), "--mode: not today");
    EXPECT_THROW(static_cast<void>(line_.root().command("walk")), std::out_of_range);
}

TEST_F(CommandParser, HelpAndVersionAreText) {
    EXPECT_EQ(line_.run({"--version"}), "tool 1.2\n");
    const std::string help = line_.run({"run", "--help"});
    EXPECT_THAT(help, HasSubstr("Usage: tool run [OPTIONS] IN"));
    EXPECT_THAT(help, HasSubstr("IN FILE REQUIRED"));
    EXPECT_THAT(help, HasSubstr("UINT:0 to 1000=7"));
    EXPECT_THAT(help, HasSubstr("FLOAT=0.0135"));
    EXPECT_EQ(num_runs_, 0);
}

TEST_F(CommandParser, TableHasEverything) {
    const CommandTable table = line_.table();
    EXPECT_EQ(table.name, "tool");
    ASSERT_EQ(table.commands.size(), 2u);
    EXPECT_EQ(table.commands[1].commands.at(0).name, "inner");
    const CommandTable& run = table.commands[0];
    EXPECT_EQ(run.name, "run");
    EXPECT_EQ(run.description, "do it");
    const auto of = [&run](const std::string& name) {
        for (const OptionRow& option : run.options) {
            const std::vector<std::string> names = option.names();
            if (option.name == name || std::find(names.begin(), names.end(), name) != names.end())
                return option;
        }
        ADD_FAILURE() << "no " << name;
        return OptionRow{};
    };
    EXPECT_TRUE(of("IN").required);
    EXPECT_TRUE(of("IN").file);
    EXPECT_THAT(of("-n").names(), ElementsAre("-n", "--number"));
    EXPECT_EQ(of("-n").type, "UINT");
    EXPECT_EQ(of("-n").range(), "0 to 1000");
    EXPECT_EQ(of("-n").shown_default(), "7");
    EXPECT_TRUE(of("--list").repeats);
    EXPECT_THAT(of("--mode").choices, ElementsAre("fast", "exact"));
    EXPECT_TRUE(of("--size").bare);
    EXPECT_TRUE(of("--quiet").is_flag);
    EXPECT_TRUE(of("--help").is_flag);
}

TEST(Numbers, AreTheWholeText) {
    EXPECT_EQ(parse_number("1.5"), 1.5);
    EXPECT_EQ(parse_number("-2e3"), -2000.0);
    for (const char* text : {"", "x", "1x", "1 2", "1,5"})
        EXPECT_FALSE(parse_number(text)) << text;
    EXPECT_EQ(parse_count("0"), 0u);
    EXPECT_EQ(parse_count("4294967295"), 4294967295u);
    for (const char* text : {"", "-1", "+1", "1.0", "4294967296", "0x10", " 1", "1 "})
        EXPECT_FALSE(parse_count(text)) << text;
}

} // namespace
} // namespace relumine::app
