#include "relight/sharp/traced_light.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/prt/scenes.h"
#include "tests/relight/glossy_scene.h"

namespace relumine::relight {
namespace {

SharpLight light_from(const glm::dvec3& direction, double power) {
    return {.direction = direction,
            .irradiance = {.red = power * direction,
                           .green = 0.5 * power * direction,
                           .blue = 0.1 * power * direction},
            .is_of_list = true};
}

std::vector<SharpLight> random_lights(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<SharpLight> lights;
    for (std::size_t i = 0; i < count; ++i)
        lights.push_back(
            light_from(scenes::random_direction(random), 1.0 + static_cast<double>(i)));
    return lights;
}

void expect_equal(const TracedLight& a, const TracedLight& b, const prt::Transfer& transfer) {
    for (std::size_t block = 0; block < transfer.counts.num_blocks(); ++block)
        EXPECT_EQ(a.diffuse(block)->channels, b.diffuse(block)->channels) << "block " << block;
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
        EXPECT_EQ(a.highlights(place).specular, b.highlights(place).specular);
        EXPECT_EQ(a.highlights(place).specular_grazing, b.highlights(place).specular_grazing);
        EXPECT_EQ(a.highlights(place).diffuse_grazing, b.highlights(place).diffuse_grazing);
    }
}

/// Every receiver's sum, a ray at a time.
void expect_plain_sum(const TracedLight& traced, const scenes::RelitScene& scene,
                      std::span<const SharpLight> lights) {
    for (std::size_t place = 0; place < scene.transfer.num_receivers(); ++place) {
        const std::uint32_t receiver = scene.transfer.order[place];
        const glm::vec3& n = scene.receivers.normals[receiver];
        const glm::vec3 origin =
            prt::ray_origin(scene.receivers.positions[receiver], n, scene.options.bias);
        double red = 0.0;
        for (const SharpLight& light : lights)
            if (glm::dot(n, glm::vec3(light.direction)) > 0.0f &&
                !scene.rays.occluded(origin, glm::vec3(light.direction)))
                red +=
                    std::max(0.0, glm::dot(glm::dvec3(n), light.irradiance.red)) / 3.14159265358979;
        EXPECT_NEAR(traced.diffuse(place / prt::BlockSize)->channels[0][place % prt::BlockSize],
                    red, 1e-9 * (1.0 + red));
    }
}

TEST(TracedLight, TracesOnlyWhatIsNew) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    TracedLight kept(scene.transfer, scene.shadow_rays());
    std::vector<SharpLight> lights = random_lights(37, 1);
    const auto step = [&](std::size_t expected_rays) {
        EXPECT_EQ(kept.trace(lights), expected_rays);
        TracedLight anew(scene.transfer, scene.shadow_rays());
        static_cast<void>(anew.trace(lights));
        expect_equal(kept, anew, scene.transfer);
        expect_plain_sum(kept, scene, lights);
    };
    step(37);
    lights[5] = light_from(lights[5].direction, 100.0); // brighter in its place
    step(0);
    lights.erase(lights.begin() + 3);
    lights.insert(lights.begin() + 20, random_lights(1, 2).front());
    step(1);
    lights.push_back(lights[7]); // two from one direction
    step(0);
    lights.clear();
    step(0);
    lights = random_lights(2, 1); // both are forgotten by now
    step(2);
}

/// Where a block sees its cluster in part every receiver has its own ray, elsewhere none has.
TEST(TracedLight, ClustersAnswerForLightsOfAnEnvironment) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    const prt::Transfer& transfer = scene.transfer;
    std::vector<SharpLight> lights = random_lights(60, 5);
    TracedLight exact(transfer, scene.shadow_rays());
    static_cast<void>(exact.trace(lights));
    for (SharpLight& light : lights) {
        light.is_of_list = false;
        light.cluster = transfer.quadtree.leaf_at(cubemap::face_point(light.direction));
    }
    TracedLight traced(transfer, scene.shadow_rays());
    static_cast<void>(traced.trace(lights));
    std::size_t num_mixed = 0, num_sure = 0, num_wrong = 0;
    for (std::size_t i = 0; i < lights.size(); ++i)
        for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
            const std::size_t block = place / prt::BlockSize, lane = place % prt::BlockSize;
            const std::uint32_t cluster = lights[i].cluster;
            const std::size_t word = transfer.counts.word(block, cluster / 64);
            const bool is_mixed = (transfer.counts.mixed[word] >> cluster % 64 & 1u) != 0;
            const bool is_reached = (traced.reached(i, block) >> lane & 1u) != 0;
            const bool is_exact = (exact.reached(i, block) >> lane & 1u) != 0;
            (is_mixed ? num_mixed : num_sure) += 1;
            if (is_mixed)
                EXPECT_EQ(is_reached, is_exact) << "light " << i << ", place " << place;
            else
                num_wrong += is_reached != is_exact ? 1 : 0;
        }
    EXPECT_GT(num_mixed, 1000u);
    // What nine samples of 16 receivers all miss.
    EXPECT_LT(num_wrong * 200, num_sure);
    // A list of the same directions has rays of its own.
    for (SharpLight& light : lights)
        light.is_of_list = true;
    EXPECT_EQ(traced.trace(lights), lights.size());
    expect_equal(traced, exact, transfer);
}

TEST(TracedLight, KeepsWhatHighlightsNeed) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    TracedLight kept(scene.transfer, scene.shadow_rays());
    std::vector<SharpLight> lights = random_lights(20, 3);
    EXPECT_EQ(kept.trace(lights), 20u);
    lights.resize(18);
    lights.push_back(random_lights(1, 4).front());
    EXPECT_EQ(kept.trace(lights), 1u);
    TracedLight anew(scene.transfer, scene.shadow_rays());
    EXPECT_EQ(anew.trace(lights), 19u);
    expect_equal(kept, anew, scene.transfer);
}

TEST(TracedLight, WithoutBlockersNothingIsTraced) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    TracedLight none(scene.transfer, {});
    EXPECT_EQ(none.trace(random_lights(3, 1)), 0u);
    EXPECT_EQ(none.diffuse(0), nullptr);
}

} // namespace
} // namespace relumine::relight
