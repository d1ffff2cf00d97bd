#include "relight/batch.h"

#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

using scenes::relit_scene;

TEST(RelightBatch, IsWhatSingleEnvironmentsGiveBitByBit) {
    prt::Transfer colored = relit_scene().transfer;
    for (std::size_t i = 0; i < colored.num_receivers(); ++i)
        colored.surfaces.push_back(
            {.albedo = {0.1f + 0.001f * static_cast<float>(i % 700), 0.5f, 1.0f}});
    for (const bool is_traced : {false, true}) {
        const ShadowRays rays = is_traced ? relit_scene().shadow_rays() : ShadowRays{};
        Relighter batch(colored, rays), single(colored, rays);
        std::vector<cubemap::CubeMap> environments;
        for (std::uint32_t seed = 0; seed < 19; ++seed) {
            environments.push_back(scenes::random_environment(seed % 2 == 0 ? 16 : 32, seed));
            environments.back().at(cubemap::Face::PositiveY, seed % 16, 3) = glm::vec3(2e4f);
        }
        batch.set_environment(environments[0]);
        const std::vector<glm::vec3> before = copy(batch.radiance());
        const std::size_t size = before.size();
        std::vector<glm::vec3> radiance(environments.size() * size);
        relight_batch(batch, environments, radiance);
        EXPECT_EQ(copy(batch.radiance()), before);
        for (std::size_t i = 0; i < environments.size(); ++i) {
            single.set_environment(environments[i]);
            ASSERT_EQ(copy(std::span(radiance).subspan(i * size, size)), copy(single.radiance()));
        }
    }
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
