#include "relight/batch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "files/parallel.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

/// Random light, coarser and finer than the clusters, each with a bright texel that may be sharp.
std::vector<cubemap::CubeMap> random_environments(std::uint32_t count) {
    std::vector<cubemap::CubeMap> environments;
    for (std::uint32_t seed = 0; seed < count; ++seed) {
        environments.push_back(scenes::random_environment(seed % 2 == 0 ? 4 : 32, seed));
        environments.back().at(cubemap::Face::PositiveY, seed % 4, 3) = glm::vec3(2e4f);
    }
    return environments;
}

/// Expects what single environments give, but for roundings of the brightest receiver's light.
void expect_as_one_by_one(const prt::Transfer& transfer, const ShadowRays& rays,
                          std::span<const cubemap::CubeMap> environments) {
    Relighter batch(transfer, rays), single(transfer, rays);
    batch.set_environment(environments[0]);
    const std::vector<glm::vec3> before = copy(batch.radiance());
    const std::size_t size = before.size();
    std::vector<glm::vec3> radiance(environments.size() * size);
    relight_batch(batch, environments, radiance);
    EXPECT_EQ(copy(batch.radiance()), before);
    for (std::size_t i = 0; i < environments.size(); ++i) {
        single.set_environment(environments[i]);
        float brightest = 0.0f, off = 0.0f;
        for (std::size_t receiver = 0; receiver < size; ++receiver)
            for (int channel = 0; channel < 3; ++channel) {
                const float expected = single.radiance()[receiver][channel];
                brightest = std::max(brightest, expected);
                off = std::max(off, std::abs(radiance[i * size + receiver][channel] - expected));
            }
        EXPECT_GT(brightest, 0.0f);
        EXPECT_LT(off, 2e-6f * brightest) << "environment " << i;
    }
}

TEST(RelightBatch, IsWhatSingleEnvironmentsGive) {
    prt::Transfer colored = relit_scene().transfer;
    for (std::size_t i = 0; i < colored.num_receivers(); ++i)
        colored.surfaces.push_back(
            {.albedo = {0.1f + 0.001f * static_cast<float>(i % 700), 0.5f, 1.0f}});
    // More than are lit together, and a rest of no round number.
    const std::vector<cubemap::CubeMap> environments = random_environments(19);
    expect_as_one_by_one(colored, {}, environments);
    expect_as_one_by_one(colored, relit_scene().shadow_rays(), environments);
}

// The clusters of all are lit from the same directions, and those of one texel differ by a factor.
TEST(RelightBatch, SharesDirectionsAndTexels) {
    std::vector<cubemap::CubeMap> environments;
    for (std::uint32_t seed = 0; seed < 5; ++seed)
        environments.push_back(scenes::random_environment(2, seed));
    environments.push_back(cubemap::CubeMap(2, glm::vec3(0.0f)));
    environments.back().texels[7] = glm::vec3(3.0f, 0.0f, 1.0f);
    expect_as_one_by_one(relit_scene().transfer, {}, environments);
}

TEST(RelightBatch, HasTheSameBitsForAnyNumberOfThreads) {
    const std::vector<cubemap::CubeMap> environments = random_environments(3);
    const Relighter relighter(relit_scene().transfer, relit_scene().shadow_rays());
    std::vector<glm::vec3> all(3 * relighter.radiance().size()), alone(all.size());
    relight_batch(relighter, environments, all);
    const files::ThreadLimit limit(1);
    relight_batch(relighter, environments, alone);
    EXPECT_EQ(alone, all);
}

TEST(RelightBatch, RefusesWrongRoomAndWrongLight) {
    const Relighter relighter(relit_scene().transfer);
    std::vector<cubemap::CubeMap> environments(2, cubemap::CubeMap(4, glm::vec3(1.0f)));
    std::vector<glm::vec3> radiance(2 * relighter.radiance().size());
    EXPECT_NO_THROW(relight_batch(relighter, environments, radiance));
    EXPECT_THROW(relight_batch(relighter, environments, std::span(radiance).first(5)),
                 std::invalid_argument);
    environments[1].texels[3].g = std::numeric_limits<float>::infinity();
    EXPECT_THROW(relight_batch(relighter, environments, radiance), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
