#include "prt/clusters/coarsening.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "prt/precompute.h"
#include "prt/receivers/point_receivers.h"
#include "prt/transfer/cell_index.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/same_transfer.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

constexpr std::uint32_t Resolution = 512;

class CoarseningTest : public testing::Test {
protected:
    [[nodiscard]] Transfer fresh(float tolerance, const Blockers& blockers) const {
        return precompute(
            receivers_, blockers,
            {.tolerance = tolerance, .face_resolution = Resolution, .bias = automatic_bias(mesh_)});
    }
    [[nodiscard]] static CoarsenOptions to(float tolerance) {
        return {.tolerance = tolerance, .face_resolution = Resolution};
    }

    mesh::TriangleMesh mesh_ = scenes::sphere_and_box_on_floor();
    Receivers receivers_ = vertex_receivers(mesh_);
    RayScene rays_{mesh_};
};

TEST_F(CoarseningTest, GivesTheFreshTreeWhereNothingBlocks) {
    // Without shadows the counts say all of the nine samples.
    const scenes::AnalyticBlockers nothing = scenes::no_blockers();
    const Transfer fine = fresh(0.004f, nothing);
    for (const float tolerance : {0.01f, 0.02f}) {
        const Transfer expected = fresh(tolerance, nothing);
        ASSERT_LT(expected.num_clusters(), fine.num_clusters());
        const Transfer coarse = coarsened(fine, to(tolerance));
        EXPECT_EQ(coarse.quadtree.split_flags(), expected.quadtree.split_flags());
        EXPECT_EQ(coarse.order, expected.order);
        EXPECT_EQ(coarse.normals, expected.normals);
    }
}

TEST_F(CoarseningTest, GivesTheFreshTreeOfPointsInTheOpen) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 64; ++i)
        points.emplace_back(0.01f * static_cast<float>(i), 0.2f, 0.0f);
    receivers_ = point_receivers(points, mesh_, rays_);
    const scenes::AnalyticBlockers nothing = scenes::no_blockers();
    EXPECT_TRUE(coarsened(fresh(0.02f, nothing), to(0.1f)).num_points);
    EXPECT_EQ(coarsened(fresh(0.02f, nothing), to(0.1f)).num_clusters(), 6u * 64u);
    const Transfer fine = fresh(0.05f, rays_);
    const Transfer coarse = coarsened(fine, to(0.2f));
    EXPECT_LT(coarse.num_clusters(), fine.num_clusters());
    // The visible part of each whole face stays as it was.
    for (std::size_t place = 0; place < points.size(); ++place) {
        const auto seen = [place](const Transfer& transfer) {
            double sum = 0.0;
            for (std::uint32_t leaf = 0; leaf < transfer.num_clusters(); ++leaf) {
                const double size = transfer.quadtree.leaves()[leaf].size();
                sum += size * size * transfer.counts.count(place, leaf);
            }
            return sum / (16.0 * 6.0);
        };
        EXPECT_NEAR(seen(coarse), seen(fine), 0.01);
    }
}

/// The count of a joined cluster, from the pairs one by one.
int plain_count(const Transfer& fine, std::size_t place, const Cell& cell) {
    double seen = 0.0, above = 0.0;
    for (std::uint32_t leaf = 0; leaf < fine.num_clusters(); ++leaf) {
        const Cell& own = fine.quadtree.leaves()[leaf];
        if (own.face != cell.face || own.above(cell.level) != cell)
            continue;
        const bool is_texel = own.level == texel_level(Resolution);
        const std::array<LatticePoint, SamplesPerCell> points = lattice_points(own);
        double weight = 0.0;
        for (std::size_t l = 0; l < SamplesPerCell; ++l)
            if (glm::dot(fine.normals[place], direction(points[l])) > 0.0f)
                weight += is_texel ? CentreWeights[l] : SampleWeights[l];
        const double distance = glm::length(place_on_cube(points[CentreSample]));
        weight *= own.size() * own.size() / (distance * distance * distance);
        above += weight;
        seen += weight * fine.counts.count(place, leaf);
    }
    return above > 0.0 ? static_cast<int>(std::lround(seen / above)) : -1;
}

TEST_F(CoarseningTest, CountsAreMeansOfWhatWasJoined) {
    const Transfer fine = fresh(0.02f, rays_);
    const Transfer coarse = coarsened(fine, to(0.06f));
    ASSERT_LT(coarse.num_clusters(), fine.num_clusters() / 2);
    std::size_t num_compared = 0, num_different = 0;
    for (std::uint32_t leaf = 0; leaf < coarse.num_clusters(); leaf += 3)
        for (std::size_t place = 0; place < coarse.num_receivers(); place += 5) {
            const int expected = plain_count(fine, place, coarse.quadtree.leaves()[leaf]);
            if (expected < 0)
                continue; // nothing is asked
            const int got = coarse.counts.count(place, leaf);
            ++num_compared;
            EXPECT_LE(std::abs(got - expected), 1);
            num_different += got != expected ? 1 : 0;
        }
    ASSERT_GT(num_compared, 1000u);
    EXPECT_LE(num_different, num_compared / 1000) << "but for means that lie on a half";
}

TEST_F(CoarseningTest, OnlyJoinsCells) {
    const Transfer fine = fresh(0.02f, rays_);
    const Transfer coarse = coarsened(fine, to(0.04f));
    for (const Cell& cell : coarse.quadtree.leaves()) {
        EXPECT_GE(cell.level, CoarsenOptions{}.min_level);
        const std::uint32_t leaf = fine.quadtree.leaf_at(
            {cell.face, (cell.x + 0.5) * cell.size() + 1e-6, (cell.y + 0.5) * cell.size() + 1e-6});
        EXPECT_GE(fine.quadtree.leaves()[leaf].level, cell.level);
    }
    // A tolerance that no stored cell fails joins nothing but what passes it.
    expect_same(coarsened(fine, to(1e-6f)), fine);
    // All that may be joined: the cells of the coarsest level.
    EXPECT_EQ(coarsened(fine, to(1.0f)).num_clusters(), 6u * 64u);
}

TEST_F(CoarseningTest, IsCloseToAFreshPrecompute) {
    // So many receivers that what is likely for one is certain for their sum.
    mesh_ = scenes::joined(scenes::icosphere(3, 0.4f, {0.0f, 0.6f, 0.0f}),
                           scenes::floor_grid(44, 3.0f));
    receivers_ = vertex_receivers(mesh_);
    const RayScene rays(mesh_);
    const Transfer fine = fresh(0.014f, rays);
    for (const float tolerance : {0.02f, 0.03f, 0.05f}) {
        const auto expected = static_cast<double>(fresh(tolerance, rays).num_clusters());
        const auto got = static_cast<double>(coarsened(fine, to(tolerance)).num_clusters());
        EXPECT_LE(got, 1.1 * expected) << tolerance;
        EXPECT_GE(got, 0.7 * expected) << tolerance;
    }
    // What the fresh one split, at its own tolerance, is nearly all split again.
    EXPECT_GE(coarsened(fine, to(0.014f)).num_clusters(), fine.num_clusters() * 9 / 10);
}

TEST_F(CoarseningTest, AnyNumberOfThreadsGivesTheSameBits) {
    const Transfer fine = fresh(0.02f, rays_);
    const Transfer expected = coarsened(fine, to(0.04f));
    const files::ThreadLimit one(1);
    expect_same(coarsened(fine, to(0.04f)), expected);
}

TEST_F(CoarseningTest, RefusesWhatIsNoTolerance) {
    const Transfer fine = fresh(0.06f, rays_);
    for (const float bad : {0.0f, -0.1f, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()})
        EXPECT_THROW(static_cast<void>(coarsened(fine, to(bad))), std::invalid_argument);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(static_cast<void>(coarsened(fine, to(0.1f), {.stop = stop.get_token()})),
                 Cancelled);
}

} // namespace
} // namespace relumine::prt
