// What a pixel that stands for many normals mirrors.
#include "relight/surfaces/mirrors.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/texture_view.h"
#include "tests/prt/textured_square.h"

namespace relumine::relight {
namespace {

/// Facets of a map that would mirror the eye into the surface turn until they do not.
TEST(MirrorOf, MirrorsTheEyeToTheOutside) {
    const prt::Surface metal{.specular = glm::vec3(1.0f), .highlight = prt::Highlight::GgxWhole};
    const prt::MeshPoint at{.triangle = 0, .barycentric = {0.2f, 0.7f}};
    const glm::vec3 to_eye = glm::normalize(glm::vec3(0, -3, 1));
    const auto mirrored = [&](const std::array<std::uint8_t, 3>& color) {
        const mesh::TriangleMesh square = scenes::mapped_square(color);
        return -glm::reflect(to_eye, mirror_of(square, at, metal, to_eye).value().normal);
    };
    EXPECT_NEAR(mirrored({128, 127, 255}).z, to_eye.z, 1e-5f) << "flat";
    EXPECT_GT(mirrored({128, 100, 255}).z, 0.1f);
    EXPECT_NEAR(mirrored({128, 255, 64}).z, 0.1f, 1e-4f);
}

/// Normals that a sample does not tell apart make the surface rougher, and leave its coat alone.
TEST(MirrorOf, IsRougherWhereNormalsDifferWithinASample) {
    const mesh::TriangleMesh square = scenes::striped_square();
    const mesh::MipMaps maps(square.textures);
    const prt::Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.0f};
    const prt::Surface metal{.specular = glm::vec3(1.0f),
                             .highlight = prt::Highlight::GgxWhole,
                             .roughness_or_exponent = 0.2f,
                             .coat = 1.0f,
                             .coat_roughness = 0.1f};
    const prt::MeshPoint at{.triangle = 0, .barycentric = {0.2f, 0.7f}};
    const glm::vec3 to_eye(0, 0, 1);
    const prt::TextureView near(maps, camera.eye, prt::PictureRays(camera, 1000, 1000, 1));
    const Mirror sharp = mirror_of(square, at, metal, to_eye, &near).value();
    EXPECT_EQ(sharp.surface.roughness_or_exponent, metal.roughness_or_exponent);
    EXPECT_LT(sharp.normal.z, 0.9f) << "that of one stripe";
    const prt::TextureView far(maps, camera.eye, prt::PictureRays(camera, 10, 10, 1));
    const Mirror wide = mirror_of(square, at, metal, to_eye, &far).value();
    EXPECT_LT(glm::distance(wide.normal, glm::vec3(0, 0, 1)), 1e-3f);
    prt::Surface expected = metal;
    prt::widen(expected, 0.5f, 0.0f);
    EXPECT_NEAR(wide.surface.roughness_or_exponent, expected.roughness_or_exponent, 1e-3f);
    EXPECT_GT(expected.roughness_or_exponent, 0.5f) << "it would show no widening";
    EXPECT_EQ(wide.surface.coat_roughness, metal.coat_roughness);
}

/// So does a surface that bends within a sample, with its coat.
TEST(MirrorOf, IsRougherWhereTheMeshBendsWithinASample) {
    mesh::TriangleMesh square = scenes::striped_square();
    square.materials[0].normal_texture.reset();
    for (std::size_t i = 0; i < square.num_vertices(); ++i)
        square.normals[i] = glm::normalize(glm::vec3(0.5f * square.positions[i].x, 0.0f, 1.0f));
    const prt::Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}, .fov_degrees = 28.0f};
    const prt::Surface metal{.specular = glm::vec3(1.0f),
                             .highlight = prt::Highlight::GgxWhole,
                             .roughness_or_exponent = 0.05f,
                             .coat = 1.0f,
                             .coat_roughness = 0.1f};
    const prt::MeshPoint at{.triangle = 0, .barycentric = {0.2f, 0.7f}};
    const prt::TextureView view(camera.eye, prt::PictureRays(camera, 10, 10, 1));
    const float spread = view.normal_spread(square, at);
    ASSERT_GT(spread, 1e-4f);
    prt::Surface expected = metal;
    prt::widen(expected, spread, spread);
    const Mirror bent = mirror_of(square, at, metal, {0, 0, 1}, &view).value();
    EXPECT_EQ(bent.surface.roughness_or_exponent, expected.roughness_or_exponent);
    EXPECT_EQ(bent.surface.coat_roughness, expected.coat_roughness);
    EXPECT_GT(expected.roughness_or_exponent, 1.2f * metal.roughness_or_exponent);
    const Mirror point = mirror_of(square, at, metal, {0, 0, 1}).value();
    EXPECT_EQ(point.surface.roughness_or_exponent, metal.roughness_or_exponent);
}

} // namespace
} // namespace relumine::relight
