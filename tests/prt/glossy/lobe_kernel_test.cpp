#include "prt/glossy/lobe_kernel.h"

#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/brdf.h"
#include "tests/prt/every_target.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

/// The table of GGX with a colour of its own.
std::shared_ptr<const mesh::BrdfTable> ggx_table(float roughness) {
    return mesh::brdf_of([roughness](const mesh::BrdfDirections& at) {
        const glm::vec3 h = glm::normalize(at.to_light + at.to_eye);
        const LobeGeometry geometry{at.to_light.z, at.to_eye.z, h.x * h.x + h.y * h.y};
        return glm::vec3(0.5f, 1.0f, 0.25f) * GgxLobe::specular(roughness, geometry) /
               at.to_light.z;
    });
}

/// Receivers of all kinds, some with the eye below the horizon.
struct RandomBlock {
    std::array<Surface, BlockSize> surfaces;
    std::array<glm::vec3, BlockSize> normals, to_eye;
    BlockSurfaces block;

    explicit RandomBlock(std::uint32_t seed) {
        static const auto rough = ggx_table(0.8f), smooth = ggx_table(0.3f);
        std::mt19937 random(seed), of_films(seed + 1000);
        std::uniform_real_distribution<float> unit(0.0f, 1.0f);
        for (std::size_t i = 0; i < BlockSize; ++i) {
            normals[i] = scenes::random_direction(random);
            to_eye[i] = scenes::random_direction(random);
            const auto highlight = static_cast<Highlight>(random() % NumHighlights);
            surfaces[i] = {.highlight = highlight,
                           .roughness_or_exponent = highlight == Highlight::BlinnPhong
                                                        ? 200.0f * unit(random)
                                                        : unit(random),
                           .coat = unit(random) < 0.5f ? 0.0f : 0.5f,
                           .coat_roughness = unit(random),
                           .sheen = glm::vec3(unit(random) < 0.5f ? 0.0f : 1.0f),
                           .sheen_roughness = unit(random)};
            if (i % 3 == 0) {
                surfaces[i].specular = {0.9f, 0.5f, 0.1f};
                surfaces[i].metallic = 0.5f;
                surfaces[i].film = unit(of_films);
            }
            if (i % 4 < 2) {
                surfaces[i].anisotropy = unit(of_films);
                surfaces[i].tangent = scenes::random_direction(of_films);
            }
            if (highlight == Highlight::Measured)
                surfaces[i].table = i % 3 == 0 ? rough : smooth;
            if (i % 2 == 0)
                surfaces[i].coat_normal = scenes::random_direction(random);
            block.set(i, surfaces[i], normals[i], to_eye[i]);
        }
    }
    [[nodiscard]] Lobes<float> plain(std::size_t i, const glm::vec3& w) const {
        return evaluate_lobes(surfaces[i], normals[i], to_eye[i], w);
    }
};

TEST(LobeKernel, EqualsThePlainLobesOnEveryTarget) {
    scenes::on_every_target([] {
        for (std::uint32_t seed = 0; seed < 20; ++seed) {
            const RandomBlock random(seed);
            std::mt19937 generator(seed + 100);
            std::vector<glm::vec3> directions(25);
            for (glm::vec3& w : directions)
                w = scenes::random_direction(generator);
            // And where highlights are: the mirror directions.
            for (std::size_t i = 0; i < 8; ++i)
                directions[i] = glm::normalize(
                    2.0f * glm::dot(random.normals[i], random.to_eye[i]) * random.normals[i] -
                    random.to_eye[i] + 1e-3f * directions[i]);
            std::vector<BlockSurfaces::Floats> values(directions.size());
            for (std::size_t l = 0; l < NumGlossyLobes; ++l) {
                evaluate_lobe(random.block, static_cast<GlossyLobe>(l), directions, values);
                for (std::size_t d = 0; d < directions.size(); ++d)
                    for (std::size_t i = 0; i < BlockSize; ++i) {
                        const Lobes<float> plain = random.plain(i, directions[d]);
                        const float expected = plain.*GlossyParts<float>[l];
                        EXPECT_NEAR(values[d][i], expected, 1e-4f * expected + 1e-6f)
                            << "receiver " << i << " direction " << d;
                    }
            }
        }
    });
}

TEST(LobeKernel, ABlockKnowsWhichLobesItHas) {
    const glm::vec3 up(0.0f, 1.0f, 0.0f);
    BlockSurfaces block;
    block.set(0, {.highlight = Highlight::None}, up, up);
    block.set(1, {.highlight = Highlight::Ggx, .roughness_or_exponent = 0.5f}, up,
              -up); // seen from below
    EXPECT_FALSE(block.has(GlossyLobe::Specular));
    block.set(2, {.highlight = Highlight::BlinnPhong, .roughness_or_exponent = 5.0f}, up, up);
    EXPECT_TRUE(block.has(GlossyLobe::Specular));
    EXPECT_FALSE(block.has(GlossyLobe::SpecularGrazing));
    block.set(3, {.highlight = Highlight::Ggx, .roughness_or_exponent = 0.5f}, up, up);
    EXPECT_TRUE(block.has(GlossyLobe::SpecularGrazing));
    EXPECT_TRUE(block.has(GlossyLobe::DiffuseGrazing));
    BlockSurfaces filmed;
    filmed.set(0, {.highlight = Highlight::GgxWhole, .roughness_or_exponent = 0.5f}, up, up);
    EXPECT_FALSE(filmed.has(GlossyLobe::DiffuseGrazing));
    filmed.set(1, {.highlight = Highlight::GgxWhole, .roughness_or_exponent = 0.5f, .film = 0.5f},
               up, up);
    EXPECT_EQ(filmed.lanes_with(GlossyLobe::DiffuseGrazing), 2u) << "blue";
}

} // namespace
} // namespace relumine::prt
