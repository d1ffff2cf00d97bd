#include "prt/clusters/visibility_planes.h"

#include <algorithm>
#include <mutex>
#include <random>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/analytic_blockers.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

struct Setting {
    std::vector<glm::vec3> origins;
    std::vector<glm::vec3> normals;

    Setting(std::size_t n, std::uint32_t seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> coordinate(-1.0f, 1.0f);
        for (std::size_t i = 0; i < n; ++i) {
            origins.emplace_back(coordinate(random), coordinate(random), coordinate(random));
            normals.push_back(i % 10 == 9 ? glm::vec3(0.0f) : scenes::random_direction(random));
        }
    }
};

std::vector<LatticePoint> points_of(std::uint32_t level) {
    std::vector<LatticePoint> points;
    const std::uint32_t n = 1u << level;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t i = 0; i < n * n; ++i) {
            const auto of_cell = lattice_points(
                {.face = face, .level = static_cast<std::uint8_t>(level), .x = i % n, .y = i / n});
            points.insert(points.end(), of_cell.begin(), of_cell.end());
        }
    return points;
}

bool bit_of(const std::uint64_t* plane, std::size_t i) {
    return (plane[i / WordSize] >> (i % WordSize) & 1u) != 0;
}

TEST(VisibilityPlanes, BitsSayAboveTheHorizonAndNotBlocked) {
    const auto blockers = scenes::sphere_blocker({0.0, 2.0, 0.0}, 0.9);
    for (const std::size_t n : {1u, 63u, 64u, 65u, 600u}) {
        const Setting setting(n, 1);
        const NormalArrays normals(setting.normals);
        VisibilityPlanes planes(setting.origins, normals, blockers);
        const std::vector<LatticePoint> points = points_of(1);
        planes.trace(points, 2.0, [](double) {});
        for (const LatticePoint point : points) {
            DirectionPacket packet;
            packet.num_directions = 1;
            const glm::vec3 w = direction(point);
            packet.set(0, w);
            for (std::size_t i = 0; i < n; ++i) {
                const glm::vec3& normal = setting.normals[i];
                // The same sum in the same order as the code's.
                const bool above = normal.x * w.x + normal.y * w.y + normal.z * w.z > 0.0f;
                const bool lit = above && blockers.occluded(setting.origins[i], packet, 1) == 0;
                ASSERT_EQ(bit_of(planes.plane(point), i), lit);
            }
            for (std::size_t i = n; i < normals.num_words() * WordSize; ++i)
                ASSERT_FALSE(bit_of(planes.plane(point), i)) << "padding";
        }
    }
}

TEST(VisibilityPlanes, TracesEveryDirectionOnce) {
    const Setting setting(100, 2);
    const NormalArrays normals(setting.normals);
    const auto nothing = scenes::no_blockers();
    const scenes::CountingBlockers counting(nothing);
    VisibilityPlanes planes(setting.origins, normals, counting);
    const std::vector<LatticePoint> first = points_of(1);
    planes.trace(first, 2.0, [](double) {});
    planes.trace(first, 2.0, [](double) {});
    planes.trace(points_of(2), 2.0, [](double) {}); // holds all of the first
    EXPECT_EQ(planes.num_directions(), 6u * 8 * 8 + 2);
    EXPECT_TRUE(std::all_of(counting.rays().begin(), counting.rays().end(),
                            [](const auto& entry) { return entry.second == 1; }));
    EXPECT_EQ(planes.num_rays(), counting.rays().size());
    for (const auto& [ray, count] : counting.rays()) { // nothing below the horizon was asked
        const auto receiver =
            static_cast<std::size_t>(std::find(setting.origins.begin(), setting.origins.end(),
                                               glm::vec3(ray[0], ray[1], ray[2])) -
                                     setting.origins.begin());
        ASSERT_LT(receiver, setting.origins.size());
        EXPECT_GT(glm::dot(setting.normals[receiver], glm::vec3(ray[3], ray[4], ray[5])), -1e-6f);
    }
}

TEST(VisibilityPlanes, ReportsItsProgressUpToOne) {
    const Setting setting(1500, 3);
    const NormalArrays normals(setting.normals);
    const auto nothing = scenes::no_blockers();
    VisibilityPlanes planes(setting.origins, normals, nothing);
    std::mutex mutex;
    std::vector<double> parts;
    const auto note = [&](double part) {
        const std::scoped_lock lock(mutex);
        parts.push_back(part);
    };
    planes.trace(points_of(5), 0.25, note);
    std::sort(parts.begin(), parts.end());
    ASSERT_GT(parts.size(), 3u);
    EXPECT_GT(parts.front(), 0.0);
    EXPECT_EQ(std::adjacent_find(parts.begin(), parts.end()), parts.end());
    EXPECT_EQ(parts.back(), 1.0);
    parts.clear();
    planes.trace(points_of(5), 0.25, note); // all known
    EXPECT_TRUE(parts.empty());
}

TEST(VisibilityPlanes, ForgetsAllButWhatIsNamed) {
    const Setting setting(10, 4);
    const NormalArrays normals(setting.normals);
    const auto nothing = scenes::no_blockers();
    VisibilityPlanes planes(setting.origins, normals, nothing);
    const std::vector<LatticePoint> points = points_of(0);
    planes.trace(points, 2.0, [](double) {});
    const std::uint64_t kept = *planes.plane(points[0]);
    planes.keep_only(std::vector<LatticePoint>{points[0], points[0], 12345});
    EXPECT_EQ(*planes.plane(points[0]), kept);
    EXPECT_THROW(static_cast<void>(planes.plane(points[4])), std::out_of_range);
}

} // namespace
} // namespace relumine::prt
