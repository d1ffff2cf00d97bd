#include "prt/visibility/group_origins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();

TriangleTree tree_at(const glm::vec3& centre) {
    TriangleTree tree;
    tree.centre = centre;
    tree.extent = 1.0f;
    return tree;
}

std::vector<glm::vec3> origins_around(const glm::vec3& middle, std::size_t size) {
    std::mt19937 random(static_cast<unsigned>(size));
    std::uniform_real_distribution<float> offset(-2.0f, 2.0f);
    std::vector<glm::vec3> origins(size);
    for (glm::vec3& origin : origins)
        origin = middle + glm::vec3(offset(random), offset(random), offset(random));
    return origins;
}

TEST(GroupOrigins, MeasuresOriginsFromBothMiddles) {
    const TriangleTree tree = tree_at({1.0f, 2.0f, 3.0f});
    for (const std::size_t size : {1u, 15u, 16u, 17u, 127u, 128u}) {
        const std::vector<glm::vec3> origins = origins_around({4.0f, 0.0f, 0.0f}, size);
        const GroupOrigins group({.origins = origins, .mean_normal = {}}, tree);
        float reach = tree.extent, radius = 0.0f;
        for (std::size_t i = 0; i < ReceiverGroup::MaxSize; ++i) {
            const glm::vec3& origin = origins[i < size ? i : 0];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<int>(axis);
                EXPECT_EQ(group.rows[axis][i], origin[a]);
                EXPECT_EQ(group.from_centre[axis][i], origin[a] - tree.centre[a]);
                EXPECT_EQ(group.from_middle[axis][i], origin[a] - group.middle[a]);
                EXPECT_LE(group.low[a], origin[a]);
                EXPECT_GE(group.high[a], origin[a]);
                reach = std::max(reach, std::abs(origin[a] - tree.centre[a]));
                radius = std::max(radius, std::abs(origin[a] - group.middle[a]));
            }
        }
        EXPECT_EQ(group.reach, reach);
        EXPECT_EQ(group.radius, radius);
    }
}

TEST(GroupOrigins, AShaftHoldsTheReceiversThatHaveRaysAndNoMore) {
    const TriangleTree tree = tree_at({});
    const std::vector<glm::vec3> origins = origins_around({}, 100);
    const GroupOrigins group({.origins = origins, .mean_normal = {0.0f, 1.0f, 0.0f}}, tree);
    std::vector<std::uint64_t> rays(origins.size(), 1);
    for (std::size_t i = 0; i < rays.size(); ++i)
        rays[i] = i % 7 == 3 || (i >= 32 && i < 48) ? 0 : 1; // of a bundle, none has rays
    Shaft shaft = shaft_of({.axis = 1, .s0 = -0.1f, .s1 = 0.2f, .t0 = -0.3f, .t1 = 0.1f},
                           group.mean_normal, group.reach);
    const ReceiverCones cones = place_shaft(group, rays, shaft);
    for (std::size_t k = 0; k < Shaft::NumPlanes; ++k) {
        float least = Infinity;
        std::array<float, ReceiverCones::NumBundles> of_bundles;
        of_bundles.fill(Infinity);
        for (std::size_t i = 0; i < ReceiverGroup::MaxSize; ++i) {
            const float offset = cones.offsets[k][i];
            if (i >= rays.size() || rays[i] == 0) {
                EXPECT_EQ(offset, Infinity);
                continue;
            }
            const double along = glm::dot(glm::dvec3(shaft.normals[k]), glm::dvec3(origins[i]));
            EXPECT_LE(offset, along);
            EXPECT_NEAR(offset, along, 2.0 * static_cast<double>(shaft.margins[k]));
            least = std::min(least, offset);
            float& of_bundle = of_bundles[i / ReceiverCones::BundleSize];
            of_bundle = std::min(of_bundle, offset);
        }
        EXPECT_EQ(shaft.offsets[k], least);
        EXPECT_EQ(cones.of_bundles[k], of_bundles);
    }
}

} // namespace
} // namespace relumine::prt
