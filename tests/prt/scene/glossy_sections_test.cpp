#include "prt/scene/glossy_sections.h"

#include <cstring>
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

#include "prt/parts/part_file.h"
#include "prt/parts/scene_part.h"
#include "prt/scene/scene_file.h"
#include "tests/prt/damaged_file.h"
#include "tests/relight/glossy_scene.h"

namespace relumine::prt {
namespace {

class GlossySections : public testing::Test {
protected:
    GlossySections() {
        const scenes::GlossyScene& glossy = scenes::glossy_scene();
        scene_.mesh = glossy.diffuse.mesh;
        scene_.receivers = glossy.receivers;
        scene_.transfer = glossy.transfer;
        scene_.settings = {.tolerance = glossy.diffuse.options.tolerance,
                           .min_level = glossy.diffuse.options.min_level,
                           .face_resolution = glossy.diffuse.options.face_resolution,
                           .bias = glossy.diffuse.options.bias,
                           .glossy_tolerance = 0.05f};
        scene_.settings.view =
            Camera{.eye = {1.5f, 2.5f, 3.0f}, .target = {0.0f, 0.5f, 0.0f}, .fov_degrees = 30.0f};
        path_ = std::filesystem::path(testing::TempDir()) /
                (std::string("glossy_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name() + ".prt");
        save_scene(path_, scene_);
    }
    ~GlossySections() override { std::filesystem::remove(path_); }

    /// Loading fails after `change` to one section, and says so.
    void refused(const std::string& section,
                 const std::function<void(std::vector<std::byte>&)>& change,
                 const std::string& reason = "") {
        Sections sections = read_sections(path_);
        change(sections.at(section));
        write_sections(path_, to_write(sections));
        scenes::expect_refused(path_, reason.empty() ? section : reason,
                               [&] { static_cast<void>(load_scene(path_)); });
        // As one part of one, too, whose sections come piece by piece.
        scenes::expect_refused(path_, "", [&] { static_cast<void>(load_scene_part(path_, {})); });
        save_scene(path_, scene_);
    }

    Scene scene_;
    std::filesystem::path path_;
};

TEST_F(GlossySections, ComeBackAsTheyWere) {
    const Scene loaded = load_scene(path_);
    ASSERT_TRUE(loaded.transfer.glossy);
    EXPECT_EQ(loaded.transfer.surfaces, scene_.transfer.surfaces);
    EXPECT_EQ(loaded.transfer.glossy->to_eye, scene_.transfer.glossy->to_eye);
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        const LobeCuts& expected = scene_.transfer.glossy->lobes[lobe];
        const LobeCuts& actual = loaded.transfer.glossy->lobes[lobe];
        EXPECT_EQ(actual.begin, expected.begin);
        EXPECT_EQ(actual.cells, expected.cells);
        EXPECT_EQ(actual.scales, expected.scales);
        EXPECT_EQ(actual.values, expected.values);
    }
    EXPECT_EQ(loaded.settings.glossy_tolerance, scene_.settings.glossy_tolerance);
    ASSERT_TRUE(loaded.settings.view);
    EXPECT_EQ(*loaded.settings.view, *scene_.settings.view);
}

TEST_F(GlossySections, DamageIsFound) {
    const auto put = [](std::size_t at, auto value) {
        return [at, value](std::vector<std::byte>& bytes) {
            std::memcpy(bytes.data() + at, &value, sizeof value);
        };
    };
    refused("g_specular_b", put(0, std::uint64_t{1}));
    refused("g_specular_b", put(8, ~std::uint64_t{0}));
    refused("g_spec_grazing_b",
            [](std::vector<std::byte>& bytes) { bytes.resize(bytes.size() - 8); });
    refused("g_specular_v", [](std::vector<std::byte>& bytes) { bytes.pop_back(); });
    refused("g_specular_s", [](std::vector<std::byte>& bytes) { bytes.resize(bytes.size() - 4); });
    // The highest plane of all scales' bytes: exponents that make NaN or infinity.
    refused(
        "g_specular_s",
        [](std::vector<std::byte>& bytes) {
            std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end(),
                      std::byte{0xff});
        },
        "highlights of a transfer within");
    refused("g_diff_grazing_c", [](std::vector<std::byte>& bytes) { bytes.pop_back(); });
    // All differences zero: the same cell again and again; all ones: cells beyond the deepest
    // level.
    refused("g_specular_c", [](std::vector<std::byte>& bytes) {
        std::fill(bytes.begin(), bytes.end(), std::byte{0});
    });
    refused("g_specular_c", [](std::vector<std::byte>& bytes) {
        std::fill(bytes.begin(), bytes.end(), std::byte{0xfe});
    });
}

TEST_F(GlossySections, AnEyeIsNeeded) {
    Sections sections = read_sections(path_);
    sections.erase("r_to_eye");
    write_sections(path_, to_write(sections));
    scenes::expect_refused(path_, "eye", [&] { static_cast<void>(load_scene(path_)); });
}

TEST_F(GlossySections, APlanNeedsAnEyeAndSurfacesToo) {
    scene_.transfer.glossy.reset();
    scene_.transfer.counts = {};
    const auto num_clusters = scene_.transfer.num_clusters();
    save_plan(path_, {.scene = std::move(scene_), .has_clusters = true});
    EXPECT_EQ(load_plan(path_).scene.transfer.num_clusters(), num_clusters);
    const Sections good = read_sections(path_);
    for (const char* name : {"r_to_eye", "r_albedo"}) {
        Sections sections = good;
        sections.erase(name);
        write_sections(path_, to_write(sections));
        scenes::expect_refused(path_, "directions to the eye and surfaces with highlights",
                               [&] { static_cast<void>(load_plan(path_)); });
    }
}

} // namespace
} // namespace relumine::prt
