// Parts of a precompute against the whole, which a precompute makes in one piece.
#include "prt/parts/parts.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/output_file.h"
#include "prt/parts/part_file.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

/// Several tiles of 1,024 receivers, the last one not full.
mesh::TriangleMesh several_tiles() {
    return scenes::joined(scenes::floor_grid(60, 4.0f),
                          scenes::icosphere(3, 0.5f, {0.2f, 0.7f, 0.0f}));
}

PrecomputeOptions options_for(const mesh::TriangleMesh& mesh) {
    return {.tolerance = 0.03f, .face_resolution = 64, .bias = automatic_bias(mesh)};
}

std::vector<VisibleCounts> all_parts(const Receivers& receivers, const Transfer& plan,
                                     const Blockers& blockers, const PrecomputeOptions& options,
                                     std::uint32_t count) {
    std::vector<VisibleCounts> parts;
    for (std::uint32_t i = 0; i < count; ++i)
        parts.push_back(part_counts(receivers, plan, blockers, options, {i, count}));
    return parts;
}

TEST(Parts, CountsAreThoseOfAPrecomputeWithTheSameClusters) {
    const mesh::TriangleMesh mesh = several_tiles();
    const RayScene rays(mesh);
    const BeamScene beams(mesh, rays);
    const Receivers receivers = vertex_receivers(mesh);
    const PrecomputeOptions options = options_for(mesh);
    const Transfer whole = precompute(receivers, beams, options);
    ASSERT_GT(whole.counts.num_tiles(), 3u);
    for (const std::uint32_t count : {1u, 2u, 3u, 7u}) {
        Transfer joined = whole;
        joined.counts = joined_counts(whole, all_parts(receivers, whole, beams, options, count));
        expect_same(whole, joined);
    }
    // The other engine, and room for few planes at a time.
    PrecomputeOptions tight = options;
    tight.plane_bytes = 1 << 16;
    Transfer joined = whole;
    joined.counts = joined_counts(whole, all_parts(receivers, whole, rays, tight, 2));
    expect_same(whole, joined);
}

TEST(Parts, SingleTexelsCountByTheirCentre) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const RayScene rays(mesh);
    const Receivers receivers = vertex_receivers(mesh);
    PrecomputeOptions options = options_for(mesh);
    options.tolerance = 0.0f;
    options.face_resolution = 8;
    const Transfer whole = precompute(receivers, rays, options);
    ASSERT_EQ(whole.num_clusters(), 6u * 8 * 8);
    Transfer joined = whole;
    joined.counts = joined_counts(whole, all_parts(receivers, whole, rays, options, 3));
    expect_same(whole, joined);
}

TEST(Parts, AFewReceiversArePlannedByAllOfThem) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const RayScene rays(mesh);
    const Receivers receivers = vertex_receivers(mesh);
    const PrecomputeOptions options = options_for(mesh);
    const Transfer whole = precompute(receivers, rays, options);
    Transfer plan = plan_clusters(receivers, rays, options);
    EXPECT_EQ(plan.counts.counts.size(), 0u);
    plan.counts = joined_counts(plan, all_parts(receivers, plan, rays, options, 1));
    expect_same(whole, plan);
}

TEST(Parts, ASampleChoosesAboutAsManyClusters) {
    // 2,900 blocks: every second one.
    const mesh::TriangleMesh mesh = scenes::joined(scenes::floor_grid(200, 4.0f),
                                                   scenes::icosphere(5, 0.5f, {0.2f, 0.7f, 0.0f}));
    const RayScene rays(mesh);
    const BeamScene beams(mesh, rays);
    const Receivers receivers = vertex_receivers(mesh);
    const PrecomputeOptions options = options_for(mesh);
    PrecomputeStatistics of_plan, of_whole;
    const Transfer plan = plan_clusters(receivers, beams, options, &of_plan);
    const Transfer whole = precompute(receivers, beams, options, &of_whole);
    EXPECT_NEAR(static_cast<double>(plan.num_clusters()), static_cast<double>(whole.num_clusters()),
                0.1 * static_cast<double>(whole.num_clusters()));
    EXPECT_LT(of_plan.num_rays, 0.6 * static_cast<double>(of_whole.num_rays));
    EXPECT_EQ(plan.order, whole.order);
}

TEST(Parts, RefusesPartsThatAreNone) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const RayScene rays(mesh);
    const Receivers receivers = vertex_receivers(mesh);
    const PrecomputeOptions options = options_for(mesh);
    const Transfer plan = plan_clusters(receivers, rays, options);
    const auto work = [&](const Part& part) {
        (void)part_counts(receivers, plan, rays, options, part);
    };
    EXPECT_THROW(work({4, 4}), std::invalid_argument);
    EXPECT_THROW(work({0, 0}), std::invalid_argument);
    EXPECT_THROW(work({0, MaxParts + 1}), std::invalid_argument);
    // A part without tiles is no fault.
    EXPECT_EQ(part_counts(receivers, plan, rays, options, {1, 2}).num_receivers, 0u);
}

class PartFiles : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  testing::UnitTest::GetInstance()->current_test_info()->name();
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        scene_.mesh = several_tiles();
        rays_.emplace(scene_.mesh);
        scene_.receivers = vertex_receivers(scene_.mesh);
        const PrecomputeOptions options = options_for(scene_.mesh);
        scene_.transfer = plan_clusters(scene_.receivers, *rays_, options);
        scene_.settings = {.tolerance = options.tolerance,
                           .min_level = options.min_level,
                           .face_resolution = options.face_resolution,
                           .bias = options.bias};
        save_plan(folder_ / "scene.plan", scene_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path part(std::uint32_t index, std::uint32_t count, const std::string& name,
                  const std::string& of = "scene.plan") const {
        const Plan plan = load_plan(folder_ / of);
        const VisibleCounts counts =
            part_counts(plan.scene.receivers, plan.scene.transfer, *rays_,
                        {.face_resolution = plan.scene.settings.face_resolution,
                         .bias = plan.scene.settings.bias},
                        {index, count});
        save_part(folder_ / name, plan, {index, count}, counts);
        return folder_ / name;
    }

    static void expect_refusal(const std::function<void()>& work, const std::string& text) {
        try {
            work();
            ADD_FAILURE() << "expected a refusal: " << text;
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
        }
    }

    fs::path folder_;
    Scene scene_;
    std::optional<RayScene> rays_;
};

TEST_F(PartFiles, JoinInAnyOrderToTheSameFile) {
    const std::vector<fs::path> one = {part(0, 1, "whole.part")};
    std::vector<fs::path> four;
    for (const std::uint32_t i : {2u, 0u, 3u, 1u})
        four.push_back(part(i, 4, "part." + std::to_string(i)));
    save_scene(folder_ / "one.prt", join_parts(one));
    save_scene(folder_ / "four.prt", join_parts(four));
    EXPECT_EQ(files::read(folder_ / "one.prt"), files::read(folder_ / "four.prt"));
    std::reverse(four.begin(), four.end());
    save_scene(folder_ / "reverse.prt", join_parts(four));
    EXPECT_EQ(files::read(folder_ / "one.prt"), files::read(folder_ / "reverse.prt"));
    const Scene scene = load_scene(folder_ / "one.prt");
    EXPECT_EQ(scene.transfer.num_receivers(), scene_.mesh.num_vertices());
    EXPECT_EQ(scene.settings.bias, scene_.settings.bias);
}

TEST_F(PartFiles, NameWhatIsWrong) {
    const fs::path first = part(0, 2, "first"), second = part(1, 2, "second");
    expect_refusal([&] { (void)join_parts(std::vector{first}); }, "got none that is part 2 of 2");
    expect_refusal(
        [&] {
            (void)join_parts(std::vector{first, second, first});
        },
        "expected every part once, got part 1 of 2 again");
    expect_refusal(
        [&] {
            (void)join_parts(std::vector{first, part(2, 3, "third")});
        },
        "third: expected one of 2 parts");
    expect_refusal(
        [&] {
            (void)join_parts(std::vector{first, folder_ / "scene.plan"});
        },
        "scene.plan: expected a part, got a plan");
    expect_refusal([&] { (void)load_scene(folder_ / "scene.plan"); },
                   "scene.plan: expected a scene, got a plan");
    expect_refusal([&] { (void)load_scene(first); }, "first: expected a scene, got a part");
    expect_refusal([&] { (void)load_plan(first); }, "first: expected a plan, got a part");

    scene_.settings.source = "other";
    save_plan(folder_ / "other.plan", scene_);
    const fs::path foreign = part(1, 2, "foreign", "other.plan");
    expect_refusal(
        [&] {
            (void)join_parts(std::vector{first, foreign});
        },
        "foreign: expected a part of the same plan as");

    std::vector<std::byte> bytes = files::read(second);
    bytes[bytes.size() / 2] ^= std::byte{1};
    files::save_text(second,
                     std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    expect_refusal([&] { (void)join_parts(std::vector{first, second}); }, "second: expected");
}

} // namespace
} // namespace relumine::prt
