#include "prt/memory_estimate.h"

#include <gtest/gtest.h>

#include "prt/visibility/ray_scene.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

constexpr SceneSizes Sizes = {
    .num_vertices = 100000, .num_triangles = 200000, .num_receivers = 100000};

TEST(MemoryEstimate, PeaksGrowWithAllTheyAreMadeOf) {
    EXPECT_GT(
        scene_bytes(Sizes),
        scene_bytes({.num_vertices = 100000, .num_triangles = 200000, .num_receivers = 50000}));
    EXPECT_GT(scene_bytes(Sizes), scene_bytes({.num_vertices = 100000,
                                               .num_triangles = 200000,
                                               .num_receivers = 100000,
                                               .has_beams = false}));
    EXPECT_GT(peak_bytes(Sizes, 2 << 20, 0), peak_bytes(Sizes, 1 << 20, 0));
    EXPECT_GT(peak_bytes(Sizes, 0, 2 << 20), peak_bytes(Sizes, 0, 1 << 20));
    EXPECT_EQ(peak_bytes(Sizes, 0, 0), scene_bytes(Sizes));
}

TEST(MemoryEstimate, TheLargestColumnsFitAndMoreDoNot) {
    EXPECT_EQ(max_column_bytes(Sizes, 1 << 20, scene_bytes(Sizes) / 2), 0u);
    for (const std::uint64_t limit : {300u << 20, 1000u << 20}) {
        const std::uint64_t planes = plane_bytes_within(Sizes, limit);
        const std::uint64_t most = max_column_bytes(Sizes, planes, limit);
        EXPECT_GT(most, 0u);
        EXPECT_LE(peak_bytes(Sizes, planes, most), limit);
        EXPECT_GT(peak_bytes(Sizes, planes, most + 3), limit);
    }
}

TEST(MemoryEstimate, PlanesGetAQuarterOfWhatIsLeft) {
    const std::uint64_t scene = scene_bytes(Sizes);
    EXPECT_EQ(plane_bytes_within(Sizes, scene / 2), std::uint64_t{16} << 20);
    EXPECT_EQ(plane_bytes_within(Sizes, scene + (400u << 20)), std::uint64_t{100} << 20);
    EXPECT_EQ(plane_bytes_within(Sizes, std::uint64_t{1} << 40), PrecomputeOptions{}.plane_bytes);
}

struct MemoryScene {
    mesh::TriangleMesh mesh = scenes::joined(scenes::floor_grid(60, 4.0f),
                                             scenes::icosphere(4, 0.5f, {0.0f, 0.7f, 0.0f}));
    Receivers receivers = vertex_receivers(mesh);
    RayScene rays{mesh};
    PrecomputeOptions options{
        .tolerance = 0.03f, .face_resolution = 256, .bias = automatic_bias(mesh)};
    SceneSizes sizes{.num_vertices = mesh.num_vertices(),
                     .num_triangles = mesh.num_triangles(),
                     .num_receivers = receivers.size()};
};

TEST(MemoryEstimate, ATrialForetellsTheClusters) {
    const MemoryScene scene;
    PrecomputeStatistics statistics;
    static_cast<void>(precompute(scene.receivers, scene.rays, scene.options, {}, &statistics));
    const MemoryEstimate estimate = estimate_memory(scene.sizes, scene.receivers, scene.rays,
                                                    scene.options, std::uint64_t{1} << 40);
    EXPECT_FALSE(estimate.is_at_least);
    EXPECT_GT(2 * estimate.num_clusters, statistics.num_clusters);
    EXPECT_LT(estimate.num_clusters, 2 * statistics.num_clusters);
    EXPECT_GT(2 * estimate.column_bytes, statistics.column_bytes);
    EXPECT_LT(estimate.column_bytes, 2 * statistics.column_bytes);
    EXPECT_EQ(estimate.peak_bytes,
              peak_bytes(scene.sizes, estimate.plane_bytes, estimate.column_bytes));
}

TEST(MemoryEstimate, ATrialStopsWhenTheLimitIsReached) {
    MemoryScene scene;
    scene.options.tolerance = 0.0f; // 400,000 clusters
    const std::uint64_t limit = scene_bytes(scene.sizes) + (4u << 20);
    const MemoryEstimate estimate =
        estimate_memory(scene.sizes, scene.receivers, scene.rays, scene.options, limit);
    EXPECT_TRUE(estimate.is_at_least);
    EXPECT_GT(estimate.peak_bytes, limit);
    EXPECT_LT(estimate.num_clusters, 100000u);
}

TEST(MemoryEstimate, ARunStopsAtItsLimitAndLeavesACheckpoint) {
    const MemoryScene scene;
    PrecomputeStatistics statistics;
    const Transfer expected =
        precompute(scene.receivers, scene.rays, scene.options, {}, &statistics);
    MemoryCheckpoint checkpoint;
    PrecomputeOptions options = scene.options;
    options.max_column_bytes = statistics.column_bytes;
    EXPECT_NO_THROW(static_cast<void>(
        precompute(scene.receivers, scene.rays, options, {.checkpoint = &checkpoint})));
    MemoryCheckpoint half;
    options.max_column_bytes = statistics.column_bytes / 2;
    try {
        static_cast<void>(precompute(scene.receivers, scene.rays, options, {.checkpoint = &half}));
        FAIL() << "it did not stop";
    } catch (const TooLarge& error) {
        EXPECT_GT(error.bytes, options.max_column_bytes);
    }
    options.max_column_bytes = statistics.column_bytes;
    const Transfer resumed =
        precompute(scene.receivers, scene.rays, options, {.checkpoint = &half});
    EXPECT_EQ(resumed.counts.counts, expected.counts.counts);
    EXPECT_EQ(resumed.counts.visible, expected.counts.visible);
}

} // namespace
} // namespace relumine::prt
