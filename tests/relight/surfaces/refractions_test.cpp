// Rays through glass against Snell's law, and that glass loses no light.
#include "relight/surfaces/refractions.h"

#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/frame.h"
#include "prt/glossy/surface_sampling.h"
#include "relight/pictures/picture_view.h"
#include "relight/surfaces/visible_normals.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

constexpr float Bias = 1e-4f;

mesh::Material glass(float roughness, float thickness, float index = 1.5f) {
    mesh::Material material{.name = "glass", .model = mesh::MaterialModel::MetallicRoughness};
    material.metallic = 0.0f;
    material.roughness = roughness;
    material.transmission = 1.0f;
    material.thickness = thickness;
    material.ior = index;
    material.is_double_sided = false;
    return material;
}

/// A mesh of one glass in an environment.
struct Scene {
    mesh::TriangleMesh mesh;
    cubemap::CubeMap sky;
    prt::RayScene rays;
    std::vector<prt::Surface> surfaces;
    SurfaceColors colors;
    Reflections reflections;
    std::vector<glm::vec3> black;
    MeshLight light;

    Scene(mesh::TriangleMesh shape, const mesh::Material& material, cubemap::CubeMap around,
          std::uint32_t num_rays = 32)
        : mesh(of(std::move(shape), material)), sky(std::move(around)), rays(mesh),
          surfaces(prt::vertex_surfaces(mesh)), colors(mesh, surfaces),
          reflections(rays, Bias, num_rays, sky, {}), black(mesh.num_vertices(), glm::vec3(0.0f)) {
        light.radiance = black;
        light.mirrored = black;
        light.surfaces = surfaces;
        light.textures = &colors;
        light.reflections = &reflections;
        light.bias = Bias;
    }

    static mesh::TriangleMesh of(mesh::TriangleMesh mesh, const mesh::Material& material) {
        mesh.materials = {material};
        mesh.triangle_materials.assign(mesh.num_triangles(), 0);
        return mesh;
    }

    /// What goes on to the eye through the first surface in a direction; none where it does not
    /// bend.
    std::optional<glm::vec3> seen(const glm::vec3& eye, const glm::vec3& direction) {
        light.eye = eye;
        const prt::TwinTriangles twins(mesh);
        const FadingFloor floor;
        const prt::TextureView view;
        const Mirrors mirrors(mesh, rays, twins, light, floor, nullptr, view);
        const Refractions refractions(mesh, rays, light, mirrors, view);
        const auto hit = rays.closest_hit(eye, direction, prt::RayOf::Eye);
        const prt::MeshPoint at{.triangle = hit.value().triangle,
                                .barycentric = hit.value().barycentric};
        const std::optional<Mirror> mirror = mirrors.at(at);
        if (!mirror || !refractions.bends(*mirror, at))
            return std::nullopt;
        return refractions.light(*mirror, at, 0, {0.3f, 0.6f});
    }
};

/// What the first surface does not mirror.
float passed_part(float cosine, float index) {
    const float f0 = std::pow((index - 1.0f) / (index + 1.0f), 2.0f);
    return (1.0f - f0) * (1.0f - std::pow(1.0f - cosine, 5.0f));
}

TEST(Refractions, BendAsABallOfGlass) {
    constexpr float Index = 1.5f;
    Scene scene(scenes::icosphere(5, 1.0f, {}), glass(0.0f, 1.0f, Index),
                scenes::smooth_environment(128));
    for (const float height : {0.0f, 0.3f, 0.6f, 0.8f}) {
        const glm::vec3 found = scene.seen({0.0f, height, 5.0f}, {0.0f, 0.0f, -1.0f}).value();
        const float enters = std::asin(height), inside = std::asin(height / Index);
        const float turn = 2.0f * (enters - inside);
        const glm::vec3 leaves(0.0f, -std::sin(turn), -std::cos(turn));
        const glm::vec3 expected =
            passed_part(std::cos(enters), Index) * cubemap::sample(scene.sky, leaves);
        EXPECT_LT(glm::distance(found, expected), 0.02f * glm::length(expected)) << height;
        if (height > 0.5f) {
            const glm::vec3 straight = cubemap::sample(scene.sky, {0.0f, 0.0f, -1.0f});
            EXPECT_GT(glm::distance(expected, straight), 0.1f) << "it would show no bending";
        }
    }
}

/// A prism, upright, whose edge of 30 degrees points along +X.
mesh::TriangleMesh prism() {
    const float slope = std::tan(glm::radians(15.0f));
    const glm::vec3 edge(1.0f, 0.0f, 0.0f), left(-1.0f, 0.0f, 2.0f * slope),
        right(-1.0f, 0.0f, -2.0f * slope), high(0.0f, 9.0f, 0.0f);
    mesh::TriangleMesh mesh;
    for (const auto& [a, b] : {std::pair(edge, right), {right, left}, {left, edge}}) {
        const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
        for (const glm::vec3& corner : {a - high, b - high, b + high, a + high}) {
            mesh.positions.push_back(corner);
            mesh.normals.push_back(glm::normalize(glm::cross(b - a, high)));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

/// Red, green and blue leave a prism where Snell's law sends light of their index.
TEST(Refractions, PartColors) {
    constexpr float Index = 1.6f, Apex = 30.0f;
    mesh::Material material = glass(0.0f, 1.0f, Index);
    for (const float dispersion : {0.0f, 0.36f, 4.0f}) {
        material.dispersion = dispersion;
        Scene scene(prism(), material, scenes::smooth_environment(128));
        for (const float enters : {-40.0f, -15.0f, 0.0f}) {
            // Degrees from the normal of the face towards +Z, positive on the side of the edge.
            const float way = glm::radians(enters + Apex / 2.0f);
            const glm::vec3 direction(-std::sin(way), 0.0f, -std::cos(way));
            const glm::vec3 found =
                scene.seen(glm::vec3(0.5f, 0.0f, 0.1f) - 3.0f * direction, direction).value();
            for (const int color : {0, 1, 2}) {
                // KHR_materials_dispersion: 20 over (nd - 1) / (nF - nC).
                const float index = Index + static_cast<float>(color - 1) * 0.5f * dispersion *
                                                (Index - 1.0f) / 20.0f;
                const float inside = std::asin(std::sin(glm::radians(enters)) / index);
                const float behind = std::asin(index * std::sin(glm::radians(Apex) + inside));
                const float leaves = behind - glm::radians(Apex / 2.0f);
                const float expected =
                    passed_part(std::cos(glm::radians(enters)), Index) *
                    cubemap::sample(scene.sky, {-std::sin(leaves), 0.0f, -std::cos(leaves)})[color];
                EXPECT_NEAR(found[color], expected, 0.005f * expected)
                    << dispersion << " " << enters << " " << color;
            }
        }
    }
}

/// A second body parts the colours of light that the first one did not.
TEST(Refractions, PartColorsBehindOtherGlass) {
    mesh::Material plain = glass(0.0f, 1.0f, 1.5f), flint = glass(0.0f, 1.0f, 1.6f);
    flint.dispersion = 4.0f;
    const auto seen = [&](const mesh::Material& behind) {
        mesh::TriangleMesh shapes = prism();
        for (glm::vec3& position : shapes.positions)
            position.z -= 3.0f;
        const auto num_behind = static_cast<std::uint32_t>(shapes.num_vertices());
        const std::size_t num_triangles = shapes.num_triangles();
        mesh::TriangleMesh slab = scenes::box({-9, -9, -1}, {9, 9, 0});
        for (glm::vec3& normal : slab.normals)
            normal = {0.0f, 0.0f, glm::sign(normal.z)};
        shapes.positions.insert(shapes.positions.end(), slab.positions.begin(),
                                slab.positions.end());
        shapes.normals.insert(shapes.normals.end(), slab.normals.begin(), slab.normals.end());
        for (const auto& [a, b, c] : slab.triangles)
            shapes.triangles.push_back({a + num_behind, b + num_behind, c + num_behind});
        Scene scene(shapes, plain, scenes::smooth_environment(128));
        scene.mesh.materials = {plain, behind};
        for (std::size_t i = 0; i < num_triangles; ++i)
            scene.mesh.triangle_materials[i] = 1;
        return scene.seen({0.3f, 0.0f, 5.0f}, {0.0f, 0.0f, -1.0f}).value();
    };
    mesh::Material one = flint;
    one.dispersion = 0.0f;
    const glm::vec3 parted = seen(flint), alike = seen(one);
    EXPECT_NEAR(parted.g, alike.g, 1e-5f * alike.g) << "green has the index of the material";
    EXPECT_GT(std::abs(parted.r - alike.r), 0.002f * alike.r);
    EXPECT_GT(std::abs(parted.b - alike.b), 0.002f * alike.b);
}

TEST(Refractions, OfASlabAreStraightAndAbsorbed) {
    mesh::Material material = glass(0.0f, 1.0f);
    material.attenuation_color = {0.5f, 0.25f, 1.0f};
    material.attenuation_distance = 2.0f;
    material.base_color = {1.0f, 0.8f, 1.0f};
    mesh::TriangleMesh slab = scenes::box({-9, -9, -1}, {9, 9, 0});
    for (glm::vec3& normal : slab.normals)
        normal = {0.0f, 0.0f, glm::sign(normal.z)};
    Scene scene(slab, material, scenes::smooth_environment(128));
    for (const float slope : {0.0f, 0.5f, 1.0f}) {
        const glm::vec3 way = glm::normalize(glm::vec3(slope, 0.0f, -1.0f));
        const glm::vec3 found = scene.seen(-3.0f * way, way).value();
        const float sine = std::sqrt(1.0f - way.z * way.z) / 1.5f;
        const float length = 1.0f / std::sqrt(1.0f - sine * sine);
        const glm::vec3 expected = passed_part(-way.z, 1.5f) * cubemap::sample(scene.sky, way) *
                                   glm::vec3(1.0f, 0.8f, 1.0f) *
                                   glm::pow(material.attenuation_color, glm::vec3(length / 2.0f));
        EXPECT_LT(glm::distance(found, expected), 0.005f * glm::length(expected)) << slope;
    }
}

/// All that a white sky sends arrives, whatever way it takes.
TEST(Refractions, LoseNoLight) {
    cubemap::CubeMap white(8);
    white.texels.assign(white.texels.size(), glm::vec3(1.0f));
    for (const float thickness : {0.0f, 1.0f})
        for (const float roughness : {0.0f, 0.3f, 0.6f}) {
            Scene scene(scenes::icosphere(4, 1.0f, {}), glass(roughness, thickness), white);
            scene.light.eye = glm::vec3(0.0f, 0.0f, 5.0f);
            const PictureView view(scene.mesh, scene.rays,
                                   {.eye = *scene.light.eye, .target = {0, 0, 0}},
                                   {.width = 24, .height = 24, .samples_per_axis = 2});
            const Picture picture = view.cut_out(scene.light);
            for (std::size_t i = 0; i < picture.pixels.size(); ++i)
                if (picture.alpha[i] == 1.0f) {
                    // A thin smooth one is drawn as what is behind it, which is not here.
                    if (thickness == 0.0f && roughness == 0.0f)
                        continue;
                    EXPECT_NEAR(picture.pixels[i].g, 1.0f, 0.02f)
                        << roughness << " " << thickness << " " << i;
                }
        }
}

/// Small windows in a ball of glass are as bright with one sample a pixel as with many: a sample
/// sees the mean over all that lies between it and the next ones.
TEST(Refractions, SamplesMissNoSmallWindows) {
    cubemap::CubeMap sky(64, glm::vec3(0.05f));
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 8; y < 64; y += 16)
            for (std::uint32_t x = 8; x < 64; x += 16)
                sky.at(face, x, y) = glm::vec3(30.0f);
    Scene scene(scenes::icosphere(5, 1.0f, {}), glass(0.0f, 1.0f), sky, 16);
    scene.light.eye = glm::vec3(0.0f, 0.0f, 5.0f);
    const auto picture = [&](std::uint32_t samples_per_axis) {
        return PictureView(scene.mesh, scene.rays,
                           {.eye = *scene.light.eye, .target = {0, 0, 0}, .fov_degrees = 25},
                           {.width = 64, .height = 64, .samples_per_axis = samples_per_axis})
            .cut_out(scene.light);
    };
    const Picture coarse = picture(1), fine = picture(8);
    // Near the rim glass bends most.
    double sum = 0.0, expected = 0.0, sum_of_rim = 0.0, expected_of_rim = 0.0;
    for (std::size_t i = 0; i < coarse.pixels.size(); ++i) {
        if (fine.alpha[i] < 1.0f)
            continue;
        const bool is_rim = glm::distance(glm::vec2(i % 64, i / 64), glm::vec2(31.5f)) > 21.0f;
        (is_rim ? sum_of_rim : sum) += coarse.pixels[i].g;
        (is_rim ? expected_of_rim : expected) += fine.pixels[i].g;
    }
    EXPECT_NEAR(sum / expected, 1.0, 0.01);
    EXPECT_NEAR(sum_of_rim / expected_of_rim, 1.0, 0.05);
}

/// Smith's G1 of GGX.
float unmasked(float cosine, float alpha) {
    const float tangent2 = 1.0f / (cosine * cosine) - 1.0f;
    return 2.0f / (1.0f + std::sqrt(1.0f + alpha * alpha * tangent2));
}

/// Follows one way of light through a rough ball of radius 1 by random facets, none of which sends
/// it against another; returns where it leaves.
glm::vec3 leaves_ball(const glm::vec3& enters, const glm::vec3& direction, float alpha, float index,
                      std::mt19937& random) {
    std::uniform_real_distribution<float> unit;
    const auto bend = [&](const glm::vec3& way, const glm::vec3& normal, float ratio,
                          bool& is_back) {
        const glm::mat3 frame = cubemap::frame_of(normal);
        while (true) {
            const glm::vec3 half =
                frame * visible_half(-way * frame, alpha, {unit(random), unit(random)});
            glm::vec3 bent = glm::refract(way, half, ratio);
            is_back = bent == glm::vec3(0.0f);
            if (is_back)
                bent = glm::reflect(way, half);
            const float height = is_back ? glm::dot(bent, normal) : -glm::dot(bent, normal);
            if (height > 1e-4f && unit(random) < unmasked(height, alpha))
                return bent;
        }
    };
    bool is_back = false;
    glm::vec3 position = enters;
    glm::vec3 way = bend(direction, enters, 1.0f / index, is_back);
    do {
        position = glm::normalize(position - 2.0f * glm::dot(position, way) * way);
        way = bend(way, -position, index, is_back);
    } while (is_back);
    return way;
}

/// A rough ball shows the mean of what random ways through it find.
TEST(Refractions, OfARoughBallAreThoseOfRandomFacets) {
    constexpr float Index = 1.5f;
    const cubemap::CubeMap sky =
        scenes::sky_of(64, [](const glm::dvec3& w) { return w.y > 0.3 ? 1.0f : 0.1f; });
    const cubemap::CubeMap white(8, glm::vec3(1.0f));
    for (const float roughness : {0.3f, 0.6f, 0.9f})
        for (const float height : {-0.4f, 0.1f, 0.7f}) {
            const auto seen = [&](const cubemap::CubeMap& around) {
                Scene scene(scenes::icosphere(5, 1.0f, {}), glass(roughness, 1.0f, Index), around,
                            32'768);
                return scene.seen({0.0f, height, 5.0f}, {0.0f, 0.0f, -1.0f}).value().g;
            };
            std::mt19937 random(7);
            constexpr int NumWays = 20'000;
            double expected = 0.0;
            for (int i = 0; i < NumWays; ++i)
                expected +=
                    cubemap::sample(
                        sky, leaves_ball({0.0f, height, std::sqrt(1.0f - height * height)},
                                         {0.0f, 0.0f, -1.0f}, roughness * roughness, Index, random))
                        .g;
            EXPECT_NEAR(seen(sky) / seen(white), expected / NumWays, 0.015)
                << roughness << " " << height;
        }
}

/// A rough sheet spreads what is behind it as a mirror would, flipped to the other side.
TEST(Refractions, OfARoughSheetAreAFlippedHighlight) {
    constexpr std::uint32_t Size = 64;
    cubemap::CubeMap sky(Size), white(Size);
    white.texels.assign(white.texels.size(), glm::vec3(1.0f));
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(Size);
    const glm::vec3 to_eye = glm::normalize(glm::vec3(0.3f, 1.0f, 0.0f));
    const auto is_bright = [](const glm::dvec3& w) {
        return w.x > 0.5;
    };
    const auto each = [](const auto& visit) {
        for (const cubemap::Face face : cubemap::AllFaces)
            for (std::uint32_t y = 0; y < Size; ++y)
                for (std::uint32_t x = 0; x < Size; ++x)
                    visit(face, x, y, cubemap::texel_direction(face, x, y, Size));
    };
    each([&](cubemap::Face face, std::uint32_t x, std::uint32_t y, const glm::dvec3& w) {
        if (is_bright(w))
            sky.at(face, x, y) = glm::vec3(1.0f);
    });
    const auto seen = [&](float roughness, const cubemap::CubeMap& around) {
        Scene scene(scenes::floor_grid(2, 8.0f), glass(roughness, 0.0f), around, 32'768);
        const glm::vec3 somewhere(0.1f, 0.0f, 0.2f);
        return scene.seen(somewhere + 3.0f * to_eye, -to_eye);
    };
    EXPECT_FALSE(seen(0.0f, sky)) << "straight on";
    for (const float roughness : {0.3f, 0.5f, 0.7f}) {
        const float alpha = roughness * roughness;
        double bright = 0.0, all = 0.0;
        each([&](cubemap::Face, std::uint32_t x, std::uint32_t y, const glm::dvec3& w) {
            if (w.y >= 0.0)
                return;
            const glm::vec3 half = glm::normalize(to_eye + glm::vec3(w.x, -w.y, w.z));
            const float dense = mirrored_density({half.x, half.z, half.y}, to_eye.y, alpha) *
                                unmasked(static_cast<float>(-w.y), alpha);
            const double light =
                static_cast<double>(dense) * solid_angles[std::size_t{y} * Size + x];
            all += light;
            if (is_bright(w))
                bright += light;
        });
        const double expected = bright / all;
        const float part = seen(roughness, sky).value().g / seen(roughness, white).value().g;
        EXPECT_NEAR(part, expected, 0.01) << roughness;
        EXPECT_TRUE(roughness < 0.4f || expected > 0.03) << "it would show no spread";
    }
}

} // namespace
} // namespace relumine::relight
