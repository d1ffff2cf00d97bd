#include "relight/adjoint/contribution.h"

#include <numeric>
#include <stdexcept>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

void expect_sums_to_radiance(const Relighter& relighter,
                             const std::vector<std::uint32_t>& receivers) {
    glm::dvec3 mean(0.0);
    for (const std::uint32_t receiver : receivers)
        mean += glm::dvec3(relighter.radiance()[receiver]) / static_cast<double>(receivers.size());
    const glm::dvec3 sum = cubemap::total_power(contribution_map(relighter, receivers));
    for (int channel = 0; channel < 3; ++channel) // texels are floats
        EXPECT_NEAR(sum[channel], mean[channel], 1e-5 * mean[channel] + 1e-9);
}

TEST(ContributionMap, SumsToTheReceiversRadiance) {
    // Resolutions that fit the cells, do not fit them, and are coarser than they are.
    for (const std::uint32_t r : {1u, 7u, 32u, 64u}) {
        Relighter relighter(relit_scene().transfer);
        relighter.set_environment(scenes::random_environment(r, 4));
        for (std::uint32_t receiver = 0; receiver < relighter.radiance().size(); receiver += 17)
            expect_sums_to_radiance(relighter, {receiver});
        std::vector<std::uint32_t> all(relighter.radiance().size());
        std::iota(all.begin(), all.end(), 0u);
        expect_sums_to_radiance(relighter, all);
    }
}

TEST(ContributionMap, SumsToTheRadianceWithATracedSun) {
    Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    cubemap::CubeMap environment(64, glm::vec3(0.5f));
    environment.at(cubemap::Face::PositiveY, 20, 37) = glm::vec3(1e5f, 9e4f, 8e4f);
    relighter.set_environment(environment);
    ASSERT_FALSE(relighter.sharp_lights().empty());
    for (std::uint32_t receiver = 0; receiver < relighter.radiance().size(); receiver += 17)
        expect_sums_to_radiance(relighter, {receiver});
}

TEST(ContributionMap, IsBrightOnlyWhereLightReachesTheReceiver) {
    Relighter relighter(relit_scene().transfer);
    relighter.set_environment(cubemap::CubeMap(32, glm::vec3(1.0f)));
    for (std::uint32_t receiver = 0; receiver < relighter.radiance().size(); receiver += 23) {
        const cubemap::CubeMap map = contribution_map(relighter, {{receiver}});
        std::size_t place = 0;
        while (relighter.transfer().order[place] != receiver)
            ++place;
        const glm::dvec3 normal = relighter.transfer().normals[place];
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < 32; ++y)
                for (std::uint32_t x = 0; x < 32; ++x) {
                    // A cell of the least depth reaches at most 0.25 (the sine of its angle) below
                    // the horizon.
                    if (glm::dot(cubemap::texel_direction(face, x, y, 32), normal) < -0.25) {
                        EXPECT_EQ(map.at(face, x, y), glm::vec3(0.0f));
                    }
                }
    }
}

TEST(ContributionMap, RefusesNoReceiversAndWrongOnes) {
    Relighter relighter(relit_scene().transfer);
    relighter.set_environment(cubemap::CubeMap(8, glm::vec3(1.0f)));
    EXPECT_THROW(static_cast<void>(contribution_map(relighter, {})), std::invalid_argument);
    const std::vector<std::uint32_t> beyond = {
        static_cast<std::uint32_t>(relighter.radiance().size())};
    EXPECT_THROW(static_cast<void>(contribution_map(relighter, beyond)), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
