#include "prt/bounces/thinned_bounces.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "relight/bounces/bounce_light.h"
#include "tests/prt/scenes.h"
#include "tests/relight/bounces/bouncing_scene.h"

namespace relumine::relight {
namespace {

const BouncingScene& thinned_scene() {
    static const BouncingScene made(scenes::sphere_and_box_on_floor(), 0.02f, 0.01f);
    return made;
}

std::size_t row_samples(const prt::BounceMatrix& matrix, std::size_t row) {
    std::size_t count = 0;
    for (const std::uint32_t list : matrix.averaged[row])
        count += matrix.emitters[list].size();
    return count;
}

/// Light that differs from place to place.
std::vector<glm::vec3> uneven_light(std::size_t size) {
    std::vector<glm::vec3> light(size);
    for (std::size_t i = 0; i < size; ++i)
        light[i] = glm::vec3(1.0f + std::sin(0.05f * static_cast<float>(i)));
    return light;
}

std::vector<glm::vec3> thinned_light(const prt::BounceMatrix& matrix) {
    BounceLight light(matrix, thinned_scene().transfer);
    const std::vector<glm::vec3> albedo(matrix.num_rows(), glm::vec3(0.5f));
    light.set_albedo(albedo);
    light.solve(uneven_light(matrix.num_rows()), {});
    const auto indirect = light.indirect();
    return {indirect.begin(), indirect.end()};
}

TEST(ThinnedBounces, KeepTheSumsOfRowsWithFewerSamples) {
    const prt::BounceMatrix& all = thinned_scene().matrix;
    const std::size_t before = all.emitters.places.size();
    const prt::BounceMatrix few = prt::thinned(all, 40);
    EXPECT_NO_THROW(prt::require_bounces(few, all.num_rows()));
    ASSERT_LT(few.emitters.places.size(), before / 2);
    std::size_t sum = 0, num_rows = 0;
    for (std::size_t row = 0; row < all.num_rows(); ++row) {
        const auto whole = static_cast<float>(row_samples(all, row)) * all.weights[row];
        EXPECT_NEAR(static_cast<float>(row_samples(few, row)) * few.weights[row], whole, 1e-5f);
        sum += row_samples(few, row);
        num_rows += row_samples(few, row) > 0 ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(sum) / static_cast<double>(num_rows), 40.0, 8.0);
}

TEST(ThinnedBounces, GiveAboutTheSameLight) {
    const std::vector<glm::vec3> expected = thinned_light(thinned_scene().matrix);
    double error_before = 1.0;
    for (const std::size_t samples : {10u, 160u}) {
        const std::vector<glm::vec3> got =
            thinned_light(prt::thinned(thinned_scene().matrix, samples));
        double error = 0.0, whole = 0.0;
        for (std::size_t i = 0; i < got.size(); ++i) {
            error += glm::dot(got[i] - expected[i], got[i] - expected[i]);
            whole += glm::dot(expected[i], expected[i]);
        }
        error = std::sqrt(error / whole);
        EXPECT_LT(error, samples == 10 ? 0.3 : 0.1);
        EXPECT_LT(error, error_before);
        error_before = error;
    }
}

TEST(ThinnedBounces, StayWhereTheyAreFewAndRefuseNone) {
    EXPECT_EQ(prt::thinned(thinned_scene().matrix, 1'000'000), thinned_scene().matrix);
    EXPECT_THROW(static_cast<void>(prt::thinned(thinned_scene().matrix, 0)), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
