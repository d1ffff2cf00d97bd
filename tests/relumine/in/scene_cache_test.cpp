#include "relumine/in/scene_cache.h"

#include <chrono>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "relumine/light/lit_scene.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

namespace fs = std::filesystem;

class SceneCacheTest : public scenes::InFolder {
protected:
    [[nodiscard]] SceneCache cache() const { return {.folder = file("cache")}; }
    [[nodiscard]] static PrecomputeOptions coarse() { return {.tolerance = scenes::Tolerance}; }
    /// The scene, and whether it was there.
    [[nodiscard]] static bool was_there(const SceneCache& cache, const Mesh& mesh,
                                        const PrecomputeOptions& options) {
        PrecomputeReport report;
        const Scene scene = cached_precompute(cache, mesh, options, {}, &report);
        EXPECT_EQ(scene.transfer.num_receivers(), scene.receivers.size());
        return report.num_vertices == 0;
    }
    [[nodiscard]] static std::size_t num_files(const SceneCache& cache) {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(cache.folder), fs::directory_iterator()));
    }
};

TEST_F(SceneCacheTest, KeepsAScene) {
    const Mesh mesh = scenes::boulder();
    EXPECT_FALSE(was_there(cache(), mesh, coarse()));
    EXPECT_TRUE(was_there(cache(), mesh, coarse()));
    const Scene kept = cached_precompute(cache(), mesh, coarse());
    const Scene made = precompute(mesh, coarse());
    EXPECT_EQ(kept.mesh.positions, made.mesh.positions);
    const auto radiance_of = [](const Scene& scene) {
        LitScene lit(scene);
        lit.light(cubemap::CubeMap(8, glm::vec3(1.0f)));
        return std::vector(lit.radiance().begin(), lit.radiance().end());
    };
    EXPECT_EQ(radiance_of(kept), radiance_of(made));
}

TEST_F(SceneCacheTest, TellsMeshesAndOptionsApart) {
    const Mesh mesh = scenes::boulder();
    const fs::path file = cached_file(cache(), mesh, coarse());
    Mesh moved = mesh;
    moved.geometry.positions.front().x += 0.01f;
    Mesh painted = mesh;
    painted.geometry.colors.assign(mesh.geometry.num_vertices(), glm::vec3(0.5f));
    Mesh named = mesh;
    named.geometry.materials.push_back({.name = "paint"});
    named.geometry.triangle_materials.assign(mesh.geometry.num_triangles(), 0);
    Mesh coloured = named;
    coloured.geometry.materials.back().base_color = glm::vec3(0.3f);
    Mesh open = mesh; // precompute() may add vertices
    open.is_open = true;
    for (const Mesh& other : {moved, painted, named, coloured, open})
        EXPECT_NE(cached_file(cache(), other, coarse()), file);
    EXPECT_NE(cached_file(cache(), named, coarse()), cached_file(cache(), coloured, coarse()));
    EXPECT_NE(cached_file(cache(), mesh, {.tolerance = 0.5f * scenes::Tolerance}), file);
    EXPECT_NE(
        cached_file(cache(), mesh, {.tolerance = scenes::Tolerance, .bounce_tolerance = 0.0f}),
        file);
    EXPECT_EQ(cached_file(cache(), mesh, {.tolerance = scenes::Tolerance, .output = "other.prt"}),
              file);
    EXPECT_THROW(static_cast<void>(cached_file(cache(), mesh, {.surface = everywhere({})})),
                 std::invalid_argument);
}

TEST_F(SceneCacheTest, ForgetsWhatWasUsedLongestAgo) {
    const auto with = [](float tolerance) {
        return PrecomputeOptions{.tolerance = tolerance};
    };
    const Mesh mesh = scenes::boulder();
    SceneCache small = cache();
    EXPECT_FALSE(was_there(small, mesh, with(0.2f)));
    EXPECT_FALSE(was_there(small, mesh, with(0.21f)));
    const fs::path first = cached_file(small, mesh, with(0.2f));
    const fs::path second = cached_file(small, mesh, with(0.21f));
    const auto now = fs::file_time_type::clock::now();
    fs::last_write_time(first, now - std::chrono::hours(2));
    fs::last_write_time(second, now - std::chrono::hours(1));
    EXPECT_TRUE(was_there(small, mesh, with(0.2f))); // used again
    small.max_bytes = 5 * fs::file_size(first) / 2;
    EXPECT_FALSE(was_there(small, mesh, with(0.22f)));
    EXPECT_TRUE(fs::exists(first));
    EXPECT_FALSE(fs::exists(second));
    small.max_bytes = 1; // less than one scene: that of this call stays
    EXPECT_FALSE(was_there(small, mesh, with(0.23f)));
    EXPECT_EQ(num_files(small), 1u);
    EXPECT_TRUE(was_there(small, mesh, with(0.23f)));
}

TEST_F(SceneCacheTest, MakesADamagedSceneAnew) {
    const Mesh mesh = scenes::boulder();
    EXPECT_FALSE(was_there(cache(), mesh, coarse()));
    fs::resize_file(cached_file(cache(), mesh, coarse()), 1000);
    EXPECT_FALSE(was_there(cache(), mesh, coarse()));
    EXPECT_TRUE(was_there(cache(), mesh, coarse()));
}

TEST_F(SceneCacheTest, DoesWithoutAFolder) {
    std::ofstream(file("file")) << "no folder";
    const SceneCache blocked{.folder = file("file") / "cache"};
    std::vector<std::string> warnings;
    const Scene scene = cached_precompute(blocked, scenes::boulder(), coarse(),
                                          {.on_warning = [&](Warning, const std::string& text) {
                                              warnings.push_back(text);
                                          }});
    EXPECT_NE(scene.transfer.num_receivers(), 0u);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings.front().find("not kept"), std::string::npos) << warnings.front();
}

} // namespace
} // namespace relumine
