// Options as data: how values are read and written, and what the tables of all options hold.
#include "relumine/options/option_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumine/in/precompute_table.h"
#include "relumine/relumine.h"
#include "tests/relumine/options/other_value.h"

namespace relumine {
namespace {

TEST(Sides, AreTwoNumbers) {
    EXPECT_EQ(parse_sides("640x480"), std::pair(640u, 480u));
    EXPECT_EQ(parse_sides("1x4294967295"), std::pair(1u, 4294967295u));
    EXPECT_EQ(parse_sides("0x0"), std::pair(0u, 0u));
    for (const char* text : {"", "x", "8", "8x", "x8", "8x8x8", "8X8", "-8x8", "8x-8", "+8x8",
                             " 8x8", "8x8 ", "8 x 8", "8.0x8", "1e2x8", "0x10x8", "4294967296x8"})
        EXPECT_FALSE(parse_sides(text)) << text;
}

TEST(Numbers, AreTheWholeText) {
    EXPECT_EQ(parse_number("1.5"), 1.5);
    EXPECT_EQ(parse_number("-2e3"), -2000.0);
    for (const char* text : {"", "x", "1x", "1 2", "1,5", "0x10", "-0X1p3"})
        EXPECT_FALSE(parse_number(text)) << text;
    EXPECT_EQ(parse_count("0"), 0u);
    EXPECT_EQ(parse_count("4294967295"), 4294967295u);
    for (const char* text : {"", "-1", "+1", "1.0", "4294967296", "0x10", " 1", "1 ", "64x64"})
        EXPECT_FALSE(parse_count(text)) << text;
    EXPECT_THAT(parse_numbers("1,-2.5,3"), testing::Optional(testing::ElementsAre(1, -2.5, 3)));
    for (const char* text : {"", "1,", ",1", "1,x", "1,,2", "1,0x2"})
        EXPECT_FALSE(parse_numbers(text)) << text;
}

TEST(Colors, AreOneNumberOrThree) {
    EXPECT_EQ(ColorText::read("0.5"), glm::vec3(0.5f));
    EXPECT_EQ(ColorText::show(ColorText::read("0.5,0.25,1000000")), "0.5,0.25,1000000");
    EXPECT_EQ(ColorText::show(glm::vec3(2.0f)), "2");
    for (const char* text : {"", "red", "-1", "1,2", "1,2,3,4", "nan", "1e7", "1,2,inf"})
        EXPECT_THROW(static_cast<void>(ColorText::read(text)), std::invalid_argument) << text;
}

TEST(Cameras, AreWrittenAsTheyAreRead) {
    for (const char* text : {"24,20", "-30,10,5.5", "24,20,,60", "24,20,9,60"})
        EXPECT_EQ(CameraText::show(CameraText::read(text)), text);
    for (const char* text : {"", "24", "24,20,", "24,20,,", "24,20,0", "24,91", "40000,0", ",20",
                             "24,20,9,180", "24,20,9,60,1", "a,b", "24,20,-1"})
        EXPECT_THROW(static_cast<void>(CameraText::read(text)), std::invalid_argument) << text;
}

TEST(OptionRow, NamesItselfForEachFace) {
    float value = 0.0f;
    const OptionRow option = row("-f,--floor-fade", value, "");
    EXPECT_THAT(option.names(), testing::ElementsAre("-f", "--floor-fade"));
    EXPECT_EQ(option.long_name(), "--floor-fade");
    EXPECT_EQ(option.key(), "floor_fade");
    const OptionRow argument = row("MESH", value, "");
    EXPECT_TRUE(argument.is_argument());
    EXPECT_EQ(argument.key(), "mesh");
}

TEST(OptionRow, RefusesWhatDoesNotFit) {
    std::uint32_t count = 3;
    const OptionRow option = row("--count", count, "", {.min = 1, .max = 10});
    option.set("10");
    EXPECT_EQ(count, 10u);
    for (const char* text : {"", "0", "11", "-1", "1.5", "x", "nan"})
        EXPECT_THROW(option.set(text), OptionError) << text;
    try {
        option.set("11");
    } catch (const OptionError& error) {
        EXPECT_STREQ(error.what(), "--count: expected 1 to 10, got '11'");
        EXPECT_EQ(error.option, "--count");
        EXPECT_EQ(error.reason, "expected 1 to 10, got '11'");
    }
}

/// All tables, each with a struct of its own.
template<typename Options>
void check_table() {
    Options options;
    const OptionTable table = options_of(options);
    const std::string before = settings_of(table);
    for (const OptionRow& option : table) {
        SCOPED_TRACE(option.name);
        EXPECT_FALSE(option.help.empty());
        EXPECT_EQ(option.initial, option.show());
        const std::string shown = option.show();
        if (!option.is_flag && !shown.empty()) {
            option.set(shown);
            EXPECT_EQ(option.show(), shown) << "what is shown is read as the same";
        }
        // Each option counts, whatever the others are.
        Options changed;
        const OptionTable changed_table = options_of(changed);
        for (const OptionRow& each : changed_table)
            if (each.name == option.name)
                each.set(other_value(each));
        EXPECT_EQ(settings_of(changed_table) != before, option.shapes_frames);
        if (!option.range().empty()) {
            EXPECT_THROW(option.set("-1e30"), OptionError);
            EXPECT_THROW(option.set("1e30"), OptionError);
        }
        if (!option.choices.empty()) {
            EXPECT_THROW(option.set("no such word"), OptionError);
        }
    }
}

TEST(Tables, EachOptionIsReadWrittenAndCounts) {
    check_table<OutputOptions>();
    check_table<EnvironmentOptions>();
    check_table<SurfaceColors>();
    check_table<MeshOptions>();
    check_table<RefineOptions>();
    check_table<PrecomputeOptions>();
}

} // namespace
} // namespace relumine
