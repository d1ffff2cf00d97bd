#include "prt/scene/section_group.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "prt/precompute.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "tests/own_folder.h"
#include "tests/prt/made_sections.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

using Kind = mesh::PunctualLight::Kind;

mesh::PunctualLight lamp(const std::string& name, float candela) {
    return {
        .name = name,
        .kind = Kind::Profile,
        .intensity = {1, 2, 3},
        .position = {4, 5, 6},
        .direction = {0, -1, 0},
        .profile = mesh::LightProfile(
            {.vertical = {0, 10, 90}, .horizontal = {0, 180}, .candela = {candela, 2, 3, 4, 5, 6}}),
        .right = {0, 0, 1},
        .up = {1, 0, 0}};
}

Scene scene_with_lamps() {
    Scene scene;
    scene.mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    scene.receivers = vertex_receivers(scene.mesh);
    scene.lamps.lights = {lamp("a", 1.0f), {.name = "point"}, lamp("b", 9.0f), lamp("again", 1.0f)};
    scene.settings = {.tolerance = 0.1f, .min_level = 1, .face_resolution = 8, .bias = 1e-3f};
    scene.transfer =
        prt::precompute(scene.receivers, RayScene(scene.mesh),
                        {.tolerance = 0.1f, .min_level = 1, .face_resolution = 8, .bias = 1e-3f});
    return scene;
}

class LampSectionsTest : public tests::FolderTest {};

TEST_F(LampSectionsTest, ProfilesComeBack) {
    const Scene scene = scene_with_lamps();
    const auto path = folder_ / "a.prt";
    save_scene(path, scene);
    EXPECT_EQ(load_scene(path).lamps, scene.lamps);
}

TEST_F(LampSectionsTest, EachProfileStandsOnce) {
    const Scene scene = scene_with_lamps();
    const Sections sections = scenes::made(sections_without_light("a.prt", scene));
    // Two profiles of 3 + 2 + 6 numbers.
    EXPECT_EQ(sections.at("light_profiles").size(), 2 * 11 * sizeof(float));
}

TEST_F(LampSectionsTest, WhatDoesNotFitIsRefused) {
    const Scene scene = scene_with_lamps();
    const auto refusal = [&](const auto& damage) {
        Sections sections = scenes::made(sections_without_light("a.prt", scene));
        damage(sections);
        Scene read;
        try {
            const SectionReader reader = scenes::reader_of("a.prt", sections);
            for (const SectionGroup* group : {&SettingsSections, &MeshSections, &LampSections})
                group->read(reader, read);
            LampSections.check(SceneCheck("a.prt"), read);
        } catch (const std::runtime_error& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_EQ(refusal([](Sections&) {}), "accepted");
    EXPECT_THAT(refusal([](Sections& sections) { sections["light_profiles"].resize(4); }),
                testing::HasSubstr("JSON with lamps"));
    EXPECT_THAT(refusal([](Sections& sections) { sections["light_profiles"].resize(92); }),
                testing::HasSubstr("JSON with lamps"));
    const auto replaced = [&](const std::string& from, const std::string& to) {
        return refusal([&](Sections& sections) {
            std::vector<std::byte>& bytes = sections["lamps"];
            std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            const std::size_t at = text.find(from);
            ASSERT_NE(at, std::string::npos) << text;
            text.replace(at, from.size(), to);
            bytes = bytes_of(text);
        });
    };
    EXPECT_THAT(replaced("\"profile\": 1", "\"profile\": 2"),
                testing::HasSubstr("JSON with lamps"));
    EXPECT_THAT(replaced("\"profile\": 1", "\"other\": 1"), testing::HasSubstr("JSON with lamps"));
    EXPECT_THAT(replaced("\"kind\": 3", "\"kind\": 4"), testing::HasSubstr("JSON with lamps"));
    EXPECT_THAT(replaced("\"kind\": 0", "\"kind\": 3"), testing::HasSubstr("JSON with lamps"));
}

TEST_F(LampSectionsTest, AxesStandAcross) {
    Scene scene = scene_with_lamps();
    scene.lamps.lights[0].up = {0, 0, 1};
    EXPECT_THROW(save_scene(folder_ / "a.prt", scene), std::runtime_error);
    scene = scene_with_lamps();
    scene.lamps.lights[0].profile = {};
    EXPECT_THROW(save_scene(folder_ / "a.prt", scene), std::runtime_error);
}

} // namespace
} // namespace relumine::prt
