#include "relight/adjoint/transport.h"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

std::vector<glm::dvec3> product(const Transport& matrix) {
    std::vector<glm::dvec3> result(matrix.row_begins.size() - 1, glm::dvec3(0.0));
    for (std::size_t row = 0; row < result.size(); ++row)
        for (std::size_t i = matrix.row_begins[row]; i < matrix.row_begins[row + 1]; ++i)
            for (int channel = 0; channel < 3; ++channel)
                result[row][channel] +=
                    static_cast<double>(matrix.data[static_cast<std::size_t>(channel)][i]) *
                    matrix.light[matrix.columns[i]][channel];
    return result;
}

void expect_product(const Relighter& relighter) {
    const Transport matrix = transport(relighter);
    EXPECT_EQ(matrix.light.size(),
              relighter.transfer().num_clusters() + relighter.sharp_lights().size());
    const std::vector<glm::dvec3> found = product(matrix);
    ASSERT_EQ(found.size(), relighter.radiance().size());
    double mean = 0.0;
    for (const glm::vec3& value : relighter.radiance())
        mean += static_cast<double>(value.r + value.g + value.b) /
                static_cast<double>(3 * found.size());
    ASSERT_GT(mean, 0.0);
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            const auto expected = static_cast<double>(relighter.radiance()[i][channel]);
            ASSERT_NEAR(found[i][channel], expected, 1e-5 * (expected + 0.01 * mean))
                << "receiver " << i;
        }
}

TEST(Transport, TimesTheLightIsTheRadiance) {
    Relighter relighter(relit_scene().transfer);
    for (const std::uint32_t resolution : {32u, 64u, 7u}) {
        relighter.set_environment(scenes::random_environment(resolution, resolution));
        expect_product(relighter);
    }
}

TEST(Transport, HasSharpLightsAndColours) {
    prt::Transfer colored = relit_scene().transfer;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> albedo(0.0f, 1.0f);
    for (std::size_t i = 0; i < colored.num_receivers(); ++i)
        colored.surfaces.push_back({.albedo = {albedo(random), albedo(random), albedo(random)}});
    Relighter relighter(colored, relit_scene().shadow_rays());
    cubemap::CubeMap environment = scenes::random_environment(32, 3, 1.0f);
    environment.at(cubemap::Face::PositiveY, 11, 17) = glm::vec3(3e4f, 2e4f, 9e3f);
    environment.at(cubemap::Face::PositiveX, 20, 3) = glm::vec3(1e4f, 0.0f, 2e4f);
    relighter.set_environment(environment);
    ASSERT_FALSE(relighter.sharp_lights().empty());
    expect_product(relighter);
    // Of light lists, too.
    relighter.set_lights(std::vector<lights::DistantLight>{
        {.direction = {0.6, 0.8, 0.0}, .irradiance = {3.0, 2.0, 1.0}, .solid_angle = 1.0}});
    expect_product(relighter);
}

TEST(Transport, KnowsPointsInSpace) {
    prt::Receivers points;
    points.have_no_surface = true;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-3.0f, 3.0f), height(0.2f, 3.0f);
    for (int i = 0; i < 50; ++i)
        points.positions.push_back({place(random), height(random), place(random)});
    points.normals.resize(points.positions.size(), glm::vec3(0.0f));
    const prt::Transfer transfer =
        prt::precompute(points, relit_scene().rays, {.tolerance = 0.05f, .face_resolution = 64});
    Relighter relighter(transfer);
    relighter.set_environment(scenes::random_environment(32, 9));
    expect_product(relighter);
}

TEST(Transport, RefusesTooManyEntries) {
    Relighter relighter(relit_scene().transfer);
    relighter.set_environment(scenes::random_environment(16, 1));
    const std::size_t count = transport(relighter).columns.size();
    EXPECT_EQ(transport(relighter, {.max_entries = count}).columns.size(), count);
    EXPECT_THROW(static_cast<void>(transport(relighter, {.max_entries = count - 1})),
                 std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
