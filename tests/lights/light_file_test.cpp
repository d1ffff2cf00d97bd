#include "lights/light_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <glm/geometric.hpp>

#include "lights/place_lights.h"
#include "tests/lights/test_maps.h"
#include "tests/own_folder.h"

namespace relumine::lights {
namespace {

using testing::HasSubstr;

class LightFile : public tests::FolderTest {
protected:
    [[nodiscard]] std::string message(const std::string& content) const {
        std::ofstream(path_) << content;
        return tests::message_of([&] { (void)load_lights(path_); });
    }
    [[nodiscard]] std::string with_light(const std::string& light) const {
        return message("{\"version\": 1,\n\"lights\": [\n" + light + "\n]}");
    }

    const std::filesystem::path path_ = folder_ / "lights.json";
};

TEST_F(LightFile, ReadsBackBitByBit) {
    LightList list{.lights = place(Method::Importance, wild(64, 32), 50, 7).lights,
                   .environment = "a \"map\".hdr",
                   .method = "importance",
                   .seed = 7};
    list.lights[3].irradiance = {0.1, 1e-300, 1e300};
    list.lights[4].solid_angle = 0.0;
    save_lights(path_, list);
    const LightList back = load_lights(path_);
    EXPECT_EQ(back.environment, list.environment);
    EXPECT_EQ(back.method, list.method);
    EXPECT_EQ(back.seed, list.seed);
    ASSERT_EQ(back.lights.size(), list.lights.size());
    for (std::size_t i = 0; i < list.lights.size(); ++i) {
        EXPECT_EQ(back.lights[i].direction, list.lights[i].direction);
        EXPECT_EQ(back.lights[i].irradiance, list.lights[i].irradiance);
        EXPECT_EQ(back.lights[i].solid_angle, list.lights[i].solid_angle);
    }
}

TEST_F(LightFile, AFileByHandNeedsLittle) {
    EXPECT_EQ(with_light(R"({"direction": [0, 0.7071, 0.7071], "irradiance": [1, 2, 3]})"), "");
    const LightList list = load_lights(path_);
    ASSERT_EQ(list.lights.size(), 1u);
    EXPECT_NEAR(glm::length(list.lights[0].direction), 1.0, 1e-15);
    EXPECT_EQ(list.lights[0].solid_angle, 0.0);
    EXPECT_EQ(list.seed, std::nullopt);
}

TEST_F(LightFile, RefusesWithTheLine) {
    const std::string good = R"({"direction": [0, 1, 0], "irradiance": [1, 2, 3]})";
    EXPECT_THAT(
        with_light(good + ",\n" + R"({"direction": [0, 1, 0], "irradiance": [1, -2, 3]})"),
        HasSubstr(":4: expected irradiance that is finite and not negative, got [1, -2, 3]"));
    EXPECT_THAT(
        with_light(R"({"direction": [0, 1, 0], "irradiance": [1, 2, 3], "color": 1})"),
        HasSubstr(
            ":3: expected in a light only direction, irradiance, solid_angle, got \"color\""));
    EXPECT_THAT(with_light(R"({"direction": [0, 2, 0], "irradiance": [1, 2, 3]})"),
                HasSubstr(":3: expected a direction of length 1, got [0, 2, 0] of length 2"));
    EXPECT_THAT(with_light(R"({"direction": [0, 1], "irradiance": [1, 2, 3]})"),
                HasSubstr(":3: expected \"direction\" of 3 numbers, got 2"));
    EXPECT_THAT(with_light(R"({"direction": [0, 1, 0]})"),
                HasSubstr(":3: expected \"irradiance\", got none"));
    EXPECT_THAT(with_light(R"({"direction": [0, 1, 0], "irradiance": [1, NaN, 3]})"),
                HasSubstr(":3: expected"));
    EXPECT_THAT(with_light(R"({"direction": [0, 1, 0], "irradiance": [1, 1e999, 3]})"),
                HasSubstr(":3: expected"));
    EXPECT_THAT(with_light(R"({"direction": [0, 1, 0], "irradiance": [1, "2", 3]})"),
                HasSubstr(":3: expected"));
    EXPECT_THAT(
        with_light(R"({"direction": [0, 1, 0], "irradiance": [1, 2, 3], "solid_angle": -1})"),
        HasSubstr(":3: expected a solid angle from 0 to 4 pi, got -1"));
    EXPECT_THAT(with_light(""), HasSubstr(":2: expected one light at least, got none"));
    EXPECT_THAT(message("{\"version\": 2, \"lights\": []}"),
                HasSubstr(":1: expected version 1, got 2"));
    EXPECT_THAT(message("{\"lights\": []}"), HasSubstr(":1: expected \"version\", got none"));
    EXPECT_THAT(message("{\"version\": 1}"), HasSubstr(":1: expected \"lights\", got none"));
    EXPECT_THAT(message("{\"version\": 1,\n\"light\": []}"),
                HasSubstr(":2: expected in a light list only version"));
    EXPECT_THAT(message("{\"version\": 1, \"seed\": -1, \"lights\": [" + good + "]}"),
                HasSubstr("\"seed\""));
    EXPECT_THAT(message("[]"), HasSubstr(":1: expected a light list"));
    EXPECT_THAT(message(""), HasSubstr("expected"));
    EXPECT_THAT(message("{\"version\": 1, \"lights\": [" + good), HasSubstr("expected"));
    std::filesystem::remove(path_);
    EXPECT_THROW((void)load_lights(path_), std::runtime_error);
}

TEST_F(LightFile, WritesNothingThatItWouldRefuse) {
    const auto refused = [&](const DistantLight& light) {
        EXPECT_THROW(save_lights(path_, {.lights = {light}}), std::invalid_argument);
        EXPECT_FALSE(std::filesystem::exists(path_));
    };
    refused({.direction = {0.0, 0.5, 0.0}});
    refused({.direction = {std::nan(""), 0.5, 0.0}});
    refused({.irradiance = {0.0, -1.0, 0.0}});
    refused({.irradiance = {0.0, INFINITY, 0.0}});
    refused({.solid_angle = 13.0});
    EXPECT_THROW(save_lights(path_, {}), std::invalid_argument);
    EXPECT_THROW(save_lights(path_, {.lights = {{}}, .seed = ~std::uint64_t{0}}),
                 std::invalid_argument);
    save_lights(path_, {.lights = {{}}, .environment = "a\xff.hdr"});
    EXPECT_EQ(load_lights(path_).environment, "a\ufffd.hdr") << "bytes that JSON cannot hold";
    EXPECT_THROW(save_lights("/no/such/folder/lights.json", {.lights = {{}}}), std::runtime_error);
}

} // namespace
} // namespace relumine::lights
