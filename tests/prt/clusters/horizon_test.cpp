#include "prt/clusters/horizon.h"

#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/visibility/bit_matrix.h"
#include "tests/prt/every_target.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

TEST(Horizon, IsTheSignOfTheRoundedCosineOnEveryTarget) {
    scenes::on_every_target([] {
        std::mt19937 random(1);
        std::vector<glm::vec3> normals;
        for (int i = 0; i < 200; ++i)
            normals.push_back(i % 9 == 8 ? glm::vec3(0.0f) : scenes::random_direction(random));
        const NormalArrays arrays(normals);
        for (std::uint32_t n = 1; n <= DirectionPatch::Size; ++n) {
            DirectionPatch patch;
            for (std::uint32_t j = 0; j < n; ++j) {
                // Half of them at right angles to some normal, where rounding alone decides.
                const glm::vec3 w = scenes::random_direction(random);
                patch.add(j % 2 == 0 ? w
                                     : glm::normalize(glm::cross(
                                           normals[random() % 200] + glm::vec3(1e-9f), w)));
            }
            std::vector<std::uint64_t> rays(100, ~std::uint64_t{0});
            directions_above_horizon(arrays, 64, patch, rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                std::uint64_t expected = 0;
                for (std::size_t j = 0; j < n; ++j) {
                    const glm::vec3 w = patch.direction(j);
                    const glm::vec3& normal = normals[64 + i];
                    const volatile float x = normal.x * w.x, y = normal.y * w.y, z = normal.z * w.z;
                    const volatile float xy = x + y;
                    const volatile float cosine = xy + z;
                    expected |= static_cast<std::uint64_t>(cosine > 0.0f) << j;
                }
                ASSERT_EQ(rays[i], expected) << n << " directions, receiver " << i;
            }
        }
    });
}

TEST(BitMatrix, TransposeMovesEveryBit) {
    std::mt19937_64 random(2);
    std::array<std::uint64_t, 64> rows;
    for (std::uint64_t& row : rows)
        row = random();
    std::array<std::uint64_t, 64> columns = rows;
    transpose(columns);
    for (std::size_t i = 0; i < 64; ++i)
        for (std::size_t j = 0; j < 64; ++j)
            ASSERT_EQ(rows[i] >> j & 1u, columns[j] >> i & 1u);
}

} // namespace
} // namespace relumine::prt
