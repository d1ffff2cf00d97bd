// What precompute() finds is what the method, written plainly, finds.
#include "prt/clusters/plain_clusters.h"

#include <algorithm>
#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "prt/clusters/lattice.h"
#include "prt/precompute.h"
#include "prt/receivers/point_receivers.h"
#include "prt/visibility/ray_scene.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

void expect_plain(const Receivers& receivers, const Blockers& blockers,
                  const PrecomputeOptions& options) {
    const Transfer fast = precompute(receivers, blockers, options);
    const PlainClusters plain = plain_clusters(receivers, blockers, options);
    ASSERT_TRUE(std::ranges::equal(fast.quadtree.leaves(), plain.quadtree.leaves()));
    for (std::size_t place = 0; place < fast.num_receivers(); ++place)
        for (std::size_t leaf = 0; leaf < fast.num_clusters(); ++leaf) {
            // What is below a receiver's horizon gives it nothing, whatever is stored.
            const std::uint8_t expected = plain.counts[leaf][fast.order[place]];
            const int count = fast.counts.count(place, leaf);
            ASSERT_TRUE(count == expected || (expected == 0 && count == FullCount))
                << place << " " << leaf << ": " << count << ", not " << int{expected};
        }
}

TEST(PlainClusters, EqualThoseOfAMesh) {
    const mesh::TriangleMesh mesh = scenes::sphere_and_box_on_floor();
    const RayScene rays(mesh);
    const float bias = automatic_bias(mesh);
    for (const float tolerance : {0.1f, 0.04f})
        expect_plain(vertex_receivers(mesh), rays,
                     {.tolerance = tolerance, .min_level = 1, .face_resolution = 32, .bias = bias});
    expect_plain(vertex_receivers(mesh), rays,
                 {.epsilon = 2e-3f, .min_level = 2, .face_resolution = 16, .bias = bias});
}

TEST(PlainClusters, EqualThoseOfPointsAndOfSurfacesThatSeeNothing) {
    std::mt19937 random(1);
    Receivers surfaces, points;
    for (std::size_t i = 0; i < 150; ++i) {
        const glm::vec3 at = scenes::random_direction(random);
        points.positions.push_back(at);
        points.normals.emplace_back(0.0f);
        surfaces.positions.push_back(at);
        surfaces.normals.push_back(i % 13 == 12 ? glm::vec3(0.0f)
                                                : scenes::random_direction(random));
    }
    points.have_no_surface = true;
    const auto blockers = scenes::sphere_blocker({0.5, 2.5, 0.0}, 1.0);
    for (const Receivers& receivers : {surfaces, points})
        expect_plain(receivers, blockers,
                     {.tolerance = 0.05f, .min_level = 1, .face_resolution = 32});
}

} // namespace
} // namespace relumine::prt
