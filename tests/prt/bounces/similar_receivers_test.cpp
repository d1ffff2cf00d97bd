#include "prt/bounces/similar_receivers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

using testing::ElementsAre;

struct Points {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<float> distances;

    [[nodiscard]] PlaceLists similar(const SimilarityLimits& limits) const {
        return similar_receivers(positions, normals, distances, limits);
    }
};

/// Points near a bumpy plane, some at the same place.
Points random_points(std::size_t n) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Points points;
    for (std::size_t i = 0; i < n; ++i) {
        points.positions.push_back(
            i % 10 == 9 ? points.positions[i / 2]
                        : glm::vec3(unit(random), 0.02f * unit(random), unit(random)));
        points.normals.push_back(
            glm::normalize(glm::vec3(0.2f * unit(random), 1.0f, 0.2f * unit(random))));
        points.distances.push_back(i % 17 == 0   ? 0.0f
                                   : i % 19 == 0 ? std::numeric_limits<float>::infinity()
                                                 : 0.5f * unit(random));
    }
    return points;
}

/// The plain version: every pair.
std::vector<std::uint32_t> plain_list(const Points& points, std::uint32_t place,
                                      const SimilarityLimits& limits) {
    std::vector<std::pair<float, std::uint32_t>> found;
    for (std::uint32_t other = 0; other < points.positions.size(); ++other) {
        const glm::vec3 offset = points.positions[other] - points.positions[place];
        const float turn = std::sqrt(
            std::max(0.0f, 1.0f - glm::dot(points.normals[place], points.normals[other])));
        const float distance = std::min(points.distances[place], points.distances[other]);
        if (other != place && points.distances[place] > 0.0f &&
            glm::length(offset) <= (limits.max_error - turn) * distance)
            found.emplace_back(glm::dot(offset, offset), other);
    }
    std::sort(found.begin(), found.end());
    found.resize(std::min(found.size(), limits.max_size - 1));
    std::vector<std::uint32_t> list = {place};
    for (const auto& [distance, other] : found)
        list.push_back(other);
    std::sort(list.begin(), list.end());
    return list;
}

TEST(SimilarReceivers, AreTheNearestOfThoseWithinTheError) {
    const Points points = random_points(1500);
    for (const SimilarityLimits limits :
         {SimilarityLimits{}, SimilarityLimits{.max_error = 0.5f, .max_size = 5},
          SimilarityLimits{.max_error = 0.1f, .max_size = 1000}}) {
        const PlaceLists lists = points.similar(limits);
        ASSERT_EQ(lists.size(), points.positions.size());
        std::size_t num_different = 0, num_alone = 0;
        for (std::uint32_t place = 0; place < lists.size(); ++place) {
            const std::vector<std::uint32_t> list(lists[place].begin(), lists[place].end());
            num_alone += static_cast<std::size_t>(list.size() == 1);
            // The last bit decides a few.
            num_different += static_cast<std::size_t>(list != plain_list(points, place, limits));
        }
        EXPECT_LE(num_different, 3u);
        EXPECT_GT(num_alone, 80u);
        EXPECT_LT(num_alone, 1200u);
    }
}

TEST(SimilarReceivers, SurfacesThatAreNearSeparateThem) {
    Points points{.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0.2f, 0, 0}},
                  .normals = std::vector(3, glm::vec3(0, 1, 0)),
                  .distances = {1.0f, 1.0f, 1.0f}};
    EXPECT_THAT(points.similar({.max_error = 0.11f})[0], ElementsAre(0, 1));
    EXPECT_THAT(points.similar({.max_error = 0.11f})[1], ElementsAre(0, 1, 2));
    points.distances[1] = 0.5f;
    EXPECT_THAT(points.similar({.max_error = 0.11f})[1], ElementsAre(1));
    points.normals[2] = {1, 0, 0};
    EXPECT_THAT(points.similar({.max_error = 0.9f})[0], ElementsAre(0, 1));
}

} // namespace
} // namespace relumine::prt
