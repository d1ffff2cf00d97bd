// Parts of a precompute against the whole, which a precompute makes in one piece.
#include "prt/parts/parts.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/output_file.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/parts/part_file.h"
#include "prt/parts/team_checkpoint.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/own_folder.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"
#include "tests/prt/thread_team.h"

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

std::vector<PartLight> all_parts(const Receivers& receivers, const Transfer& plan,
                                 const Blockers& blockers, const PrecomputeOptions& options,
                                 std::uint32_t count) {
    std::vector<PartLight> parts;
    for (std::uint32_t i = 0; i < count; ++i) {
        Alone part({i, count});
        parts.push_back({part_counts(receivers, plan, blockers, options, {.team = part})});
    }
    return parts;
}

/// Gives a transfer the light of all parts.
void join(Transfer& transfer, const Receivers& receivers, std::vector<PartLight> parts) {
    Scene scene;
    scene.receivers = receivers;
    scene.transfer = std::move(transfer);
    join_light(scene, parts);
    transfer = std::move(scene.transfer);
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
        join(joined, receivers, all_parts(receivers, whole, beams, options, count));
        expect_same(whole, joined);
    }
    // The other engine, and room for few planes at a time.
    PrecomputeOptions tight = options;
    tight.plane_bytes = 1 << 16;
    Transfer joined = whole;
    join(joined, receivers, all_parts(receivers, whole, rays, tight, 2));
    expect_same(whole, joined);
}

/// Clusters that processes choose together, each with the figures of its receivers.
TEST(Parts, ProcessesThatShareTheWorkFindTheSame) {
    const mesh::TriangleMesh mesh = several_tiles();
    const RayScene rays(mesh);
    const BeamScene beams(mesh, rays);
    const Receivers receivers = vertex_receivers(mesh);
    PrecomputeOptions options = options_for(mesh);
    PrecomputeStatistics of_whole;
    const Transfer whole = precompute(receivers, beams, options, {}, &of_whole);
    for (const bool is_tight : {false, true}) {
        options.plane_bytes = is_tight ? 1 << 16 : PrecomputeOptions{}.plane_bytes;
        for (const std::uint32_t count : {1u, 2u, 3u, 5u, 8u}) {
            std::vector<PartLight> parts(count);
            Transfer joined;
            ThreadTeam::run(count, [&](Team& team, std::uint32_t index) {
                PrecomputeStatistics statistics;
                Transfer transfer =
                    precompute(receivers, beams, options, {.team = team}, &statistics);
                parts[index].counts = std::move(transfer.counts);
                EXPECT_GE(statistics.num_rays, of_whole.num_rays);
                if (!is_tight) {
                    EXPECT_EQ(statistics.num_rays, of_whole.num_rays);
                }
                if (index == 0)
                    joined = std::move(transfer);
            });
            join(joined, receivers, parts);
            expect_same(whole, joined);
        }
    }
}

TEST(Parts, ProcessesThatShareTheWorkStopTogether) {
    const mesh::TriangleMesh mesh = several_tiles();
    const RayScene rays(mesh);
    const Receivers receivers = vertex_receivers(mesh);
    std::atomic<int> num_cancelled = 0, num_refused = 0;
    ThreadTeam::run(3, [&](Team& team, std::uint32_t index) {
        // One is told to stop, the others are not.
        PrecomputeOptions options = options_for(mesh);
        std::stop_source stop;
        if (index == 1)
            stop.request_stop();
        try {
            (void)precompute(receivers, rays, options, {.team = team, .stop = stop.get_token()});
        } catch (const Cancelled&) {
            ++num_cancelled;
        }
        // One has too little room.
        options.max_column_bytes = index == 2 ? 1000 : options.max_column_bytes;
        if (index != 2)
            options.max_column_bytes = 1u << 30;
        try {
            (void)precompute(receivers, rays, options, {.team = team});
        } catch (const TooLarge&) {
            ++num_refused;
        }
    });
    EXPECT_EQ(num_cancelled, 3);
    EXPECT_EQ(num_refused, 3);
}

/// Highlights of three widths, also receivers without.
void give_highlights(Receivers& receivers) {
    look_from(receivers, {1.5f, 2.5f, 3.0f});
    for (std::size_t i = 0; i < receivers.size(); ++i)
        receivers.surfaces.push_back({.specular = glm::vec3(0.04f, 0.3f, 0.9f),
                                      .highlight = i % 3 == 2 ? Highlight::None : Highlight::Ggx,
                                      .roughness_or_exponent = i % 3 == 0 ? 0.25f : 0.5f});
}

void expect_same_highlights(const Transfer& a, const Transfer& b) {
    ASSERT_TRUE(a.glossy && b.glossy);
    for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
        EXPECT_EQ(a.glossy->lobes[lobe].begin, b.glossy->lobes[lobe].begin);
        EXPECT_EQ(a.glossy->lobes[lobe].cells, b.glossy->lobes[lobe].cells);
        EXPECT_EQ(a.glossy->lobes[lobe].scales, b.glossy->lobes[lobe].scales);
        EXPECT_EQ(a.glossy->lobes[lobe].values, b.glossy->lobes[lobe].values);
    }
}

TEST(Parts, HighlightsAreThoseOfAllReceivers) {
    const mesh::TriangleMesh mesh = several_tiles();
    const RayScene rays(mesh);
    Receivers receivers = vertex_receivers(mesh);
    give_highlights(receivers);
    const PrecomputeOptions options = options_for(mesh);
    const GlossyOptions glossy{.tolerance = 0.2f, .face_resolution = 64, .bias = options.bias};
    Transfer whole = precompute(receivers, rays, options);
    whole.glossy = precompute_glossy(receivers, rays, whole, glossy);
    ASSERT_GT(whole.glossy->lobes[0].num_entries(), 0u);
    for (const std::uint32_t count : {1u, 3u, 8u}) {
        Transfer joined = whole;
        std::vector<PartLight> parts = all_parts(receivers, whole, rays, options, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            Alone part({i, count});
            joined.counts = parts[i].counts;
            parts[i].glossy = precompute_glossy(receivers, rays, joined, glossy, {.team = part});
        }
        join(joined, receivers, parts);
        expect_same(whole, joined);
        expect_same_highlights(whole, joined);
        parts[0].glossy.reset();
        if (count > 1) {
            EXPECT_THROW(join(joined, receivers, parts), std::invalid_argument);
        }
    }
}

/// Gives each run what an earlier one had saved up to some save: a kill between any two saves.
/// Other numbers of processes go on, one without a team, too, and each from what the one before
/// left.
TEST(Parts, AnyNumberOfProcessesGoesOnFromTheCheckpointOfAll) {
    const mesh::TriangleMesh mesh = several_tiles();
    const RayScene rays(mesh);
    Receivers receivers = vertex_receivers(mesh);
    give_highlights(receivers);
    PrecomputeOptions options = options_for(mesh);
    options.plane_bytes = 1 << 18; // several batches
    const GlossyOptions glossy{.tolerance = 0.2f, .face_resolution = 64, .bias = options.bias};
    Transfer whole = precompute(receivers, rays, options);
    whole.glossy = precompute_glossy(receivers, rays, whole, glossy);

    const auto shared = [&](std::uint32_t count, Checkpoint& store, std::uint64_t* num_rays) {
        std::vector<PartLight> parts(count);
        ThreadTeam::run(count, [&](Team& team, std::uint32_t index) {
            TeamCheckpoint of_team(team, index == 0 ? &store : nullptr);
            const Work work{.team = team, .checkpoint = count == 1 ? &store : &of_team};
            PrecomputeStatistics statistics;
            Transfer transfer = precompute(receivers, rays, options, work, &statistics);
            if (index == 0)
                *num_rays = statistics.num_rays;
            parts[index].glossy = precompute_glossy(receivers, rays, transfer, glossy, work);
            parts[index].counts = std::move(transfer.counts);
        });
        Transfer joined = whole;
        join(joined, receivers, parts);
        expect_same(whole, joined);
        expect_same_highlights(whole, joined);
    };
    CheckpointHistory history;
    std::uint64_t num_rays = 0, num_rays_again = 0;
    shared(3, history, &num_rays);
    ASSERT_GT(history.after.size(), 3u);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < history.after.size(); i += 2 + i / 2) {
        CheckpointHistory next;
        next.parts = history.after[i];
        shared(1 + count++ % 4, next, &num_rays_again);
        EXPECT_EQ(num_rays_again, num_rays);
        if (next.after.empty())
            continue;
        MemoryCheckpoint last;
        last.parts = next.after[next.after.size() / 2];
        shared(1 + count++ % 4, last, &num_rays_again);
        EXPECT_EQ(num_rays_again, num_rays);
    }
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
    join(joined, receivers, all_parts(receivers, whole, rays, options, 3));
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
    join(plan, receivers, all_parts(receivers, plan, rays, options, 1));
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
    const Transfer plan = plan_clusters(receivers, beams, options, {}, &of_plan);
    const Transfer whole = precompute(receivers, beams, options, {}, &of_whole);
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
    const auto counts = [&](const Part& part) {
        Alone alone(part);
        return part_counts(receivers, plan, rays, options, {.team = alone});
    };
    EXPECT_THROW((void)counts({4, 4}), std::invalid_argument);
    EXPECT_THROW((void)counts({0, 0}), std::invalid_argument);
    EXPECT_THROW((void)counts({0, MaxParts + 1}), std::invalid_argument);
    // A part without tiles is no fault.
    EXPECT_EQ(counts({1, 2}).num_receivers, 0u);
}

class PartFiles : public tests::FolderTest {
protected:
    void SetUp() override {
        scene_.mesh = several_tiles();
        rays_.emplace(scene_.mesh);
        scene_.receivers = vertex_receivers(scene_.mesh);
        const PrecomputeOptions options = options_for(scene_.mesh);
        scene_.transfer = plan_clusters(scene_.receivers, *rays_, options);
        scene_.settings = {.tolerance = options.tolerance,
                           .min_level = options.min_level,
                           .face_resolution = options.face_resolution,
                           .bias = options.bias};
        save_plan(folder_ / "scene.plan", {.scene = scene_, .has_clusters = true});
    }

    fs::path part(std::uint32_t index, std::uint32_t count, const std::string& name,
                  const std::string& of = "scene.plan") const {
        const Plan plan = load_plan(folder_ / of);
        Alone alone({index, count});
        const VisibleCounts counts =
            part_counts(plan.scene.receivers, plan.scene.transfer, *rays_,
                        {.min_level = plan.scene.settings.min_level,
                         .face_resolution = plan.scene.settings.face_resolution,
                         .bias = plan.scene.settings.bias},
                        {.team = alone});
        save_part(folder_ / name, plan, {index, count}, {counts});
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

    Scene scene_;
    std::optional<RayScene> rays_;
};

TEST_F(PartFiles, JoinInAnyOrderToTheSameFile) {
    const std::vector<fs::path> one = {part(0, 1, "whole.part")};
    std::vector<fs::path> four;
    for (const std::uint32_t i : {2u, 0u, 3u, 1u})
        four.push_back(part(i, 4, "part." + std::to_string(i)));
    join_parts(one, folder_ / "one.prt");
    join_parts(four, folder_ / "four.prt");
    EXPECT_EQ(files::read(folder_ / "one.prt"), files::read(folder_ / "four.prt"));
    std::reverse(four.begin(), four.end());
    join_parts(four, folder_ / "reverse.prt");
    EXPECT_EQ(files::read(folder_ / "one.prt"), files::read(folder_ / "reverse.prt"));
    const Scene scene = load_scene(folder_ / "one.prt");
    EXPECT_EQ(scene.transfer.num_receivers(), scene_.mesh.num_vertices());
    EXPECT_EQ(scene.settings.bias, scene_.settings.bias);
}

TEST_F(PartFiles, NameWhatIsWrong) {
    const fs::path first = part(0, 2, "first"), second = part(1, 2, "second");
    expect_refusal([&] { (void)join_parts(std::vector{first}, folder_ / "joined.prt"); },
                   "got none that is part 2 of 2");
    expect_refusal(
        [&] { (void)join_parts(std::vector{first, second, first}, folder_ / "joined.prt"); },
        "expected every part once, got part 1 of 2 again");
    expect_refusal(
        [&] { (void)join_parts(std::vector{first, part(2, 3, "third")}, folder_ / "joined.prt"); },
        "third: expected one of 2 parts");
    expect_refusal(
        [&] {
            (void)join_parts(std::vector{first, folder_ / "scene.plan"}, folder_ / "joined.prt");
        },
        "scene.plan: expected a part, got a plan");
    expect_refusal([&] { (void)load_scene(folder_ / "scene.plan"); },
                   "scene.plan: expected a scene, got a plan");
    expect_refusal([&] { (void)load_scene(first); }, "first: expected a scene, got a part");
    expect_refusal([&] { (void)load_plan(first); }, "first: expected a plan, got a part");

    scene_.settings.source = "other";
    save_plan(folder_ / "other.plan", {.scene = scene_, .has_clusters = true});
    const fs::path foreign = part(1, 2, "foreign", "other.plan");
    expect_refusal([&] { (void)join_parts(std::vector{first, foreign}, folder_ / "joined.prt"); },
                   "foreign: expected a part of the same plan as");

    std::vector<std::byte> bytes = files::read(second);
    bytes[bytes.size() / 2] ^= std::byte{1};
    files::save_text(second,
                     std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    expect_refusal([&] { (void)join_parts(std::vector{first, second}, folder_ / "joined.prt"); },
                   "second: expected");
    EXPECT_FALSE(fs::exists(folder_ / "joined.prt"));
}

} // namespace
} // namespace relumine::prt
