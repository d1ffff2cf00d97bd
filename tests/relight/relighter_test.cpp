#include "relight/relighter.h"

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <stdexcept>
#include <tuple>
#include <type_traits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "relight/kernels/block_kernels.h"
#include "relight/reference/plain_relight.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/every_target.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

// A transfer that goes before what refers to it is refused when the program is compiled.
static_assert(std::is_constructible_v<Relighter, const prt::Transfer&>);
static_assert(!std::is_constructible_v<Relighter, prt::Transfer>);
static_assert(!std::is_constructible_v<Relighter, const prt::Transfer>);
static_assert(!std::is_constructible_v<Relighter, prt::Transfer, ShadowRays>);
static_assert(!std::is_constructible_v<EnvironmentBinner, prt::Transfer, float>);

using scenes::expect_close;
using scenes::relit_scene;

/// What a receiver gets of a cluster's light where the cluster is no more than partly visible, or
/// across a horizon: from one direction, where that is near enough.
glm::dvec3 of_directional(const VectorIrradiance& light, const glm::dvec3& n) {
    const glm::dvec3 luminance = light.luminance();
    const double length = glm::length(luminance);
    if (length == 0.0)
        return light.on(n);
    const glm::dvec3 direction = glm::vec3(luminance / length); // as it is stored
    glm::dvec3 result;
    double off = 0.0, all = 0.0;
    const std::array<glm::dvec3, 3> channels = {light.red, light.green, light.blue};
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3& channel = channels[static_cast<std::size_t>(i)];
        const double colour = glm::dot(channel, direction) / glm::dot(direction, direction);
        const glm::dvec3 rest = channel - colour * direction;
        off += glm::dot(rest, rest);
        all += glm::dot(channel, channel);
        result[i] = colour * std::max(glm::dot(n, direction), 0.0);
    }
    return off > all / 128.0 / 128.0 ? light.on(n) : result;
}

/// plain_relight(), where clusters that a block does not see whole above its horizons are
/// directional lights.
std::vector<glm::vec3> plainly_relit(const prt::Transfer& transfer,
                                     const cubemap::CubeMap& environment) {
    constexpr std::size_t TileBlocks = prt::VisibleCounts::TileBlocks;
    const prt::VisibleCounts& counts = transfer.counts;
    const TileWords words = tile_words(transfer, block_normals(transfer.normals));
    return plain_relight(
        transfer, environment,
        [&](std::size_t place, std::size_t cluster, const VectorIrradiance& light) {
            const std::size_t block = place / prt::BlockSize, w = cluster / 64;
            const TileWord& word = words.words[block / TileBlocks * counts.words_per_block() + w];
            const std::uint64_t whole =
                counts.visible[counts.word(block, w)] & ~words.across_of(word, block % TileBlocks);
            const glm::vec3& n = transfer.normals[place];
            return (whole >> cluster % 64 & 1u) != 0 ? light.on(n) : of_directional(light, n);
        });
}

prt::Receivers random_receivers(std::size_t n, std::uint32_t seed) {
    std::mt19937 random(seed);
    prt::Receivers receivers;
    for (std::size_t i = 0; i < n; ++i) {
        receivers.positions.push_back(scenes::random_direction(random));
        receivers.normals.push_back(i % 13 == 12 ? glm::vec3(0.0f)
                                                 : scenes::random_direction(random));
    }
    return receivers;
}

// Float kernels sum at most 64 clusters each before they go to double: 64 half units of 2^-24, less
// by chance.
constexpr double KernelRounding = 4e-6;

TEST(Relighter, EqualsThePlainSumOnEveryTarget) {
    const prt::Transfer& transfer = relit_scene().transfer;
    for (const std::uint32_t r : {1u, 7u, 16u, 64u}) {
        const cubemap::CubeMap environment = scenes::random_environment(r, r);
        const std::vector<glm::vec3> expected = plainly_relit(transfer, environment);
        scenes::on_every_target(
            [&] { expect_close(relight(transfer, environment), expected, KernelRounding); });
    }
}

TEST(Relighter, EqualsThePlainSumOnRandomTrees) {
    // Random blockers on sizes around those of blocks and words.
    std::mt19937 random(1);
    for (const std::size_t n : {1u, 15u, 16u, 17u, 63u, 64u, 65u, 1050u}) {
        std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
        const auto blockers =
            scenes::sphere_blocker({coordinate(random), 2.5, coordinate(random)}, 1.0);
        const prt::Transfer transfer =
            prt::precompute(random_receivers(n, static_cast<std::uint32_t>(n)), blockers,
                            {.tolerance = 0.03f, .min_level = 1, .face_resolution = 32});
        const cubemap::CubeMap environment = scenes::random_environment(32, 2);
        expect_close(relight(transfer, environment), plainly_relit(transfer, environment),
                     KernelRounding);
    }
}

TEST(Relighter, DirectionalLightsAreNearTheirLight) {
    // Each cluster is off by DirectionalTolerance at most.
    const prt::Transfer& transfer = relit_scene().transfer;
    for (const std::uint32_t r : {16u, 64u, 200u}) {
        const cubemap::CubeMap environment = scenes::random_environment(r, r);
        const std::vector<glm::vec3> exact = plain_relight(transfer, environment);
        const std::vector<glm::vec3> with_directional = plainly_relit(transfer, environment);
        EXPECT_NE(with_directional, exact);
        expect_close(with_directional, exact, ClusterLights::DirectionalTolerance);
    }
}

TEST(Relighter, WhiteFurnace) {
    const prt::Receivers receivers = random_receivers(300, 3);
    for (const float tolerance : {0.0135f, 0.003f}) {
        const prt::Transfer transfer = prt::precompute(
            receivers, scenes::no_blockers(), {.tolerance = tolerance, .face_resolution = 256});
        const auto radiance = relight(transfer, cubemap::CubeMap(64, glm::vec3(1.0f, 0.5f, 2.0f)));
        for (std::size_t i = 0; i < radiance.size(); ++i) {
            const bool receives = receivers.normals[i] != glm::vec3(0.0f);
            // Only the clusters on the horizon err, by at most the tolerance, here as if all erred
            // alike: 2 pi times 1/8 rad.
            const double allowed =
                receives ? 2.0 * std::numbers::pi / 8.0 * 3.0 * static_cast<double>(tolerance)
                         : 0.0;
            EXPECT_NEAR(radiance[i].r, receives ? 1.0 : 0.0, allowed);
            EXPECT_NEAR(radiance[i].g, 0.5 * radiance[i].r, 1e-6);
            EXPECT_NEAR(radiance[i].b, 2.0 * radiance[i].r, 1e-6);
        }
    }
}

TEST(Relighter, SameResultForAnyResolutionOfASmoothEnvironment) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const auto finest = relight(transfer, scenes::smooth_environment(256));
    // A texel's centre stands for its mean: h^2 / 24 times a second derivative of up to 2, with h =
    // 2 / R, and light moves within texels that are larger than clusters.
    for (const std::uint32_t r : {16u, 20u, 64u, 100u})
        expect_close(relight(transfer, scenes::smooth_environment(r)), finest, 2.0 / r / r + 1e-5);
}

TEST(Relighter, IsLinearInTheEnvironment) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const cubemap::CubeMap environment = scenes::random_environment(32, 4);
    cubemap::CubeMap scaled = environment;
    for (glm::vec3& texel : scaled.texels)
        texel *= 1024.0f;
    auto expected = relight(transfer, environment);
    for (glm::vec3& b : expected)
        b *= 1024.0f; // a power of two: no rounding
    EXPECT_EQ(relight(transfer, scaled), expected);
    const auto black = relight(transfer, cubemap::CubeMap(32));
    EXPECT_TRUE(std::all_of(black.begin(), black.end(),
                            [](const glm::vec3& b) { return b == glm::vec3(0.0f); }));
}

TEST(Relighter, EnvironmentsFollowEachOtherWithoutATrace) {
    const prt::Transfer& transfer = relit_scene().transfer;
    Relighter relighter(transfer);
    relighter.set_environment(scenes::random_environment(64, 5, 1e6f));
    relighter.set_environment(scenes::random_environment(12, 6));
    EXPECT_EQ(copy(relighter.radiance()), relight(transfer, scenes::random_environment(12, 6)));
    EXPECT_EQ(relighter.environment().resolution, 12u);
}

TEST(Relighter, RefusesEnvironmentsThatAreNone) {
    Relighter relighter(relit_scene().transfer);
    const cubemap::CubeMap good = scenes::random_environment(16, 7);
    relighter.set_environment(good);
    const auto before = copy(relighter.radiance());
    const auto refused = [&](cubemap::CubeMap environment) {
        EXPECT_THROW(relighter.set_environment(std::move(environment)), std::invalid_argument);
        EXPECT_EQ(copy(relighter.radiance()), before);
        EXPECT_EQ(relighter.environment().texels, good.texels);
    };
    for (const float bad :
         {-1.0f, -1e-30f, std::numeric_limits<float>::quiet_NaN(),
          std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()})
        for (int channel = 0; channel < 3; ++channel) {
            cubemap::CubeMap environment = good;
            environment.at(cubemap::Face::NegativeZ, 15, 15)[channel] = bad;
            refused(environment);
        }
    refused({});
    cubemap::CubeMap short_of_texels = good;
    short_of_texels.texels.pop_back();
    refused(short_of_texels);
}

TEST(Relighter, TakesMinusZeroForBlack) {
    cubemap::CubeMap black(200, glm::vec3(0.0f)); // more texels than are looked at in one go
    const cubemap::CubeMap zero = black;
    black.at(cubemap::Face::NegativeZ, 199, 199) = glm::vec3(-0.0f);
    EXPECT_EQ(relight(relit_scene().transfer, black), relight(relit_scene().transfer, zero));
    black.at(cubemap::Face::NegativeZ, 199, 199) = glm::vec3(-1e-40f);
    EXPECT_THROW(static_cast<void>(relight(relit_scene().transfer, black)), std::invalid_argument);
}

/// A random rectangle of a face with new radiance; sometimes a sun of 1e6, sometimes darkness.
struct Edit {
    TexelRectangle rectangle;
    std::vector<glm::vec3> radiance;

    Edit(std::mt19937& random, std::uint32_t r) {
        std::uniform_int_distribution<std::uint32_t> texel(0, r - 1);
        std::uniform_real_distribution<float> value(0.0f, 1.0f);
        rectangle.face = cubemap::AllFaces[random() % cubemap::NumFaces];
        std::tie(rectangle.x0, rectangle.x1) = std::minmax({texel(random), texel(random)});
        std::tie(rectangle.y0, rectangle.y1) = std::minmax({texel(random), texel(random)});
        ++rectangle.x1;
        ++rectangle.y1;
        const unsigned kind = random() % 4;
        if (kind < 2) { // a sun is small
            rectangle.x1 = rectangle.x0 + 1;
            rectangle.y1 = rectangle.y0 + 1;
        }
        const std::size_t num_texels =
            std::size_t{rectangle.x1 - rectangle.x0} * (rectangle.y1 - rectangle.y0);
        for (std::size_t i = 0; i < num_texels; ++i)
            radiance.push_back((kind == 0   ? 1e6f
                                : kind == 1 ? 0.0f
                                            : 1.0f) *
                               glm::vec3(value(random), value(random), value(random)));
    }
    void apply(cubemap::CubeMap& environment) const {
        std::size_t i = 0;
        for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
            for (std::uint32_t x = rectangle.x0; x < rectangle.x1; ++x)
                environment.at(rectangle.face, x, y) = radiance[i++];
    }
};

/// Puts the whole of `environment` back, face by face.
void restore(Relighter& relighter, const cubemap::CubeMap& environment) {
    const std::uint32_t r = environment.resolution;
    for (const cubemap::Face face : cubemap::AllFaces)
        update_region(relighter, {.face = face, .x1 = r, .y1 = r},
                      std::span(&environment.at(face, 0, 0), std::size_t{r} * r));
}

void expect_a_thousand_edits_without_drift(const prt::Transfer& transfer, const ShadowRays& rays,
                                           std::uint32_t r) {
    const cubemap::CubeMap original = scenes::random_environment(r, 8);
    cubemap::CubeMap environment = original;
    Relighter relighter(transfer, rays);
    relighter.set_environment(original);
    const auto before = copy(relighter.radiance());
    std::mt19937 random(9);
    for (int i = 1; i <= 1000; ++i) {
        const Edit edit(random, r);
        update_region(relighter, edit.rectangle, edit.radiance);
        edit.apply(environment);
        if (i % 100 == 0 || i <= 10) {
            ASSERT_EQ(relighter.environment().texels, environment.texels);
            expect_close(relighter.radiance(), relight(transfer, environment, rays), 1e-5);
        }
    }
    restore(relighter, original);
    // Suns of 1e6 have come and gone: what is left in double is 1e-16 of them for each edit. One
    // float rounding may differ.
    expect_close(relighter.radiance(), before, 2e-7);
}

TEST(RelighterUpdate, AThousandEditsEqualRecomputingAndLeaveNoDrift) {
    expect_a_thousand_edits_without_drift(relit_scene().transfer, {}, 32);
}

TEST(RelighterUpdate, AThousandEditsOfAResolutionThatFitsNoCluster) {
    expect_a_thousand_edits_without_drift(relit_scene().transfer, {}, 20);
}

TEST(RelighterUpdate, AThousandEditsWithShadowRays) {
    expect_a_thousand_edits_without_drift(relit_scene().transfer, relit_scene().shadow_rays(), 32);
}

TEST(RelighterUpdate, AThousandEditsOfASkyThatLightsWholeTiles) {
    expect_a_thousand_edits_without_drift(scenes::relit_floor().transfer, {}, 32);
}

TEST(RelighterUpdate, OnEveryTarget) {
    scenes::on_every_target([] {
        const prt::Transfer& transfer = relit_scene().transfer;
        cubemap::CubeMap environment = scenes::random_environment(16, 10);
        Relighter relighter(transfer);
        relighter.set_environment(environment);
        std::mt19937 random(11);
        for (int i = 0; i < 30; ++i) {
            const Edit edit(random, 16);
            update_region(relighter, edit.rectangle, edit.radiance);
            edit.apply(environment);
        }
        expect_close(relighter.radiance(), relight(transfer, environment), 1e-5);
    });
}

TEST(RelighterUpdate, ASunThatIsGoneLeavesNotEvenItsRounding) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const cubemap::CubeMap dim = scenes::random_environment(32, 12, 1.0f);
    Relighter relighter(transfer);
    relighter.set_environment(dim);
    const auto before = copy(relighter.radiance());
    for (const float sun : {1e6f, 1e10f, 1e20f}) {
        const TexelRectangle texel{
            .face = cubemap::Face::PositiveY, .x0 = 9, .y0 = 20, .x1 = 10, .y1 = 21};
        update_region(relighter, texel, std::vector<glm::vec3>{glm::vec3(sun)});
        EXPECT_NE(copy(relighter.radiance()), before);
        update_region(relighter, texel, std::vector<glm::vec3>{dim.at(texel.face, 9, 20)});
        expect_close(relighter.radiance(), before, 1e-7);
    }
}

TEST(RelighterUpdate, ASunThatWasThereFromTheStartLeavesNotEvenItsRounding) {
    const prt::Transfer& transfer = relit_scene().transfer;
    const cubemap::CubeMap dim = scenes::random_environment(32, 12, 1.0f);
    for (const float sun : {1e3f, 1e6f}) {
        cubemap::CubeMap bright = dim;
        bright.at(cubemap::Face::PositiveY, 9, 20) = glm::vec3(sun);
        Relighter relighter(transfer);
        relighter.set_environment(bright);
        const TexelRectangle texel{
            .face = cubemap::Face::PositiveY, .x0 = 9, .y0 = 20, .x1 = 10, .y1 = 21};
        update_region(relighter, texel, std::vector<glm::vec3>{dim.at(texel.face, 9, 20)});
        expect_close(relighter.radiance(), relight(transfer, dim), 1e-5);
    }
}

TEST(RelighterUpdate, ReportsWhatItTouched) {
    const scenes::RelitScene& scene = relit_scene();
    Relighter relighter(scene.transfer);
    relighter.set_environment(cubemap::CubeMap(64, glm::vec3(1.0f)));
    const TexelRectangle rectangle{
        .face = cubemap::Face::PositiveY, .x0 = 16, .y0 = 8, .x1 = 32, .y1 = 24};
    std::vector<std::uint32_t> leaves;
    scene.transfer.quadtree.find_leaves({rectangle.face, 0.25, 0.125, 0.5, 0.375}, leaves);
    const UpdateReport report =
        update_region(relighter, rectangle, std::vector<glm::vec3>(256, glm::vec3(2.0f)));
    EXPECT_EQ(report.num_clusters, leaves.size());
    EXPECT_GT(report.num_receivers, 0u);
    EXPECT_LE(report.num_receivers, scene.transfer.num_receivers());
}

TEST(RelighterUpdate, EditsThatNothingSeesChangeNothing) {
    const mesh::TriangleMesh floor = scenes::floor_grid(10, 2.0f);
    const prt::Transfer transfer = prt::precompute(prt::vertex_receivers(floor),
                                                   scenes::no_blockers(), {.face_resolution = 32});
    Relighter relighter(transfer);
    relighter.set_environment(scenes::random_environment(32, 13));
    const auto before = copy(relighter.radiance());
    const std::vector<glm::vec3> sun(512, glm::vec3(1e6f));
    for (const TexelRectangle& below :
         {TexelRectangle{.face = cubemap::Face::NegativeY, .x1 = 32, .y1 = 16},
          TexelRectangle{.face = cubemap::Face::PositiveX, .y0 = 16, .x1 = 32, .y1 = 32}}) {
        EXPECT_EQ(update_region(relighter, below, sun).num_receivers, 0u);
        EXPECT_EQ(copy(relighter.radiance()), before);
    }
}

TEST(RelighterUpdate, RefusesWhatDoesNotFitAndChangesNothing) {
    const prt::Transfer& transfer = relit_scene().transfer;
    Relighter relighter(transfer);
    const std::vector<glm::vec3> four(4, glm::vec3(1.0f));
    EXPECT_THROW(update_region(relighter, {.x1 = 2, .y1 = 2}, four), std::invalid_argument)
        << "no environment";
    const cubemap::CubeMap environment = scenes::random_environment(16, 14);
    relighter.set_environment(environment);
    const auto before = copy(relighter.radiance());
    const auto refused = [&](const TexelRectangle& rectangle, std::span<const glm::vec3> radiance) {
        EXPECT_THROW(update_region(relighter, rectangle, radiance), std::invalid_argument);
        EXPECT_EQ(relighter.environment().texels, environment.texels);
        EXPECT_EQ(copy(relighter.radiance()), before);
    };
    refused({.x0 = 15, .y0 = 0, .x1 = 17, .y1 = 2}, four);
    refused({.x0 = 0, .y0 = 15, .x1 = 2, .y1 = 17}, four);
    refused({.x0 = 2, .y0 = 2, .x1 = 2, .y1 = 4}, four);
    refused({.x0 = 3, .y0 = 3, .x1 = 1, .y1 = 1}, four);
    refused({}, {});
    refused({.x0 = 0xfffffffe, .x1 = 0xffffffff, .y1 = 4}, four);
    refused({.x1 = 2, .y1 = 3}, four);
    refused({.x1 = 1, .y1 = 1}, four);
    for (const float bad :
         {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<glm::vec3> radiance = four;
        radiance.back().g = bad;
        refused({.x1 = 2, .y1 = 2}, radiance);
    }
    update_region(relighter, {.x1 = 2, .y1 = 2}, four); // and still works
    EXPECT_NE(copy(relighter.radiance()), before);
}

TEST(RelighterUpdate, AnyNumberOfThreadsGivesTheSameBits) {
    for (const ShadowRays& rays : {ShadowRays{}, relit_scene().shadow_rays()}) {
        std::vector<std::vector<glm::vec3>> results;
        for (const std::size_t num_threads : {1u, 2u, 3u}) {
            const files::ThreadLimit threads(num_threads);
            Relighter relighter(relit_scene().transfer, rays);
            relighter.set_environment(scenes::random_environment(32, 15, 1e5f));
            std::vector<glm::vec3> result = copy(relighter.radiance());
            std::mt19937 random(16);
            for (int i = 0; i < 20; ++i) {
                const Edit edit(random, 32);
                update_region(relighter, edit.rectangle, edit.radiance);
            }
            result.insert(result.end(), relighter.radiance().begin(), relighter.radiance().end());
            results.push_back(std::move(result));
        }
        EXPECT_EQ(results[0], results[1]);
        EXPECT_EQ(results[0], results[2]);
    }
}

TEST(Relighter, RefusesShadowRaysForOtherReceivers) {
    ShadowRays rays = relit_scene().shadow_rays();
    rays.positions = rays.positions.first(3);
    EXPECT_THROW(Relighter(relit_scene().transfer, rays), std::invalid_argument);
}

} // namespace
} // namespace relumine::relight
