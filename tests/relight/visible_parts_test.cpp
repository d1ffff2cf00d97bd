#include "relight/visible_parts.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

std::vector<glm::vec3> some_directions(std::size_t count) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    std::vector<glm::vec3> directions(count);
    for (glm::vec3& direction : directions)
        direction = glm::vec3(normal(random), normal(random), normal(random));
    return directions;
}

/// The same by rays: a mean over directions of a cone, weighted by the cosine.
double traced_part(std::size_t receiver, const glm::vec3& axis, float radius) {
    constexpr int NumRays = 200;
    const scenes::RelitScene& scene = relit_scene();
    const glm::dvec3 normal = scene.receivers.normals[receiver], along = glm::normalize(axis);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part;
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < NumRays; ++i) {
        const double cosine = 1.0 - part(random) * (1.0 - std::cos(radius));
        const double turn = 2.0 * std::numbers::pi * part(random);
        const glm::dvec3 right = glm::normalize(
            glm::cross(along, std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
        const glm::vec3 direction =
            cosine * along +
            std::sqrt(1.0 - cosine * cosine) *
                (std::cos(turn) * right + std::sin(turn) * glm::cross(along, right));
        const double weight = glm::dot(normal, glm::dvec3(direction));
        if (weight <= 0.0)
            continue;
        all += weight;
        const glm::vec3 origin = scene.receivers.positions[receiver] +
                                 scene.options.bias * scene.receivers.normals[receiver];
        seen += scene.rays.occluded(origin, direction) ? 0.0 : weight;
    }
    return all > 0.0 ? seen / all : 0.0;
}

TEST(VisibleParts, AreThoseThatRaysFind) {
    const std::vector<glm::vec3> directions = some_directions(40);
    constexpr float Radius = 0.35f;
    const std::size_t num_receivers = relit_scene().transfer.num_receivers();
    std::vector<std::uint8_t> parts(num_receivers * directions.size());
    VisibleParts(relit_scene().transfer, directions, Radius).find(parts);
    double error = 0.0, spread = 0.0;
    std::size_t count = 0;
    for (std::size_t receiver = 0; receiver < num_receivers; receiver += 11)
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const glm::vec3 axis = glm::normalize(directions[i]);
            if (glm::dot(relit_scene().receivers.normals[receiver], axis) < 0.1f)
                continue;
            const double expected = traced_part(receiver, axis, Radius);
            error += std::abs(parts[receiver * directions.size() + i] / 255.0 - expected);
            spread += 1.0 - expected;
            ++count;
        }
    ASSERT_GT(count, 300u);
    EXPECT_GT(spread / static_cast<double>(count), 0.1) << "something is hidden";
    EXPECT_LT(error / static_cast<double>(count), 0.03);
}

TEST(VisibleParts, AreNoneBelowTheHorizon) {
    const scenes::RelitScene& scene = relit_scene();
    std::vector<std::uint8_t> parts(scene.transfer.num_receivers(), 7);
    for (std::size_t receiver = 0; receiver < parts.size(); receiver += 53) {
        const std::vector<glm::vec3> down = {-scene.receivers.normals[receiver]};
        VisibleParts(scene.transfer, down, 0.0f).find(parts);
        EXPECT_EQ(parts[receiver], 0) << receiver;
    }
}

TEST(VisibleParts, RefusesWhatIsNoConeAndWrongSizes) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const std::vector<glm::vec3> up = {glm::vec3(0.0f, 2.0f, 0.0f)};
    const std::vector<glm::vec3> none = {glm::vec3(0.0f)};
    const std::vector<glm::vec3> endless = {
        glm::vec3(std::numeric_limits<float>::infinity(), 0.0f, 0.0f)};
    EXPECT_THROW(VisibleParts(transfer, none, 0.1f), std::invalid_argument);
    EXPECT_THROW(VisibleParts(transfer, endless, 0.1f), std::invalid_argument);
    EXPECT_THROW(VisibleParts(transfer, up, -0.1f), std::invalid_argument);
    EXPECT_THROW(VisibleParts(transfer, up, 2.0f), std::invalid_argument);
    const VisibleParts visible(transfer, up, 0.1f);
    std::vector<std::uint8_t> too_many(transfer.num_receivers() + 1);
    EXPECT_THROW(visible.find(too_many), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
