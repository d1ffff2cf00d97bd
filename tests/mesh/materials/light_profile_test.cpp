// Profiles of lamps against closed forms, and what their files may be.
#include "mesh/materials/light_profile.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

ReadLightProfile read(const std::string& text) {
    return read_light_profile(std::as_bytes(std::span(text)));
}

/// What a file says besides its angles and intensities.
struct Header {
    std::string first = "IESNA:LM-63-2002\n";
    std::string tilt = "TILT=NONE\n";
    std::string multiplier = "1";
    std::string type = "1";
    std::string factors = "1 1 100";
};

/// A file of angles and of intensities by vertical and horizontal angle.
std::string file_of(const std::vector<double>& vertical, const std::vector<double>& horizontal,
                    const std::function<double(double, double)>& candela,
                    const Header& header = {}) {
    std::ostringstream text;
    text << header.first << "[MANUFAC] nobody\n"
         << header.tilt << "1 -1 " << header.multiplier << ' ' << vertical.size() << ' '
         << horizontal.size() << ' ' << header.type << " 2 0 0 0\n"
         << header.factors << '\n';
    text.precision(9);
    for (const double v : vertical)
        text << v << ' ';
    text << '\n';
    for (const double h : horizontal)
        text << h << ' ';
    for (const double h : horizontal) {
        text << '\n';
        for (const double v : vertical)
            text << candela(v, h) << ' ';
    }
    text << '\n';
    return text.str();
}

std::vector<double> steps(double first, double last, double step) {
    std::vector<double> result;
    for (double angle = first; angle < last + 0.5 * step; angle += step)
        result.push_back(angle);
    return result;
}

double cosine(double v, double) {
    return std::max(std::cos(radians(v)), 0.0);
}

TEST(LightProfile, ConstantOnesHaveFourPiOfTheirCandela) {
    const LightProfile profile =
        read(file_of({0, 180}, {0}, [](double, double) { return 7.0; })).profile;
    for (const double v : {0.0, 33.3, 90.0, 180.0})
        EXPECT_DOUBLE_EQ(profile.at(v, 2.5 * v), 7.0);
    EXPECT_NEAR(profile.flux(), 4.0 * std::numbers::pi * 7.0, 1e-9);
    EXPECT_FLOAT_EQ(profile.largest(), 7.0f);
}

// Lambert's lamp: the flux of a cosine is pi.
TEST(LightProfile, CosinesHavePi) {
    const LightProfile profile = read(file_of(steps(0, 90, 1), {0}, cosine)).profile;
    EXPECT_NEAR(profile.flux(), std::numbers::pi, 1e-4 * std::numbers::pi);
    for (double v = 0.0; v <= 90.0; v += 0.37)
        EXPECT_NEAR(profile.at(v, 10.0 * v), cosine(v, 0.0), 5e-5);
    EXPECT_EQ(profile.at(90.01, 0.0), 0.0) << "no light beyond the last angle";
}

// What at() interpolates, summed over directions of a sphere, is flux().
TEST(LightProfile, FluxIsTheIntegral) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> some(0.0, 100.0);
    for (const auto& horizontal : std::vector<std::vector<double>>{{0},
                                                                   {0, 30, 90},
                                                                   {0, 50, 180},
                                                                   {90, 100, 270},
                                                                   {0, 10, 200, 360},
                                                                   {0, 90, 180, 270}}) {
        const LightProfile profile =
            read(file_of({0, 20, 21, 90, 170}, horizontal, [&](double, double) {
                return some(random);
            })).profile;
        constexpr int Steps = 720;
        double sum = 0.0;
        for (int i = 0; i < Steps; ++i)
            for (int j = 0; j < Steps; ++j)
                sum += profile.at((i + 0.5) * 180.0 / Steps, (j + 0.5) * 360.0 / Steps) *
                       std::sin((i + 0.5) * std::numbers::pi / Steps);
        EXPECT_NEAR(profile.flux(),
                    sum * 2.0 * std::numbers::pi * std::numbers::pi / (Steps * Steps),
                    1e-3 * profile.flux())
            << horizontal.back();
    }
}

/// A table whose candela are the horizontal angle at 90 degrees, without its symmetries.
double angle_at(const std::vector<double>& horizontal, double h) {
    return read(file_of({0, 180}, horizontal, [](double, double angle) { return angle; }))
        .profile.at(90.0, h);
}

TEST(LightProfile, Symmetries) {
    const auto all = [](const std::vector<double>& horizontal) {
        std::vector<double> found;
        for (const double h : {10.0, 100.0, 190.0, 280.0, 350.0, -10.0, 370.0})
            found.push_back(std::round(1e6 * angle_at(horizontal, h)) * 1e-6);
        return found;
    };
    using testing::ElementsAre;
    EXPECT_THAT(all({0}), ElementsAre(0, 0, 0, 0, 0, 0, 0));
    EXPECT_THAT(all({0, 90}), ElementsAre(10, 80, 10, 80, 10, 10, 10));
    EXPECT_THAT(all({0, 180}), ElementsAre(10, 100, 170, 80, 10, 10, 10));
    EXPECT_THAT(all({0, 360}), ElementsAre(10, 100, 190, 280, 350, 350, 10));
    // 10 mirrors 170 at the plane of 90 and 270.
    EXPECT_THAT(all({90, 270}), ElementsAre(170, 100, 190, 260, 190, 190, 170));
    // Without an angle of 360 the circle closes by itself: from 270 to 360 it falls to 0.
    const auto open = all({0, 90, 180, 270});
    EXPECT_THAT(open, ElementsAre(10, 100, 190, 240, 30, 30, 10));
}

TEST(LightProfile, FactorsOfEachYear) {
    const auto factor = [](const std::string& first, const std::string& factors) {
        return read(file_of({0, 90}, {0}, [](double, double) { return 10.0; },
                            {.first = first, .multiplier = "3", .factors = factors}))
                   .profile.at(0.0, 0.0) /
               10.0;
    };
    // Up to 1991 the third number is the ballast-lamp photometric factor.
    EXPECT_NEAR(factor("some lamp\n", "0.5 0.8 60"), 3.0 * 0.5 * 0.8, 1e-6);
    EXPECT_NEAR(factor("IESNA91\n", "0.5 0.8 60"), 3.0 * 0.5 * 0.8, 1e-6);
    // Since 1995 it is for the future; in 2019 it tells how the file was made.
    EXPECT_NEAR(factor("IESNA:LM-63-1995\n", "0.5 1 60"), 3.0 * 0.5, 1e-6);
    EXPECT_NEAR(factor("IESNA:LM-63-2002\n", "0.5 1 60"), 3.0 * 0.5, 1e-6);
    EXPECT_NEAR(factor("IES:LM-63-2019\n", "0.5 1.10100 60"), 3.0 * 0.5, 1e-6);
}

TEST(LightProfile, FilesAreReadAsTheyAreWritten) {
    const std::string plain = file_of({0, 90}, {0, 180}, [](double v, double h) { return v + h; });
    std::string commas = plain, lines = plain, tabs = plain;
    for (std::size_t i = plain.find("TILT=NONE\n") + 10; i < plain.size(); ++i)
        if (plain[i] == ' ') {
            commas[i] = ',';
            lines[i] = '\n';
            tabs[i] = '\t';
        }
    std::string dos;
    for (const char c : plain)
        dos += c == '\n' ? "\r\n" : std::string(1, c);
    for (const std::string& text : {commas, lines, tabs, dos, "\xEF\xBB\xBF" + plain})
        EXPECT_EQ(read(text).profile, read(plain).profile);
    EXPECT_NE(read(plain).profile, LightProfile());
}

TEST(LightProfile, WhatIsLeftOut) {
    using testing::ElementsAre;
    const auto one = [](double, double) {
        return 1.0;
    };
    const auto tilted =
        read(file_of({0, 90}, {0}, one, {.tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n1 .9 .8\n"}));
    EXPECT_THAT(tilted.left_out, ElementsAre("factors of tilted lamps (TILT=INCLUDE)"));
    EXPECT_EQ(tilted.profile, read(file_of({0, 90}, {0}, one)).profile);
    EXPECT_THAT(read(file_of({0, 90}, {0}, one) + "5").left_out,
                ElementsAre("what stands behind the last intensity"));
    const auto negative = read(file_of({0, 90}, {0}, [](double v, double) { return v - 1.0; }));
    EXPECT_THAT(negative.left_out, ElementsAre("1 intensity below 0"));
    EXPECT_EQ(negative.profile.at(0.0, 0.0), 0.0);
}

TEST(LightProfile, OtherFilesAreRefused) {
    const auto one = [](double, double) {
        return 1.0;
    };
    const auto refused = [](const std::string& text, const std::string& reason) {
        expect_refusal([&] { return read(text); }, reason);
    };
    const std::string good = file_of({0, 90}, {0}, one);
    refused("", "expected a line TILT=NONE of LM-63, got none");
    refused("RADIANCE\n", "expected a line TILT=NONE of LM-63, got none");
    refused(std::string("a\0b", 3), "NUL bytes");
    refused(file_of({0, 90}, {0}, one, {.tilt = "TILT=lamp.tlt\n"}),
            "expected TILT=NONE or TILT=INCLUDE in line 3, got 'TILT=lamp.tlt'");
    refused(file_of({-90, 90}, {0}, one, {.type = "2"}),
            "expected photometry of Type C (1) in line 4, got Type B (2)");
    refused(file_of({-90, 90}, {0}, one, {.type = "3"}), "got Type A (3)");
    refused(file_of({0, 90}, {0}, one, {.type = "7"}), "expected photometry of Type C (1)");
    refused(file_of({0, 90}, {0}, one, {.factors = "0 1 5"}), "the ballast factor above 0");
    refused(file_of({0, 90}, {0}, one, {.multiplier = "nan"}), "the candela multiplier");
    refused(file_of({0, 90}, {0}, one, {.multiplier = "1e10"}), "up to 1e+09 candela");
    refused(file_of({0}, {0}, one), "two vertical angles or more");
    refused(file_of({0, 90, 80}, {0}, one), "vertical angles that ascend");
    refused(file_of({0, 190}, {0}, one), "vertical angles up to 180");
    refused(file_of({0, 90}, {0, 100}, one), "got 0 to 100");
    refused(file_of({0, 90}, {10, 180}, one), "got 10 to 180");
    refused(good.substr(0, good.size() - 3), "the end of the file");
    refused("TILT=NONE\n1 1 1 1e9 1e9 1 1 0 0 0 1 1 1", "that fits into the file");
    refused("TILT=NONE\n1 1 1 2.5 1 1 1 0 0 0 1 1 1", "that fits into the file");
    refused("TILT=INCLUDE\n1 1e300", "that fits into the file");
}

TEST(LightProfile, TablesAreChecked) {
    const LightProfileTable good = {
        .vertical = {0, 90}, .horizontal = {0}, .candela = {1.0f, 2.0f}};
    EXPECT_NO_THROW(LightProfile{good});
    LightProfileTable bad = good;
    bad.candela.pop_back();
    EXPECT_THROW(LightProfile{bad}, std::invalid_argument);
    bad = good;
    bad.candela[0] = std::nanf("");
    EXPECT_THROW(LightProfile{bad}, std::invalid_argument);
    bad = good;
    bad.horizontal.clear();
    bad.candela.clear();
    EXPECT_THROW(LightProfile{bad}, std::invalid_argument);
    bad = good;
    bad.vertical[0] = -1.0f;
    EXPECT_THROW(LightProfile{bad}, std::invalid_argument);
}

TEST(LightProfile, NoProfileGivesNoLight) {
    EXPECT_EQ(LightProfile().at(0.0, 0.0), 0.0);
    EXPECT_EQ(LightProfile().flux(), 0.0);
    EXPECT_EQ(LightProfile(), LightProfile());
}

} // namespace
} // namespace relumine::mesh
