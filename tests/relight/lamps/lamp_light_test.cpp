// Lamps against closed forms and integrals.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/lamps/lamps.h"
#include "prt/visibility/ray_scene.h"
#include "relight/lamps/emitter_tree.h"
#include "relight/lamps/lamp_light.h"
#include "relight/lamps/punctual.h"
#include "tests/prt/scenes.h"

namespace relumine::relight {
namespace {

using Kind = mesh::PunctualLight::Kind;

constexpr double Pi = std::numbers::pi;

/// Makes all triangles from `first` on glow.
mesh::TriangleMesh glowing(mesh::TriangleMesh mesh, std::size_t first, const glm::vec3& emission) {
    mesh.materials = {{.name = "dark"}, {.name = "lamp", .emission = emission}};
    mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    std::fill(mesh.triangle_materials.begin() + static_cast<std::ptrdiff_t>(first),
              mesh.triangle_materials.end(), 1u);
    return mesh;
}

/// What a mesh's lamps give to one place.
glm::vec3 light_at(const mesh::TriangleMesh& mesh, const glm::vec3& position,
                   const glm::vec3& normal, bool two_sided = false) {
    const prt::Lamps lamps = prt::lamps_of(mesh);
    const prt::RayScene rays(mesh);
    return lamp_light(mesh, lamps.emitters, lamps.lights,
                      {.positions = std::span(&position, 1),
                       .normals = std::span(&normal, 1),
                       .rays = rays,
                       .bias = 1e-5f,
                       .two_sided = two_sided})
        .front();
}

/// A square of side 2 a at height h that faces down.
mesh::TriangleMesh ceiling(float a, float h) {
    mesh::TriangleMesh mesh;
    mesh.positions = {{-a, h, -a}, {a, h, -a}, {a, h, a}, {-a, h, a}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.normals.assign(4, {0, -1, 0});
    return glowing(mesh, 0, {1.0f, 2.0f, 0.5f});
}

/// The form factor of a square above the middle of a surface that faces it: four times that of a
/// rectangle with a corner over the surface (Howell, A Catalog of Radiation Configuration Factors,
/// B-3).
double form_factor(double a, double h) {
    const double r = std::sqrt(a * a + h * h);
    return 4.0 / Pi * a / r * std::atan(a / r);
}

TEST(LampLight, OfASquareIsTheClosedForm) {
    for (const float h : {0.01f, 0.5f, 2.0f, 30.0f}) {
        const glm::vec3 light = light_at(ceiling(1.0f, h), glm::vec3(0.0f), {0, 1, 0});
        const double expected = form_factor(1.0, double{h} - 1e-5);
        EXPECT_NEAR(light.r / expected, 1.0, 0.002) << h;
        EXPECT_NEAR(light.g, 2.0f * light.r, 1e-6f);
        EXPECT_NEAR(light.b, 0.5f * light.r, 1e-6f);
    }
}

// A wall that stands under the middle of a lamp sees half of it above its horizon.
TEST(LampLight, EndsAtTheHorizon) {
    double sum = 0.0;
    constexpr int Steps = 400;
    for (int i = 0; i < Steps; ++i)
        for (int j = 0; j < Steps; ++j) {
            const glm::dvec3 at((i + 0.5) / Steps, 0.5, 2.0 * (j + 0.5) / Steps - 1.0);
            const double d = glm::length(at);
            sum += at.x * at.y / (Pi * d * d * d * d) * 2.0 / (Steps * Steps);
        }
    EXPECT_NEAR(light_at(ceiling(1.0f, 0.5f), glm::vec3(0.0f), {1, 0, 0}).r, sum, 1e-4);
    EXPECT_EQ(light_at(ceiling(1.0f, 0.5f), glm::vec3(0.0f), {0, -1, 0}), glm::vec3(0.0f));
}

TEST(LampLight, BacksGlowWhereTheyAreAsked) {
    const mesh::TriangleMesh lamp = ceiling(1.0f, 1.0f);
    EXPECT_EQ(light_at(lamp, {0, 2, 0}, {0, -1, 0}), glm::vec3(0.0f));
    EXPECT_NEAR(light_at(lamp, {0, 2, 0}, {0, -1, 0}, true).r, form_factor(1.0, 1.0), 1e-4);
}

// A sphere of radiance 1 gives (r / d)^2 to a surface that faces it, near and far; thousands of
// triangles count together.
TEST(LampLight, OfASphereIsThatOfItsSolidAngle) {
    const mesh::TriangleMesh sphere =
        glowing(scenes::icosphere(4, 1.0f, glm::vec3(0.0f)), 0, glm::vec3(1.0f));
    // The volume of the triangles within, to the power of 2/3, is what they lack of the sphere.
    double area = 0.0;
    for (const auto& [a, b, c] : sphere.triangles)
        area += 0.25 * double{glm::length(glm::cross(sphere.positions[b] - sphere.positions[a],
                                                     sphere.positions[c] - sphere.positions[a]))};
    const double lacks = area / (2.0 * Pi);
    for (const float d : {1.2f, 2.0f, 5.0f, 40.0f})
        EXPECT_NEAR(double{light_at(sphere, {0, -d, 0}, {0, 1, 0}).r} * double{d} * double{d},
                    lacks, 0.02)
            << d;
}

// A slab of 768 parts, whose fronts and sides lie beside each other, is some points from afar, also
// where the horizon cuts it.
TEST(EmitterTree, FarPartsCountTogether) {
    const mesh::TriangleMesh slab = scenes::box({-0.5f, -0.1f, -0.02f}, {0.5f, 0.1f, 0.02f});
    std::vector<prt::Emitter> emitters;
    for (std::uint32_t triangle = 0; triangle < slab.num_triangles(); ++triangle)
        for (std::uint32_t part = 64; part < 128; ++part)
            emitters.push_back(
                {.triangle = triangle, .part = part, .radiance = glm::vec3(1.0f, 2.0f, 3.0f)});
    const EmitterTree tree(slab, emitters, false);
    std::mt19937 random(5);
    std::vector<EmitterTree::Seen> seen;
    for (int round = 0; round < 500; ++round) {
        const glm::dvec3 to_slab(scenes::random_direction(random));
        const double distance = round % 2 == 0 ? 4.0 : 20.0;
        const glm::dvec3 place = -distance * to_slab;
        glm::dvec3 normal(scenes::random_direction(random));
        if (round % 3 == 0) // its middle lies on the horizon
            normal = glm::normalize(normal - glm::dot(normal, to_slab) * to_slab);
        double expected = 0.0, facing = 0.0;
        for (const prt::Emitter& emitter : emitters) {
            std::array<glm::dvec3, 3> corners = prt::corners_of(slab, emitter);
            if (glm::dot(prt::front_of(slab, emitter.triangle), place - corners[0]) <= 0.0)
                continue;
            for (glm::dvec3& corner : corners)
                corner -= place;
            expected += triangle_light(corners, normal);
            facing += triangle_light(corners, to_slab);
        }
        tree.look(place, normal, seen);
        double light = 0.0;
        for (const EmitterTree::Seen& part : seen) {
            light += part.light.r;
            EXPECT_NEAR(part.light.b, 3.0 * part.light.r, 1e-12);
        }
        EXPECT_NEAR(light, expected, 0.005 * facing) << round;
        EXPECT_LT(seen.size(), 100u) << round;
    }
}

// Half of a lamp is behind an edge, as seen from the middle.
TEST(LampLight, AHalfShadowIsHalf) {
    mesh::TriangleMesh lamp = ceiling(1.0f, 2.0f);
    mesh::TriangleMesh shade = scenes::box({0.0f, 0.9f, -9.0f}, {9.0f, 1.0f, 9.0f});
    const mesh::TriangleMesh both =
        glowing(scenes::joined(shade, lamp), shade.num_triangles(), glm::vec3(1.0f));
    const float whole = light_at(lamp, glm::vec3(0.0f), {0, 1, 0}).r;
    EXPECT_NEAR(light_at(both, glm::vec3(0.0f), {0, 1, 0}).r / whole, 0.5f, 0.03f);
    EXPECT_EQ(light_at(both, {3, 0, 0}, {0, 1, 0}).r, 0.0f);
    EXPECT_NEAR(light_at(both, {-3, 0, 0}, {0, 1, 0}).r, light_at(lamp, {-3, 0, 0}, {0, 1, 0}).r,
                1e-6f);
}

/// The light of one lamp on a surface that faces up, without anything between.
double on_floor(const mesh::PunctualLight& light, const glm::vec3& place) {
    mesh::TriangleMesh below = scenes::floor_grid(2, 1.0f, -5.0f);
    return punctual_light(light, place, {0, 1, 0}, prt::RayScene(below)).g;
}

TEST(PunctualLight, FallsWithTheSquareOfTheDistanceUpToItsRange) {
    mesh::PunctualLight light{.intensity = {0.0f, 8.0f, 0.0f}, .position = {0, 2, 0}};
    EXPECT_NEAR(on_floor(light, glm::vec3(0.0f)), 8.0 / (4.0 * Pi), 1e-6);
    EXPECT_NEAR(on_floor(light, {2, 0, 0}), 8.0 / (8.0 * Pi) * std::sqrt(0.5), 1e-6);
    light.range = 4.0f;
    EXPECT_NEAR(on_floor(light, glm::vec3(0.0f)), 8.0 / (4.0 * Pi) * (1.0 - 1.0 / 16.0), 1e-6);
    EXPECT_EQ(on_floor(light, {4, 0, 0}), 0.0);
    EXPECT_EQ(on_floor(light, {0, 3, 0}), 0.0) << "below the horizon";
}

TEST(PunctualLight, SpotsHaveCones) {
    mesh::PunctualLight light{.kind = Kind::Spot,
                              .position = {0, 1, 0},
                              .direction = {0, -1, 0},
                              .inner_cone = 0.3f,
                              .outer_cone = 0.6f};
    const auto part = [&](double angle) {
        const double x = std::tan(angle), d = std::sqrt(1.0 + x * x);
        return on_floor(light, {static_cast<float>(x), 0, 0}) * Pi * d * d * d;
    };
    EXPECT_NEAR(part(0.0), 1.0, 1e-6);
    EXPECT_NEAR(part(0.299), 1.0, 1e-3);
    const double between = (std::cos(0.45) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
    EXPECT_NEAR(part(0.45), between * between, 1e-5);
    EXPECT_EQ(part(0.61), 0.0);
}

/// A profile of one intensity, or of the cosine to its axis.
mesh::LightProfile profile_of(const std::vector<float>& horizontal, double last,
                              const std::function<double(double, double)>& candela) {
    mesh::LightProfileTable table{.horizontal = horizontal};
    for (double v = 0.0; v <= last; v += 0.5)
        table.vertical.push_back(static_cast<float>(v));
    for (const float h : horizontal)
        for (const float v : table.vertical)
            table.candela.push_back(static_cast<float>(candela(double{v}, double{h})));
    return mesh::LightProfile(table);
}

TEST(PunctualLight, ConstantProfilesArePoints) {
    const mesh::PunctualLight point{.intensity = {0, 6, 0}, .position = {0.1f, 2, 0.2f}};
    mesh::PunctualLight light = point;
    light.kind = Kind::Profile;
    light.intensity = {0, 2, 0};
    light.profile = profile_of({0}, 180.0, [](double, double) { return 3.0; });
    for (const glm::vec3& place : {glm::vec3(0.0f), glm::vec3(3, 0, 0), glm::vec3(0, 1.9f, -5)})
        EXPECT_NEAR(on_floor(light, place) / on_floor(point, place), 1.0, 1e-6);
}

// A lamp of Lambert's law over a floor: I cos^4 / h^2.
TEST(PunctualLight, CosineProfilesHaveTheClosedForm) {
    const mesh::PunctualLight light{
        .kind = Kind::Profile,
        .position = {0, 2, 0},
        .direction = {0, -1, 0},
        .profile =
            profile_of({0}, 90.0, [](double v, double) { return 5.0 * std::cos(v * Pi / 180.0); }),
        .right = {1, 0, 0},
        .up = {0, 0, -1}};
    for (const double angle : {0.0, 0.3, 0.8, 1.3}) {
        const double x = 2.0 * std::tan(angle);
        EXPECT_NEAR(on_floor(light, {static_cast<float>(x), 0, 0}) /
                        (5.0 * std::pow(std::cos(angle), 4.0) / 4.0 / Pi),
                    1.0, 1e-4);
    }
}

// What a closed ball around the lamp receives is its flux.
TEST(PunctualLight, AllOfTheFluxArrives) {
    const mesh::PunctualLight light{
        .kind = Kind::Profile,
        .direction = glm::normalize(glm::vec3(1, -2, 0.5f)),
        .profile = profile_of({0, 90, 180, 270, 360}, 120.0,
                              [](double v, double h) { return (v + 1.0) * (h < 300 ? h + 5 : 5); }),
        .right = glm::normalize(glm::vec3(2, 1, 0)),
        .up = glm::normalize(glm::cross(glm::vec3(2, 1, 0), glm::vec3(1, -2, 0.5f)))};
    constexpr int Steps = 400;
    double sum = 0.0;
    for (int i = 0; i < Steps; ++i)
        for (int j = 0; j < Steps; ++j) {
            const double theta = (i + 0.5) * Pi / Steps, phi = (j + 0.5) * 2.0 * Pi / Steps;
            sum +=
                std::sin(theta) *
                arriving(light, 3.0 * glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                                 std::sin(theta) * std::sin(phi)))
                    .irradiance.r *
                9.0;
        }
    EXPECT_NEAR(sum * 2.0 * Pi * Pi / (Steps * Steps) / light.profile.flux(), 1.0, 2e-3);
}

// Down is vertical 0; from above, horizontal angles go from right to up, counter-clockwise.
TEST(PunctualLight, ProfilesAreOriented) {
    const mesh::PunctualLight light{
        .kind = Kind::Profile,
        .direction = {0, -1, 0},
        .profile = profile_of(
            {0, 90, 180, 270, 360}, 180.0,
            [](double v, double h) { return 1000.0 * v + (v > 0.0 && h < 360.0 ? h : 0.0); }),
        .right = {1, 0, 0},
        .up = {0, 0, -1}};
    const auto candela = [&](const glm::dvec3& place) {
        return arriving(light, place).irradiance.r * glm::dot(place, place);
    };
    EXPECT_NEAR(candela({0, -2, 0}), 0.0, 1e-6);
    EXPECT_NEAR(candela({2, 0, 0}), 90e3 + 0.0, 1e-2);
    EXPECT_NEAR(candela({0, 0, -2}), 90e3 + 90.0, 1e-2);
    EXPECT_NEAR(candela({-2, 0, 0}), 90e3 + 180.0, 1e-2);
    EXPECT_NEAR(candela({0, 0, 2}), 90e3 + 270.0, 1e-2);
    EXPECT_NEAR(candela({0, 2, 0}), 180e3, 300.0);
    EXPECT_NEAR(candela({1, -1, 0}), 45e3, 1e-2);
}

TEST(PunctualLight, DirectionalOnesComeFromFarAway) {
    const glm::vec3 down = glm::normalize(glm::vec3(0.0f, -3.0f, 4.0f));
    const mesh::PunctualLight light{
        .kind = Kind::Directional, .intensity = glm::vec3(2.0f), .direction = down};
    EXPECT_NEAR(on_floor(light, {100, 0, 3}), 2.0 * 0.6 / Pi, 1e-6);
}

TEST(PunctualLight, ShadowsEndAtTheLight) {
    mesh::PunctualLight light{.position = {0, 1, 0}};
    const prt::RayScene above(scenes::floor_grid(2, 1.0f, 2.0f));
    const prt::RayScene between(scenes::floor_grid(2, 1.0f, 0.5f));
    EXPECT_GT(punctual_light(light, glm::vec3(0.0f), {0, 1, 0}, above).r, 0.0);
    EXPECT_EQ(punctual_light(light, glm::vec3(0.0f), {0, 1, 0}, between).r, 0.0);
}

} // namespace
} // namespace relumine::relight
