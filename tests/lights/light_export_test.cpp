// Every format read back by its own rules, not by ours: where does the light come from, and how
// strong is it?
#include "lights/light_export.h"

#include <numbers>
#include <regex>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lights/place_lights.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {
namespace {

using testing::HasSubstr;

LightList example() {
    LightList list{.lights = place(Method::MedianCut, wild(64, 32), 12).lights,
                   .environment = "we--ird\"\n\\.hdr",
                   .method = "median-cut"};
    list.lights.push_back({.direction = {0, 1, 0}, .irradiance = {0, 0, 0}});
    list.lights.push_back(
        {.direction = {0, -1, 0}, .irradiance = {1, 0, 0}, .solid_angle = 2.0 * std::numbers::pi});
    list.lights.push_back({.direction = {0, 0, -1}, .irradiance = {0, 1e-7, 0}});
    list.lights.push_back({.direction = {0, 0, 1}, .irradiance = {0, 12345678.9, 2}});
    return list;
}

/// All numbers after each occurrence of a marker, up to the end of its line.
std::vector<std::vector<double>> numbers_after(const std::string& text, const std::string& marker) {
    static const std::regex Number(R"([-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)");
    std::vector<std::vector<double>> result;
    for (std::size_t at = text.find(marker); at != std::string::npos;
         at = text.find(marker, at + 1)) {
        const std::size_t begin = at + marker.size();
        const std::string line = text.substr(begin, text.find('\n', begin) - begin);
        result.emplace_back();
        for (std::sregex_iterator i(line.begin(), line.end(), Number), end; i != end; ++i)
            result.back().push_back(std::stod(i->str()));
    }
    return result;
}

void expect_lights(const std::vector<DistantLight>& got,
                   const std::vector<DistantLight>& expected) {
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
        EXPECT_NEAR(glm::distance(got[i].direction, expected[i].direction), 0.0, 1e-9) << i;
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(got[i].irradiance[channel], expected[i].irradiance[channel],
                        1e-12 * expected[i].irradiance[channel])
                << i;
    }
    // And so the power, to far better than 1e-6.
    EXPECT_NEAR(total_irradiance(got).g, total_irradiance(expected).g,
                1e-9 * total_irradiance(expected).g);
}

TEST(LightExport, Csv) {
    const LightList list = example();
    const std::string text = light_text(list, LightFormat::Csv);
    std::vector<DistantLight> got;
    for (const auto& row : numbers_after(text.substr(text.find("solid_angle\n")), "\n")) {
        if (row.empty())
            continue;
        ASSERT_EQ(row.size(), 7u);
        got.push_back({{row[0], row[1], row[2]}, {row[3], row[4], row[5]}, row[6]});
    }
    expect_lights(got, list.lights);
    EXPECT_EQ(got[1].solid_angle, list.lights[1].solid_angle);
}

TEST(LightExport, PbrtShinesFromFromToTo) {
    const LightList list = example();
    const std::string text = light_text(list, LightFormat::Pbrt);
    std::vector<DistantLight> got;
    for (const auto& n : numbers_after(text, "LightSource \"distant\"")) {
        // "point3 from" [ x y z ] "point3 to" [ 0 0 0 ] "rgb L" [ r g b ]; the 3 of each point3 is
        // a number, too
        ASSERT_EQ(n.size(), 11u);
        const glm::dvec3 from(n[1], n[2], n[3]), to(n[5], n[6], n[7]);
        // +Z is up, as in the pictures for pbrt: its (x, y, z) is our (x, z, -y).
        const glm::dvec3 w = glm::normalize(from - to);
        got.push_back({{w.x, w.z, -w.y}, {n[8], n[9], n[10]}});
    }
    expect_lights(got, list.lights);
}

TEST(LightExport, MitsubaRadiatesAlongDirection) {
    const LightList list = example();
    const std::string text = light_text(list, LightFormat::Mitsuba);
    std::vector<DistantLight> got;
    for (const auto& n : numbers_after(text, "<emitter type=\"directional\">")) {
        ASSERT_EQ(n.size(), 6u);
        got.push_back({-glm::dvec3(n[0], n[1], n[2]), {n[3], n[4], n[5]}});
    }
    expect_lights(got, list.lights);
    // XML comments end at the first double hyphen.
    EXPECT_EQ(text.find("--", 4), text.find("-->"));
    EXPECT_THAT(text, testing::EndsWith("</scene>\n"));
}

TEST(LightExport, UsdShinesAlongMinusZ) {
    const LightList list = example();
    for (const bool soft : {false, true}) {
        const std::string text = light_text(list, LightFormat::Usd, {.soft = soft});
        EXPECT_THAT(text, testing::StartsWith("#usda 1.0\n"));
        EXPECT_THAT(text, HasSubstr("upAxis = \"Y\""));
        const auto colours = numbers_after(text, "color3f inputs:color = ");
        const auto intensities = numbers_after(text, "float inputs:intensity = ");
        const auto angles = numbers_after(text, "float inputs:angle = ");
        const auto matrices = numbers_after(text, "matrix4d xformOp:transform = ");
        ASSERT_EQ(colours.size(), list.lights.size());
        ASSERT_EQ(matrices.size(), list.lights.size());
        EXPECT_EQ(numbers_after(text, "bool inputs:normalize = 1").size(), list.lights.size());
        std::vector<DistantLight> got;
        for (std::size_t i = 0; i < list.lights.size(); ++i) {
            // USD multiplies row vectors: the rows are where the local axes go.
            const auto& m = matrices[i];
            ASSERT_EQ(m.size(), 16u);
            const glm::dvec3 x(m[0], m[1], m[2]), y(m[4], m[5], m[6]), z(m[8], m[9], m[10]);
            EXPECT_NEAR(glm::distance(glm::cross(x, y), z), 0.0, 1e-12);
            EXPECT_NEAR(glm::length(x), 1.0, 1e-12);
            const glm::dvec3 shines = -z;
            got.push_back({-shines, intensities[i][0] *
                                        glm::dvec3(colours[i][0], colours[i][1], colours[i][2])});
        }
        expect_lights(got, list.lights);
        // UsdLux's least angle; intensity is the irradiance at any angle up to 180.
        EXPECT_EQ(angles[0][0] > 0.53, soft);
        for (const auto& angle : angles)
            EXPECT_TRUE(angle[0] >= 0.53 && angle[0] <= 180.0) << angle[0];
        EXPECT_NEAR(angles[13][0], soft ? 180.0 : 0.53, 1e-9); // stands for half the sphere
    }
}

TEST(LightExport, BlenderIsGivenDirectionsWithYUp) {
    const LightList list = example();
    const std::string text = light_text(list, LightFormat::Blender);
    std::vector<DistantLight> got;
    for (const auto& n : numbers_after(text.substr(text.find("LIGHTS = [")), "\n    (")) {
        ASSERT_EQ(n.size(), 7u);
        got.push_back({{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
        EXPECT_EQ(n[6], 0.0);
    }
    expect_lights(got, list.lights);
    EXPECT_THAT(text, HasSubstr("Vector((x, -z, y)).to_track_quat('Z', 'Y')"));
}

TEST(LightExport, GltfShinesAlongMinusZOfTheNode) {
    const LightList list = example();
    for (const double factor : {1.0, 683.0}) {
        const auto root =
            nlohmann::json::parse(light_text(list, LightFormat::Gltf, {.lumens_per_watt = factor}));
        EXPECT_EQ(root["asset"]["version"], "2.0");
        EXPECT_EQ(root["extensionsUsed"], nlohmann::json::array({"KHR_lights_punctual"}));
        std::vector<DistantLight> got;
        for (const auto& index : root["scenes"][0]["nodes"]) {
            const auto& node = root["nodes"][index.get<std::size_t>()];
            const auto& light =
                root["extensions"]["KHR_lights_punctual"]["lights"]
                    [node["extensions"]["KHR_lights_punctual"]["light"].get<std::size_t>()];
            EXPECT_EQ(light["type"], "directional");
            const auto q = node["rotation"].get<std::array<double, 4>>();
            const glm::dvec3 shines = glm::dquat(q[3], q[0], q[1], q[2]) * glm::dvec3(0, 0, -1);
            const auto colour = light["color"].get<std::array<double, 3>>();
            for (const double channel : colour)
                EXPECT_TRUE(channel >= 0.0 && channel <= 1.0);
            got.push_back({-shines, light["intensity"].get<double>() / factor *
                                        glm::dvec3(colour[0], colour[1], colour[2])});
        }
        expect_lights(got, list.lights);
    }
}

TEST(LightExport, EveryFormatSaysUnitAndAxesInItsHead) {
    const LightList list = example();
    for (const LightFormat format : AllLightFormats) {
        EXPECT_EQ(light_format_named(name(format)), format);
        EXPECT_EQ(light_format_of(std::string("a") + std::string(extension(format))), format);
        if (format == LightFormat::Json)
            continue;
        const std::string text = light_text(list, format);
        EXPECT_THAT(text.substr(0, 1000),
                    HasSubstr("16 distant lights of we-_ird???.hdr, median-cut"));
        EXPECT_THAT(text.substr(0, 1000),
                    HasSubstr(format == LightFormat::Pbrt
                                  ? "+Z up, as `relumine env convert --to pbrt`"
                                  : "right-handed, +Y up"));
        EXPECT_THAT(text.substr(0, 1000), HasSubstr("radiance times steradians"));
        EXPECT_THROW((void)light_text({.lights = {{.irradiance = {-1, 0, 0}}}}, format),
                     std::invalid_argument);
    }
    EXPECT_EQ(light_format_named("obj"), std::nullopt);
    EXPECT_EQ(light_format_of("lights.txt"), std::nullopt);
    EXPECT_EQ(light_format_of("lights"), std::nullopt);
}

} // namespace
} // namespace relumine::lights
