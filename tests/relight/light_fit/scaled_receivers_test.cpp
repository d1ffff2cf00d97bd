#include "relight/light_fit/scaled_receivers.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

/// Places with a normal.
std::vector<std::size_t> lit_places(const prt::Transfer& transfer) {
    std::vector<std::size_t> lit;
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place)
        if (transfer.normals[place] != glm::vec3(0.0f))
            lit.push_back(place);
    return lit;
}

TEST(ScaledReceivers, AllOfThemAsTheyAreWhereThereAreNoMore) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const std::vector<double> expected(transfer.num_receivers(), 1.0);
    const std::vector<std::size_t> lit = lit_places(transfer);
    const ScaledReceivers chosen = choose_receivers(transfer, expected, lit.size());
    EXPECT_EQ(chosen.places, lit);
    EXPECT_EQ(chosen.scales, std::vector<float>(lit.size(), 1.0f));
}

TEST(ScaledReceivers, EvenlySpreadWhereNothingIsExpected) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const std::vector<std::size_t> lit = lit_places(transfer);
    const std::size_t count = lit.size() / 4;
    const ScaledReceivers chosen =
        choose_receivers(transfer, std::vector<double>(transfer.num_receivers(), 0.0), count);
    EXPECT_NEAR(static_cast<double>(chosen.places.size()), static_cast<double>(count), 1.0);
    for (const float scale : chosen.scales)
        EXPECT_NEAR(scale * scale, static_cast<double>(lit.size()) / static_cast<double>(count),
                    1e-4);
}

TEST(ScaledReceivers, AllOfASmallPartThatHasTheErrorAndSomeOfTheRest) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const std::vector<std::size_t> lit = lit_places(transfer);
    const std::size_t count = lit.size() / 4;
    // The error is in an eighth of the receivers: seven tenths of a quarter would be more than
    // there are.
    const std::size_t begin = lit.size() / 2;
    const std::size_t end = begin + lit.size() / 8;
    std::vector<double> expected(transfer.num_receivers(), 0.0);
    for (std::size_t i = begin; i < end; ++i)
        expected[lit[i]] = 3.0;
    const ScaledReceivers chosen = choose_receivers(transfer, expected, count);
    EXPECT_NEAR(static_cast<double>(chosen.places.size()), static_cast<double>(count), 1.0);
    ASSERT_TRUE(std::is_sorted(chosen.places.begin(), chosen.places.end()));
    for (std::size_t i = begin + 3; i < end - 3;
         ++i) { // but for its ends, which are averaged with the rest
        const auto found = std::lower_bound(chosen.places.begin(), chosen.places.end(), lit[i]);
        ASSERT_TRUE(found != chosen.places.end() && *found == lit[i]);
        EXPECT_EQ(chosen.scales[static_cast<std::size_t>(found - chosen.places.begin())], 1.0f);
    }
    // Sums over all receivers, of 1 and of something that varies over the scene.
    double number = 0.0;
    double estimate = 0.0;
    for (std::size_t i = 0; i < chosen.places.size(); ++i) {
        const double square =
            static_cast<double>(chosen.scales[i]) * static_cast<double>(chosen.scales[i]);
        number += square;
        estimate += square * (1.0 + static_cast<double>(transfer.normals[chosen.places[i]].y));
    }
    double exact = 0.0;
    for (const std::size_t place : lit)
        exact += 1.0 + static_cast<double>(transfer.normals[place].y);
    EXPECT_NEAR(number, static_cast<double>(lit.size()), 0.02 * static_cast<double>(lit.size()));
    EXPECT_NEAR(estimate, exact, 0.05 * exact);
}

TEST(ScaledReceivers, ErrorsAreSquaredDifferencesOverTheirSum) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    relighter.set_environment(scenes::smooth_environment(32));
    const std::vector<lights::DistantLight> lights = {
        {.direction = glm::normalize(glm::dvec3(1.0, 2.0, 3.0)), .irradiance = {3.0, 2.0, 1.0}},
        {.direction = {0.0, 1.0, 0.0}, .irradiance = {1.0, 1.0, 2.0}}};
    std::vector<double> errors(relit_scene().transfer.num_receivers(), 0.0);
    add_squared_errors(relighter, {.radiance = relighter.radiance()}, lights, errors);
    const std::vector<glm::vec3> lit =
        radiance_under(lights, relit_scene().receivers.normals, relit_scene().shadow_rays());
    double sum = 0.0;
    for (std::size_t i = 0; i < lit.size(); ++i)
        sum +=
            std::pow(glm::distance(glm::dvec3(lit[i]), glm::dvec3(relighter.radiance()[i])), 2.0);
    for (std::size_t place = 0; place < errors.size(); ++place) {
        const std::uint32_t i = relit_scene().transfer.order[place];
        EXPECT_NEAR(
            errors[place] * sum,
            std::pow(glm::distance(glm::dvec3(lit[i]), glm::dvec3(relighter.radiance()[i])), 2.0),
            1e-9 * sum);
    }
}

} // namespace
} // namespace relumine::relight
