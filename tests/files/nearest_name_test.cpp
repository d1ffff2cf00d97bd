#include "files/nearest_name.h"

#include <array>

#include <gtest/gtest.h>

namespace relumine::files {
namespace {

constexpr std::array<std::string_view, 6> Names = {"--exposure", "--eye",    "--engine",
                                                   "--epsilon",  "--rotate", "key light"};

TEST(NearestName, IsFoundForOneSlipOfTheFinger) {
    for (const std::string_view text :
         {"--exposure", "--expsure", "--exposuree", "--exposire", "--exposrue", "-exposure",
          "exposure", "--EXPOSURE", "--expo"})
        EXPECT_EQ(nearest_name(text, Names), "--exposure") << text;
    EXPECT_EQ(nearest_name("--eey", Names), "--eye");
    EXPECT_EQ(nearest_name("keylight", Names), "key light");
}

TEST(NearestName, IsNoneForOtherWords) {
    for (const std::string_view text : {"", "-", "--", "x", "--zzz", "--output", "--e"})
        EXPECT_EQ(nearest_name(text, Names), "") << text;
    EXPECT_EQ(nearest_name(std::string(100'000, 'e'), Names), "");
    EXPECT_EQ(nearest_name("--eye", std::span<const std::string_view>()), "");
}

TEST(NearestName, OfAnotherProgramIsUnderstood) {
    EXPECT_EQ(nearest_name("--rotation", Names), "--rotate");
    EXPECT_EQ(nearest_name("--brightness", Names), "--exposure");
    EXPECT_EQ(nearest_name("--panorama", Names), "") << "no such name here";
    constexpr std::array<std::string_view, 3> Layouts = {"latlong", "cube", "angular"};
    EXPECT_EQ(did_you_mean("equirectangular", Layouts), "; did you mean latlong?");
    EXPECT_EQ(nearest_name("lightprobe", Layouts), "angular");
}

TEST(NearestName, IsAQuestionAtTheEndOfAMessage) {
    EXPECT_EQ(did_you_mean("--rotat", Names), "; did you mean --rotate?");
    EXPECT_EQ(did_you_mean("--zzz", Names), "");
}

} // namespace
} // namespace relumine::files
