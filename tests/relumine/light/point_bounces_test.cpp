// Light that surfaces send to points in space: radiance, harmonics, and backwards.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "prt/bounces/point_rows.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/receivers.h"
#include "relight/harmonics/harmonics.h"
#include "relumine/out/probe_balls.h"
#include "tests/relight/adjoint/inner_products.h"
#include "tests/relight/arrays.h"
#include "tests/relumine/light/relit_lit_scene.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

class PointBouncesFile : public scenes::InFolder {};

using Colors = std::vector<glm::vec3>;
using relight::copy;
using relight::num_harmonics;
using scenes::inner;
using scenes::random_weights;
using scenes::relative_difference;
using scenes::sun_and_sky;

const LightOptions NineCoefficients{.harmonics = 3};

PrecomputeOptions point_options(const ReceiverChoice& receivers) {
    return {.receivers = receivers, .no_refine = true, .bounce_tolerance = 0.01f};
}

/// Points in the corner, before the wall and over the floor.
Points points_of_corner() {
    Points points;
    for (int i = 0; i < 40; ++i)
        points.positions.emplace_back(0.1f + 0.02f * static_cast<float>(i),
                                      0.05f + 0.11f * static_cast<float>(i % 8),
                                      0.06f + 0.13f * static_cast<float>(i / 8));
    return points;
}

const Scene& corner_scene() {
    static const Scene scene = precompute(scenes::corner(33), point_options(points_of_corner()));
    return scene;
}

LitScene lit_corner(const BounceLimits& limits = {}) {
    LitScene lit(corner_scene(), NineCoefficients);
    lit.light(sun_and_sky());
    lit.bounce({.albedo = bounce_albedo(lit.scene()), .limits = limits});
    return lit;
}

TEST(EvenDirections, SumUpToNothing) {
    glm::dvec3 sum(0.0);
    glm::dmat3 squares(0.0);
    const std::vector<glm::dvec3> directions = prt::even_directions(1024);
    for (const glm::dvec3& direction : directions) {
        EXPECT_NEAR(glm::length(direction), 1.0, 1e-12);
        sum += direction / 1024.0;
        squares += glm::outerProduct(direction, direction) / 1024.0;
    }
    EXPECT_LT(glm::length(sum), 1e-3);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(squares[i][j], i == j ? 1.0 / 3.0 : 0.0, 1e-3);
    EXPECT_EQ(prt::num_point_directions(0.01f), 1024u);
    EXPECT_EQ(prt::num_point_directions(1.0f), 128u);
    EXPECT_EQ(prt::num_point_directions(1e-6f), 16384u);
}

/// Over a square of side 2 under a white sky, from the middle: the square covers the solid angle
/// 4 asin(1 / (1 + h^2)) and sends its albedo.
TEST(PointBounces, OfASquareAreItsSolidAngle) {
    constexpr float Albedo = 0.6f;
    mesh::TriangleMesh square = scenes::two_squares();
    square.triangles.resize(2);
    Points points;
    const std::vector<float> heights = {0.3f, 1.0f, 2.5f};
    for (const float height : heights)
        points.positions.emplace_back(0.0f, height, 0.0f);
    LitScene lit(precompute(square, point_options(points)), NineCoefficients);
    lit.light(cubemap::CubeMap(8, glm::vec3(1.0f)));
    const Colors direct = copy(lit.radiance());
    const Colors direct_harmonics = lit.harmonics();
    const Colors albedo(lit.scene().receivers.size(), glm::vec3(Albedo));
    lit.bounce({.albedo = albedo});
    const Colors all = copy(lit.radiance());
    const Colors harmonics = lit.harmonics();
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const double squared = double{heights[i]} * double{heights[i]};
        const double covered = std::asin(1.0 / (1.0 + squared)) / std::numbers::pi;
        EXPECT_NEAR(direct[i].g, 1.0 - covered, 2e-3);
        EXPECT_NEAR(all[i].g, 1.0 - covered + double{Albedo} * covered, 3e-3);
        // The light comes from below: the sky's share grows by what the square sends.
        const std::size_t up = i * 9 + 1;
        EXPECT_NEAR(harmonics[up].g, direct_harmonics[up].g * (1.0f - Albedo), 6e-3f);
        EXPECT_NEAR(relight::mean_radiance(harmonics[i * 9]).g, all[i].g, 1e-5f);
    }
    // No bounce at all is direct light; a second one brings nothing to a square.
    lit.bounce({.albedo = albedo, .limits = {.num_bounces = 0}});
    EXPECT_EQ(copy(lit.radiance()), direct);
    EXPECT_EQ(lit.harmonics(), direct_harmonics);
    lit.bounce({.albedo = albedo, .limits = {.num_bounces = 1}});
    const Colors once = copy(lit.radiance());
    lit.bounce({.albedo = albedo, .limits = {.num_bounces = 2}});
    EXPECT_EQ(copy(lit.radiance()), once);
    EXPECT_LT(relative_difference(once, all), 1e-6);
}

/// Against rays into many more directions, which take the light where they hit.
TEST(PointBounces, AreWhatRaysFind) {
    constexpr std::uint32_t NumRays = 20000;
    LitScene lit = lit_corner();
    const Scene& scene = lit.scene();
    const std::size_t num_own = scene.receivers.num_own();
    Colors sent = copy(lit.radiance());
    const Colors albedo = bounce_albedo(scene);
    for (std::size_t i = 0; i < sent.size(); ++i)
        sent[i] *= albedo[i];
    const Colors of_vertices = prt::vertex_values(scene.mesh, scene.receivers, sent);
    LitScene direct(scene, NineCoefficients);
    direct.light(sun_and_sky());
    Colors expected = direct.harmonics(), found = lit.harmonics();
    const Colors without = expected;
    for (std::size_t point = 0; point < num_own; ++point)
        for (const glm::dvec3& direction : prt::even_directions(NumRays)) {
            const auto hit = lit.rays().of_mesh().closest_hit(scene.receivers.positions[point],
                                                              glm::vec3(direction));
            if (!hit || !prt::meets_front(scene.mesh, {hit->triangle, hit->barycentric},
                                          glm::vec3(direction)))
                continue;
            const glm::vec3 light =
                prt::value_at(scene.mesh, of_vertices, {hit->triangle, hit->barycentric});
            const auto basis = relight::harmonics(direction);
            for (std::size_t k = 0; k < 9; ++k)
                expected[point * 9 + k] +=
                    light * static_cast<float>(basis[k] * 4.0 * std::numbers::pi / NumRays);
        }
    found.resize(num_own * 9);
    expected.resize(num_own * 9);
    EXPECT_LT(relative_difference(found, expected), 0.005);
    EXPECT_GT(relative_difference(std::span(without).first(num_own * 9), expected), 0.05);
}

TEST(PointBounces, StepsEndWhereSolvingDoes) {
    LitScene lit = lit_corner();
    const Colors solved = copy(lit.radiance());
    lit.light(cubemap::CubeMap(16, glm::vec3(0.1f)));
    lit.bounce();
    lit.light(sun_and_sky());
    for (int i = 0; i < 12; ++i)
        lit.bounce({.is_step = true});
    EXPECT_LT(relative_difference(lit.radiance(), solved), 1e-3);
    EXPECT_EQ(lit_corner().harmonics(), lit_corner().harmonics());
}

TEST(PointBounces, BackwardsAreTheTranspose) {
    for (const BounceLimits limits : {BounceLimits{.tolerance = 1e-7}, BounceLimits{3}}) {
        LitScene lit = lit_corner(limits);
        const Colors environment = lit.relighter().environment().texels;
        for (std::uint32_t seed = 1; seed < 6; ++seed) {
            // Points and the vertices behind them.
            const Colors weights = random_weights(lit.radiance().size(), seed);
            const double forward = inner(lit.radiance(), weights);
            EXPECT_NEAR(inner(environment, adjoint(lit, weights).texels), forward,
                        2e-5 * std::abs(forward) + 1e-4);
            const Colors light = lit.harmonics();
            const Colors of_harmonics = random_weights(light.size(), seed);
            const double all = inner(light, of_harmonics);
            EXPECT_NEAR(inner(environment, harmonics_adjoint(lit, of_harmonics).texels), all,
                        2e-5 * std::abs(all) + 1e-4);
        }
        const std::vector<std::uint32_t> asked = {3, 17};
        const cubemap::CubeMap share = contribution_map(lit, asked);
        double sum = 0.0;
        const std::vector<double> solid_angles = cubemap::texel_solid_angles(share.resolution);
        for (std::size_t i = 0; i < share.texels.size(); ++i)
            sum += double{share.texels[i].g} * solid_angles[i % solid_angles.size()];
        const double expected = 0.5 * double{lit.radiance()[3].g + lit.radiance()[17].g};
        EXPECT_NEAR(sum, expected, 1e-3 * expected);
    }
}

/// White balls under a white sky are white; behind them stands the mesh with its own light.
TEST(ProbeBalls, ShowEachPointBeforeTheLitMesh) {
    const auto balls_of = [](const Scene& scene) {
        return ProbeBalls(scene);
    };
    PrecomputeOptions high = point_options(Points{.positions = {{0.5f, 300.0f, 0.5f}}});
    high.bounce_tolerance = 0.0f;
    LitScene open(precompute(scenes::corner(3), high), NineCoefficients);
    open.light(cubemap::CubeMap(8, glm::vec3(1.0f)));
    const ProbeBalls one = balls_of(open.scene());
    for (const glm::vec3& light : one.radiance(open))
        EXPECT_NEAR(light.g, 1.0f, 2e-3f);
    EXPECT_EQ(one.receiver_of(0), 0u);
    EXPECT_FALSE(one.receiver_of(static_cast<std::uint32_t>(one.mesh().num_vertices()) - 1));

    const LitScene lit = lit_corner();
    const ProbeBalls balls = balls_of(lit.scene());
    const std::vector<glm::vec3> light = balls.radiance(lit), albedo = balls.albedo(lit.scene());
    const std::size_t num_behind = lit.scene().mesh.num_vertices();
    ASSERT_EQ(light.size(), balls.mesh().num_vertices());
    ASSERT_EQ(balls.mesh().num_triangles(), 40u * 128u + lit.scene().mesh.num_triangles());
    for (std::size_t i = light.size() - num_behind; i < light.size(); ++i) {
        const std::optional<std::uint32_t> receiver =
            balls.receiver_of(static_cast<std::uint32_t>(i));
        ASSERT_TRUE(receiver);
        EXPECT_GE(*receiver, 40u);
        EXPECT_EQ(light[i], lit.radiance()[*receiver]);
        EXPECT_EQ(albedo[i], bounce_albedo(lit.scene())[*receiver]);
    }
    const Scene of_vertices = precompute(
        scenes::corner(3), {.receivers = Vertices{}, .no_refine = true, .bounce_tolerance = 0.0f});
    EXPECT_THROW(static_cast<void>(balls_of(of_vertices)), std::invalid_argument);
}

TEST_F(PointBouncesFile, AreKeptAndChecked) {
    save_scene(file("points.prt"), corner_scene());
    const Scene read = load_scene(file("points.prt"));
    EXPECT_EQ(read.bounces, corner_scene().bounces);
    EXPECT_EQ(read.receivers.points, corner_scene().receivers.points);
    EXPECT_EQ(read.transfer.num_points, 40u);
    LitScene lit(read, NineCoefficients);
    lit.light(sun_and_sky());
    lit.bounce({.albedo = bounce_albedo(lit.scene())});
    EXPECT_EQ(lit.harmonics(), lit_corner().harmonics());
    refuses_damage(
        read, [](Scene& scene) { scene.bounces->points.emitters[5] = 1u << 30; }, "number");
    refuses_damage(
        read, [](Scene& scene) { scene.bounces->points.emitters[5] = 7; },
        "light that comes from vertices");
    refuses_damage(
        read, [](Scene& scene) { scene.bounces->points.emitters.pop_back(); }, "directions");
}

} // namespace
} // namespace relumine
