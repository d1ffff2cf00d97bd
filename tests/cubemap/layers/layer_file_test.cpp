#include "cubemap/kelvin.h"
#include "cubemap/layers/layer_file.h"
#include "cubemap/layers/presets.h"
#include "cubemap/layers/shapes/sphere_lines.h"
#include "cubemap/resample/save_environment.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class LayerFile : public testing::Test {
protected:
    [[nodiscard]] std::filesystem::path write(const std::string& text,
                                              const std::string& name = "layers.json") const {
        std::filesystem::path path = folder_ / name;
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    /// What is said about a file's content, or nothing if it is read.
    [[nodiscard]] std::string error(const std::string& text) const {
        try {
            (void)load_layers(write(text));
        } catch (const std::runtime_error& refused) {
            return refused.what();
        }
        return {};
    }
    [[nodiscard]] std::string at_line(int line) const {
        return (folder_ / "layers.json").string() + ":" + std::to_string(line) + ": ";
    }
    void write_picture(const std::string& name) const {
        CubeMap map(4, glm::vec3(2.0f, 3.0f, 4.0f));
        save_environment(folder_ / name, map);
    }
    TemporaryFolder folder_;
};

std::string documented_example() {
    std::ifstream page(RELUMINE_DOCS_DIR "/light-layers.md");
    const std::string text((std::istreambuf_iterator<char>(page)),
                           std::istreambuf_iterator<char>());
    const std::string open = "```json\n";
    const std::size_t begin = text.find(open) + open.size();
    return text.substr(begin, text.find("```", begin) - begin);
}

/// One of everything.
LightLayers everything(const std::filesystem::path& folder) {
    LightLayers all;
    all.base = "maps/night.exr";
    all.layers = {{.name = "a",
                   .region = Disc{{0.1, 0.2, 0.3}, 1.0 / 3.0, 0.7},
                   .effect = Emit{{0.1f, 1e-30f, 3e30f}}},
                  {.name = "b \"quoted\" \n",
                   .on = false,
                   .gain_ev = -0.1,
                   .region = Rectangle{{-1, 1e-7, 12345.678}, 179.9, 1e-3, -721.3, 1.0},
                   .effect = Gain{0.3f, {0.7f, 0.0f, 16777217.0f}}},
                  {.name = "c",
                   .region = Lasso{{{1, 0, 0}, {1, 0.1, 0}, {1, 0, 0.1}}, 0.25},
                   .effect = Emit{}},
                  {.name = "d", .region = Stroke{{{0, 1, 0}}, 90.0, 0.0}, .effect = Gain{}},
                  {.name = "e",
                   .region = Rectangle{},
                   .effect = ImagePatch{"patch.exr", load_image_pyramid(folder / "patch.exr"),
                                        ImagePatch::Blend::Add}}};
    all.frames = {
        {-1.5,
         {{"a", "direction", {1, 2, 3}},
          {"a", "radiance", {0.1, 0.2, 0.3}},
          {"b \"quoted\" \n", "on", {1}}}},
        {0.1, {{"c", "points", {1, 0, 0, 1, 0.2, 0, 1, 0, 0.2}}, {"a", "direction", {0, 2, 3}}}}};
    return all;
}

TEST_F(LayerFile, ReadsTheDocumentedExample) {
    const LightLayers layers = load_layers(write(documented_example()));
    ASSERT_EQ(layers.layers.size(), 4u);
    EXPECT_EQ(layers.base, "studio.exr");
    EXPECT_EQ(std::get<Gain>(layers.layers[0].effect).tint, glm::vec3(1.0f, 0.9f, 0.8f));
    EXPECT_EQ(std::get<Disc>(layers.layers[1].region).radius_degrees, 8.0);
    EXPECT_FALSE(layers.layers[2].on);
    EXPECT_EQ(layers.layers[2].gain_ev, -0.5);
    EXPECT_EQ(std::get<Stroke>(layers.layers[3].region).softness, 0.5);
    ASSERT_EQ(layers.frames.size(), 2u);
    EXPECT_EQ(layers.frames[1].changes.size(), 3u);
}

TEST_F(LayerFile, RoundTripsToTheBit) {
    write_picture("patch.exr");
    LightLayers all = everything(folder_ / "");
    all.rotate_degrees = -37.5;
    const std::filesystem::path path = folder_ / "saved.json";
    save_layers(path, all);
    EXPECT_EQ(load_layers(path), all);
    const LightLayers empty;
    save_layers(path, empty);
    EXPECT_EQ(load_layers(path), empty);
}

TEST_F(LayerFile, RefusesEveryTruncation) {
    std::string text = documented_example();
    while (text.back() == '\n')
        text.pop_back();
    ASSERT_EQ(error(text), "");
    for (std::size_t size = 0; size < text.size(); ++size) {
        const std::string cut = text.substr(0, size);
        const std::size_t last = cut.find_last_not_of(" \n");
        const auto end =
            cut.begin() + static_cast<std::ptrdiff_t>(last == std::string::npos ? 0 : last);
        const auto line = static_cast<int>(1 + std::count(cut.begin(), end, '\n'));
        ASSERT_THAT(error(cut), StartsWith(at_line(line) + "expected ")) << size;
    }
}

TEST_F(LayerFile, RefusesWhatIsMalformedAndSaysWhere) {
    // A file whose only layer lies on lines 3 to 6.
    const auto with = [](const std::string& members) {
        return "{\"version\": 1,\n\"layers\": [\n{\"name\": \"a\",\n" + members + "\n}\n]}";
    };
    const std::string disc = "\"type\": \"disc\", \"direction\": [0, 1, 0], \"radius_degrees\": 5";
    const std::string emit = ",\n\"effect\": \"emit\", \"radiance\": [1, 1, 1]";
    ASSERT_EQ(error(with(disc + emit)), "");
    struct Case {
        std::string text;
        int line;
        std::string says;
    };
    const std::vector<Case> cases = {
        {"", 1, "got end of input"},
        {"nul", 1, "got invalid literal"},
        {"[]", 1, "expected a layer file to be an object, got an array"},
        {"{\"version\": 1,\n \"layers\": [],\n}", 3, "expected string literal"},
        {"{\"version\": 1,\n \"layers\": [] x", 2, "expected "},
        {"{\"version\": 1,\n \"layers\": []}\n{", 3, "expected end of input"},
        {"{\"version\": 1, \"layers\": [],\n\"version\": 1}", 2, "a second one"},
        {"{\"version\": 2,\n\"layers\": []}", 1, "expected version 1, got 2"},
        {"{\"version\": \"1\",\n\"layers\": []}", 1, "a number, got \"1\""},
        {"{\n\"layers\": []}", 1, "expected \"version\", got none"},
        {"{\"version\": 1}", 1, "expected \"layers\", got none"},
        {"{\"version\": 1, \"layers\": {}}", 1, "an array, got an object"},
        {"{\"version\": 1, \"layers\": [],\n\"lairs\": 3}", 2, "got \"lairs\""},
        {"{\"version\": 1, \"layers\": [],\n\"base\": 3}", 2, "a string, got 3"},
        {"{\"version\": 1, \"layers\": [\n7]}", 2, "a layer to be an object, got 7"},
        {"{\"version\": 1, \"layers\": \n" + std::string(100, '[') + std::string(100, ']') + "}", 2,
         "levels of nesting"},
        {"{\"version\": 1e999, \"layers\": []}", 1, "number overflow"},
        {std::string("{\"version\": 1, \"layers\": [], \"base\": \"\xff\"}"), 1, "UTF-8"},
        {with(disc), 3, "expected \"effect\", got none"},
        {with(disc + ",\n\"effect\": \"glow\""), 5, "emit, gain, image, got \"glow\""},
        {with(disc + ",\n\"effect\": \"emit\""), 3, "expected \"radiance\", got none"},
        {with(disc + emit + ",\n\"factor\": 2"), 6, "got \"factor\""},
        {with(disc + emit + ",\n\"radius\": 2"), 6, "got \"radius\""},
        {with(disc + emit + ",\n\"on\": 1"), 6, "true or false, got 1"},
        {with(disc + emit + ",\n\"gain_ev\": null"), 6, "a number, got null"},
        {with(disc + emit + ",\n\"gain_ev\": 101"), 3, "from -100 to 100, got 101"},
        {with(disc + emit + ",\n\"softness\": -0.1"), 3, "softness from 0 to 1, got -0.1"},
        {with(disc + ",\n\"effect\": \"emit\",\n\"radiance\": [1, 1]"), 6, "of 3 numbers, got 2"},
        {with(disc + ",\n\"effect\": \"emit\",\n\"radiance\": [1, 1, \"1\"]"), 6,
         "a number, got \"1\""},
        {with(disc + ",\n\"effect\": \"emit\",\n\"radiance\": [1, 1, -1]"), 3,
         "radiance to be finite and at least 0"},
        {with(disc + ",\n\"effect\": \"emit\",\n\"radiance\": [1, 1, 1e39]"), 3,
         "radiance to be finite"},
        {with(disc + ",\n\"effect\": \"image\",\n\"path\": \"none.exr\""), 6, "none.exr"},
        {with(disc + emit + ",\n\"gain_ev\": 1,\n\"exposure\": 1"), 7, "got both"},
        {with(disc + emit + ",\n\"kelvin\": 900"), 3, "kelvin to be 0 or from 1000 to 15000"},
        {with(disc + emit + ",\n\"kelvin\": 15001"), 3, "kelvin from 0 to 15000, got 15001"},
        {with("\"preset\": \"strop\", \"direction\": [0, 1, 0]"), 4, "did you mean strip?"},
        {with("\"preset\": \"strip\",\n\"direction\": [0, 0, 0]"), 5, "direction of finite"},
        {with("\"preset\": \"strip\""), 3, "expected \"direction\", got none"},
        {with("\"preset\": \"strip\", \"direction\": [0, 1, 0],\n\"type\": \"disc\""), 5,
         "got \"type\""},
        {with("\"type\": \"blob\"" + emit), 4, "disc, rectangle, lasso, stroke, got \"blob\""},
        {with("\"type\": \"disc\"" + emit), 3, "expected \"direction\""},
        {with("\"type\": \"disc\", \"direction\": [0, 0, 0], \"radius_degrees\": 5" + emit), 3,
         "direction of finite length"},
        {with("\"type\": \"disc\", \"direction\": [0, 0, 1], \"radius_degrees\": 0" + emit), 3,
         "radius_degrees from 0.0001"},
        {with("\"type\": \"lasso\", \"points\": [[0, 0, 1], [0, 1, 1]]" + emit), 3, "at least 3"},
        {with("\"type\": \"lasso\", \"points\": [\n[0, 0, 1], [0, 1, 1],\n[0, 1]]" + emit), 6,
         "of 3 numbers, got 2"},
    };
    for (const Case& bad : cases) {
        const std::string said = error(bad.text);
        EXPECT_THAT(said, StartsWith(at_line(bad.line))) << bad.text;
        EXPECT_THAT(said, HasSubstr("expected ")) << bad.text;
        EXPECT_THAT(said, HasSubstr(bad.says)) << bad.text;
        EXPECT_EQ(said.find('\n'), std::string::npos);
    }
}

TEST_F(LayerFile, PresetsTakeADirectionAndAnyFieldOfTheirShape) {
    for (const LayerPreset& preset : layer_presets()) {
        const std::string text = fmt::format(
            R"({{"version": 1, "layers": [{{"name": "a", "preset": "{}", "direction": [3, 1, 2],
                 "kelvin": 5600, "exposure": 1.5, "solo": true, "camera": false}}]}})",
            preset.name);
        const LightLayer layer = load_layers(write(text)).layers.at(0);
        EXPECT_EQ(layer.name, "a");
        EXPECT_EQ(layer.kelvin, 5600.0);
        EXPECT_EQ(layer.gain_ev, 1.5);
        EXPECT_TRUE(layer.solo);
        EXPECT_FALSE(layer.camera);
        EXPECT_EQ(layer.effect, preset.layer.effect);
        EXPECT_LT(angle_between(middle(layer.region), {3, 1, 2}), 1e-6);
        save_layers(folder_ / "saved.json", {.layers = {layer}});
        EXPECT_EQ(load_layers(folder_ / "saved.json").layers.at(0), layer);
    }
    const LightLayer wide = load_layers(write(R"({"version": 1, "layers": [{"name": "a",
        "preset": "strip", "direction": [0, 1, 1], "width_degrees": 12}]})"))
                                .layers.at(0);
    EXPECT_EQ(std::get<Rectangle>(wide.region).width_degrees, 12.0);
    EXPECT_EQ(std::get<Rectangle>(wide.region).direction, glm::dvec3(0, 1, 1));
}

TEST_F(LayerFile, ATemperatureIsAColour) {
    const LightLayer layer = load_layers(write(R"({"version": 1, "layers": [{"name": "a",
        "type": "disc", "direction": [0, 1, 1], "radius_degrees": 5, "effect": "emit",
        "kelvin": 3200}], "frames": [{"frame": 0, "layers": {"a": {"exposure": -1}}}]})"))
                                 .layers.at(0);
    EXPECT_EQ(layer.effect, Effect(Emit{}));
    EXPECT_EQ(strength(layer), kelvin_color(3200.0));
}

TEST_F(LayerFile, RefusesDuplicateNames) {
    const std::string layer =
        R"({"name": "a", "type": "stroke", "points": [[0, 0, 1]], "radius_degrees": 1, "effect": "gain"})";
    EXPECT_EQ(error("{\"version\": 1, \"layers\": [\n" + layer + ",\n" + layer + "]}"),
              at_line(3) + "expected layers of different names, got a second \"a\"");
}

TEST_F(LayerFile, RefusesBadKeyFrames) {
    const std::string head = "{\"version\": 1, \"layers\": [{\"name\": \"a\", \"type\": \"lasso\", "
                             "\"points\": [[0,0,1],[0,1,1],[1,0,1]],"
                             "\"effect\": \"gain\"}], \"frames\": [\n";
    ASSERT_EQ(error(head + "{\"frame\": 0, \"layers\": {\"a\": {\"factor\": 1}}}]}"), "");
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"{\"frame\": 0}]}", "expected \"layers\", got none"},
        {"{\"layers\": {}}]}", "expected \"frame\", got none"},
        {"{\"frame\": 0, \"layers\": {\"b\": {}}}]}", "expected the name of a layer, got \"b\""},
        {"{\"frame\": 0, \"layers\": {\"a\": {\"radiance\": [1, 1, 1]}}}]}", "got \"radiance\""},
        {"{\"frame\": 0, \"layers\": {\"a\": {\"factor\": -1}}}]}",
         "factor to be finite and at least 0, got -1"},
        {"{\"frame\": 0, \"layers\": {}}, {\"frame\": 0, \"layers\": {}}]}",
         "expected a frame after 0, got 0"},
        {"{\"frame\": 0, \"layers\": {\"a\": {\"points\": [[0,0,1],[0,1,1],[1,0,1]]}}}, "
         "{\"frame\": 1, "
         "\"layers\": "
         "{\"a\": {\"points\": [[0,0,1],[0,1,1],[1,0,1],[1,1,1]]}}}]}",
         "as many points as at frame 0, 3, got 4"}};
    for (const auto& [text, says] : cases) {
        EXPECT_THAT(error(head + text), StartsWith(at_line(2)));
        EXPECT_THAT(error(head + text), HasSubstr(says));
    }
}

TEST_F(LayerFile, NamesAFileThatIsMissing) {
    EXPECT_THROW((void)load_layers(folder_ / "none.json"), std::runtime_error);
}

TEST_F(LayerFile, SavesNothingThatCouldNotBeRead) {
    const std::filesystem::path path = folder_ / "saved.json";
    const auto refused = [&](const LightLayers& layers) {
        EXPECT_THROW(save_layers(path, layers), std::invalid_argument);
        EXPECT_FALSE(std::filesystem::exists(path));
    };
    LightLayers layers;
    layers.layers = {{.name = "a"}, {.name = "a"}};
    refused(layers);
    layers.layers = {{.name = "a", .region = Disc{.radius_degrees = -1.0}}};
    refused(layers);
    layers.layers = {{.name = "a"}};
    layers.frames = {{0.0, {{"b", "on", {1.0}}}}};
    refused(layers);
    layers.frames = {{0.0, {{"a", "tint", {1.0, 1.0, 1.0}}}}};
    refused(layers);
    layers.frames = {{0.0, {{"a", "direction", {1.0}}}}};
    refused(layers);
    layers.frames = {{1.0, {}}, {1.0, {}}};
    refused(layers);
    layers.layers = {{.name = "\xff"}};
    layers.frames = {};
    refused(layers);
}

TEST(KeyFrames, InterpolateNumbersAndDirections) {
    LightLayers layers;
    layers.layers = {{.name = "a", .region = Disc{.radius_degrees = 3.0}}, {.name = "b"}};
    layers.frames = {
        {0.0,
         {{"a", "direction", {0, 0, 2}}, {"a", "gain_ev", {-1}}, {"a", "radiance", {1, 2, 3}}}},
        {4.0, {{"a", "on", {0}}}},
        {10.0, {{"a", "direction", {1, 0, 0}}, {"a", "radiance", {2, 4, 3}}}},
        {20.0, {{"a", "gain_ev", {3}}, {"a", "on", {1}}}}};
    const auto direction = [&](double frame) {
        return std::get<Disc>(layers_at(layers, frame)[0].region).direction;
    };
    // A third of a quarter turn, at a third of the way from length 2 to 1.
    EXPECT_LT(
        glm::distance(direction(10.0 / 3.0), glm::dvec3(0.5, 0.0, std::sqrt(0.75)) * (5.0 / 3.0)),
        1e-12);
    EXPECT_EQ(direction(-5.0), glm::dvec3(0, 0, 2));
    EXPECT_EQ(direction(0.0), glm::dvec3(0, 0, 2));
    EXPECT_EQ(direction(10.0), glm::dvec3(1, 0, 0));
    EXPECT_EQ(direction(99.0), glm::dvec3(1, 0, 0));
    EXPECT_EQ(layers_at(layers, 5.0)[0].gain_ev, 0.0) << "over the key frames that do not name it";
    EXPECT_EQ(std::get<Emit>(layers_at(layers, 5.0)[0].effect).radiance,
              glm::vec3(1.5f, 3.0f, 3.0f));
    EXPECT_EQ(std::get<Disc>(layers_at(layers, 5.0)[0].region).radius_degrees, 3.0);
    EXPECT_FALSE(layers_at(layers, 4.0)[0].on);
    EXPECT_FALSE(layers_at(layers, 19.9)[0].on);
    EXPECT_TRUE(layers_at(layers, 20.0)[0].on);
    EXPECT_EQ(layers_at(layers, 7.0)[1], layers.layers[1]);
}

TEST(KeyFrames, TurnThroughOppositeDirectionsAndMovePoints) {
    LightLayers layers;
    layers.layers = {{.name = "a"},
                     {.name = "s", .region = Stroke{{{0, 0, 1}, {1, 0, 0}}, 2.0, 0.0}}};
    layers.frames = {{0.0, {{"a", "direction", {0, 1, 0}}, {"s", "points", {0, 0, 1, 1, 0, 0}}}},
                     {2.0, {{"a", "direction", {0, -1, 0}}, {"s", "points", {1, 0, 0, 0, 1, 0}}}}};
    const std::vector<LightLayer> half = layers_at(layers, 1.0);
    EXPECT_NEAR(std::get<Disc>(half[0].region).direction.y, 0.0, 1e-12);
    EXPECT_NEAR(glm::length(std::get<Disc>(half[0].region).direction), 1.0, 1e-12);
    const auto& points = std::get<Stroke>(half[1].region).points;
    EXPECT_LT(glm::distance(points[0], glm::normalize(glm::dvec3(1, 0, 1))), 1e-12);
    EXPECT_LT(glm::distance(points[1], glm::normalize(glm::dvec3(1, 1, 0))), 1e-12);
}

} // namespace
} // namespace relumine::cubemap
