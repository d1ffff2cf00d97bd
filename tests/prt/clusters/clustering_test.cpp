// Batches and checkpoints of the clustering; what it computes is tested in precompute_test.cpp.
#include "prt/clusters/clustering.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "prt/precompute.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

class ClusteringTest : public testing::Test {
protected:
    [[nodiscard]] Transfer transfer(const Work& work = {},
                                    PrecomputeStatistics* statistics = nullptr) const {
        return precompute(receivers_, rays_, options_, work, statistics);
    }
    /// A work with checkpoints, of many small steps.
    [[nodiscard]] Work in_steps(Checkpoint& checkpoint) const {
        return {.checkpoint = &checkpoint, .step_size = 64 * 4 * receivers_.size()};
    }

    mesh::TriangleMesh mesh_ = scenes::sphere_and_box_on_floor();
    Receivers receivers_ = vertex_receivers(mesh_);
    RayScene rays_{mesh_};
    PrecomputeOptions options_{
        .tolerance = 0.028f, .face_resolution = 64, .bias = automatic_bias(mesh_)};
};

TEST_F(ClusteringTest, AnyRoomForPlanesGivesTheSameBits) {
    PrecomputeStatistics plain;
    const Transfer expected = transfer({}, &plain);
    const std::uint64_t plane = (receivers_.size() + 63) / 64 * 8;
    for (const std::uint64_t num_planes : {0u, 1u, 100u, 300u, 1000u, 3000u, 100000u}) {
        options_.plane_bytes = num_planes * plane;
        PrecomputeStatistics statistics;
        expect_same(transfer({}, &statistics), expected);
        EXPECT_GE(statistics.num_directions, plain.num_directions) << num_planes;
        EXPECT_EQ(statistics.deepest_level, plain.deepest_level);
    }
}

TEST_F(ClusteringTest, GoesOnFromEveryCheckpoint) {
    PrecomputeStatistics plain;
    const Transfer expected = transfer({}, &plain);
    MemoryCheckpoint whole;
    expect_same(transfer(in_steps(whole)), expected);
    ASSERT_GT(whole.num_saves, 15u);
    for (std::size_t saves = 0; saves < whole.num_saves; saves += 1 + saves / 5) {
        MemoryCheckpoint checkpoint;
        checkpoint.saves_to_live = saves;
        EXPECT_THROW(static_cast<void>(transfer(in_steps(checkpoint))), Killed);
        checkpoint.saves_to_live = static_cast<std::size_t>(-1);
        PrecomputeStatistics statistics;
        expect_same(transfer(in_steps(checkpoint), &statistics), expected);
        EXPECT_EQ(statistics.num_directions, plain.num_directions) << saves;
        EXPECT_EQ(statistics.num_rays, plain.num_rays) << saves;
        EXPECT_EQ(statistics.deepest_level, plain.deepest_level);
        EXPECT_EQ(checkpoint.num_saves, whole.num_saves) << "nothing was done twice";
    }
}

/// Counts the rays between two looks at the checkpoint.
class Lookout final : public Blockers, public Checkpoint {
public:
    explicit Lookout(const Blockers& blockers) : blockers_(blockers) {}
    /// At most, between two looks
    std::uint64_t num_rays = 0;
    std::size_t num_looks = 0;

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override {
        since_ += static_cast<std::uint64_t>(std::popcount(active));
        return blockers_.occluded(origin, directions, active);
    }
    [[nodiscard]] Saved load(const std::string&, bool) override { return {}; }
    [[nodiscard]] bool is_due() override {
        ++num_looks;
        num_rays = std::max(num_rays, since_.exchange(0));
        return false;
    }
    [[nodiscard]] bool is_worthwhile() override { return false; }
    [[nodiscard]] bool save(const std::string&, std::span<const std::byte>,
                            std::span<const std::byte>) override {
        return true;
    }

private:
    const Blockers& blockers_;
    mutable std::atomic<std::uint64_t> since_ = 0;
};

// No more is lost than what a checkpoint's interval and one step hold.
TEST_F(ClusteringTest, LooksAtTheCheckpointAfterEveryStep) {
    Lookout lookout(rays_);
    const Work work = in_steps(lookout);
    PrecomputeStatistics statistics;
    static_cast<void>(precompute(receivers_, lookout, options_, work, &statistics));
    EXPECT_GT(lookout.num_looks, 15u);
    EXPECT_GT(statistics.num_rays, 4 * *work.step_size);
    EXPECT_LE(lookout.num_rays, *work.step_size);
}

TEST_F(ClusteringTest, GoesOnAgainAndAgainWithLittleRoom) {
    const Transfer expected = transfer();
    MemoryCheckpoint checkpoint;
    std::mt19937 random(1);
    std::size_t num_kills = 0;
    options_.plane_bytes = 400 * ((receivers_.size() + 63) / 64 * 8);
    for (bool done = false; !done;) {
        checkpoint.saves_to_live = checkpoint.num_saves + 1 + random() % 6;
        checkpoint.every = 1 + random() % 3;
        try {
            expect_same(transfer(in_steps(checkpoint)), expected);
            done = true;
        } catch (const Killed&) {
            ++num_kills;
        }
    }
    EXPECT_GT(num_kills, 5u);
}

TEST_F(ClusteringTest, ASaveThatFailsIsMadeUpForByTheNext) {
    const Transfer expected = transfer();
    MemoryCheckpoint checkpoint;
    checkpoint.is_failing = true;
    expect_same(transfer(in_steps(checkpoint)), expected); // a full disk stops no one
    checkpoint.num_saves = 0;
    Work work = in_steps(checkpoint);
    // Every other save fails; stopped near the end.
    std::atomic<int> num_calls = 0;
    work.on_progress = [&](double fraction) {
        checkpoint.is_failing = ++num_calls % 2 == 0;
        if (fraction > 0.8)
            throw Killed();
    };
    EXPECT_THROW(static_cast<void>(transfer(work)), Killed);
    ASSERT_FALSE(checkpoint.parts["clusters"].records.empty());
    checkpoint.is_failing = false;
    expect_same(transfer(in_steps(checkpoint)), expected);
}

TEST_F(ClusteringTest, LeavesACheckpointWhenItIsStopped) {
    const Transfer expected = transfer();
    for (const bool worth_it : {true, false}) {
        MemoryCheckpoint checkpoint;
        checkpoint.every = 1000000; // never due
        checkpoint.is_worth_it = worth_it;
        Work work = in_steps(checkpoint);
        std::stop_source stop;
        work.stop = stop.get_token();
        work.on_progress = [&](double fraction) {
            if (fraction > 0.5)
                stop.request_stop();
        };
        EXPECT_THROW(static_cast<void>(transfer(work)), Cancelled);
        EXPECT_EQ(checkpoint.num_saves, worth_it ? 1u : 0u);
        expect_same(transfer(in_steps(checkpoint)), expected);
    }
}

TEST_F(ClusteringTest, LeavesItsResultWhereMoreFollows) {
    MemoryCheckpoint checkpoint;
    checkpoint.every = 1000000;
    Work work = in_steps(checkpoint);
    static_cast<void>(transfer(work));
    EXPECT_EQ(checkpoint.num_saves, 0u);
    work.more_follows = true;
    const Transfer expected = transfer(work);
    EXPECT_EQ(checkpoint.num_saves, 1u);
    PrecomputeStatistics statistics;
    expect_same(transfer(work, &statistics), expected);
    EXPECT_EQ(checkpoint.num_saves, 1u) << "all of it was there";
}

TEST_F(ClusteringTest, RefusesWhatIsNoState) {
    MemoryCheckpoint checkpoint;
    checkpoint.saves_to_live = 14;
    EXPECT_THROW(static_cast<void>(transfer(in_steps(checkpoint))), Killed);
    const auto parts = checkpoint.parts;
    const auto refuse = [&] {
        EXPECT_THROW(static_cast<void>(transfer(in_steps(checkpoint))), std::runtime_error);
        checkpoint.parts = parts;
    };
    std::vector<std::byte>& state = checkpoint.parts["clusters"].state;
    state.resize(state.size() / 2);
    refuse();
    state.push_back(std::byte{0});
    refuse();
    state.assign(8, std::byte{0});
    refuse();
    ASSERT_FALSE(checkpoint.parts["clusters"].records.empty());
    checkpoint.parts["clusters"].records.pop_back(); // cells are missing
    refuse();
    auto& records = checkpoint.parts["clusters"].records;
    records.push_back(records.back()); // cells are there twice
    refuse();
}

} // namespace
} // namespace relumine::prt
