// Batches and checkpoints of the clustering; what it computes is tested in precompute_test.cpp.
#include "prt/clusters/clustering.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "prt/precompute_context.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

class ClusteringTest : public testing::Test {
protected:
    [[nodiscard]] Transfer transfer(const PrecomputeOptions& options,
                                    PrecomputeStatistics* statistics = nullptr) const {
        return precompute(receivers_, rays_, options,
                          options.checkpoint != nullptr ? context_ : PrecomputeContext{},
                          statistics);
    }
    /// A work with checkpoints; of many small steps, as context_ has it.
    [[nodiscard]] PrecomputeOptions in_steps(MemoryCheckpoint& checkpoint) const {
        PrecomputeOptions options = options_;
        options.checkpoint = &checkpoint;
        return options;
    }

    mesh::TriangleMesh mesh_ = scenes::sphere_and_box_on_floor();
    Receivers receivers_ = vertex_receivers(mesh_);
    RayScene rays_{mesh_};
    PrecomputeOptions options_{
        .tolerance = 0.028f, .face_resolution = 64, .bias = automatic_bias(mesh_)};
    PrecomputeContext context_{.samples_per_step = 64 * 4 * receivers_.size()};
};

TEST_F(ClusteringTest, AnyRoomForPlanesGivesTheSameBits) {
    PrecomputeStatistics plain;
    const Transfer expected = transfer(options_, &plain);
    const std::uint64_t plane = (receivers_.size() + 63) / 64 * 8;
    for (const std::uint64_t num_planes : {0u, 1u, 100u, 300u, 1000u, 3000u, 100000u}) {
        PrecomputeOptions options = options_;
        options.plane_bytes = num_planes * plane;
        PrecomputeStatistics statistics;
        expect_same(transfer(options, &statistics), expected);
        EXPECT_GE(statistics.num_directions, plain.num_directions) << num_planes;
        EXPECT_EQ(statistics.deepest_level, plain.deepest_level);
    }
}

TEST_F(ClusteringTest, GoesOnFromEveryCheckpoint) {
    PrecomputeStatistics plain;
    const Transfer expected = transfer(options_, &plain);
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
    MemoryCheckpoint unused;
    PrecomputeOptions options = in_steps(unused);
    options.checkpoint = &lookout;
    PrecomputeStatistics statistics;
    static_cast<void>(precompute(receivers_, lookout, options, context_, &statistics));
    EXPECT_GT(lookout.num_looks, 15u);
    EXPECT_GT(statistics.num_rays, 4 * *context_.samples_per_step);
    EXPECT_LE(lookout.num_rays, *context_.samples_per_step);
}

TEST_F(ClusteringTest, GoesOnAgainAndAgainWithLittleRoom) {
    const Transfer expected = transfer(options_);
    MemoryCheckpoint checkpoint;
    std::mt19937 random(1);
    std::size_t num_kills = 0;
    for (bool done = false; !done;) {
        PrecomputeOptions options = in_steps(checkpoint);
        options.plane_bytes = 400 * ((receivers_.size() + 63) / 64 * 8);
        checkpoint.saves_to_live = checkpoint.num_saves + 1 + random() % 6;
        checkpoint.every = 1 + random() % 3;
        try {
            expect_same(transfer(options), expected);
            done = true;
        } catch (const Killed&) {
            ++num_kills;
        }
    }
    EXPECT_GT(num_kills, 5u);
}

TEST_F(ClusteringTest, ASaveThatFailsIsMadeUpForByTheNext) {
    const Transfer expected = transfer(options_);
    MemoryCheckpoint checkpoint;
    checkpoint.is_failing = true;
    expect_same(transfer(in_steps(checkpoint)), expected); // a full disk stops no one
    checkpoint.num_saves = 0;
    PrecomputeOptions options = in_steps(checkpoint);
    // Every other save fails; stopped near the end.
    std::atomic<int> num_calls = 0;
    options.on_progress = [&](double fraction) {
        checkpoint.is_failing = ++num_calls % 2 == 0;
        if (fraction > 0.8)
            throw Killed();
    };
    EXPECT_THROW(static_cast<void>(transfer(options)), Killed);
    ASSERT_FALSE(checkpoint.parts["clusters"].records.empty());
    checkpoint.is_failing = false;
    expect_same(transfer(in_steps(checkpoint)), expected);
}

TEST_F(ClusteringTest, LeavesACheckpointWhenItIsStopped) {
    const Transfer expected = transfer(options_);
    for (const bool worth_it : {true, false}) {
        MemoryCheckpoint checkpoint;
        checkpoint.every = 1000000; // never due
        checkpoint.is_worth_it = worth_it;
        PrecomputeOptions options = in_steps(checkpoint);
        std::stop_source stop;
        options.stop = stop.get_token();
        options.on_progress = [&](double fraction) {
            if (fraction > 0.5)
                stop.request_stop();
        };
        EXPECT_THROW(static_cast<void>(transfer(options)), Cancelled);
        EXPECT_EQ(checkpoint.num_saves, worth_it ? 1u : 0u);
        expect_same(transfer(in_steps(checkpoint)), expected);
    }
}

TEST_F(ClusteringTest, LeavesItsResultWhereMoreFollows) {
    MemoryCheckpoint checkpoint;
    checkpoint.every = 1000000;
    PrecomputeOptions options = in_steps(checkpoint);
    static_cast<void>(transfer(options));
    EXPECT_EQ(checkpoint.num_saves, 0u);
    context_.more_follows = true;
    const Transfer expected = transfer(options);
    EXPECT_EQ(checkpoint.num_saves, 1u);
    PrecomputeStatistics statistics;
    expect_same(transfer(options, &statistics), expected);
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
