// The baselines do what their papers say: bases are orthonormal, nothing is lost where nothing is
// left out, and what is left out is the least.
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "relight/reference/exact.h"
#include "relumine/relumine.h"
#include "tests/bench/baselines/cpca.h"
#include "tests/bench/baselines/dense_transport.h"
#include "tests/bench/baselines/features.h"
#include "tests/bench/baselines/packed_matrix.h"
#include "tests/bench/baselines/sparse_columns.h"

namespace relumine::bench {
namespace {

constexpr std::uint32_t Resolution = 16;

const DenseTransport& transport() {
    static const DenseTransport dense(Mesh(data_gen::colonnade(1000)), Resolution);
    return dense;
}

double relative_l2(std::span<const glm::vec3> values, std::span<const glm::vec3> expected) {
    double error = 0.0, all = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const glm::dvec3 difference(values[i] - expected[i]);
        error += glm::dot(difference, difference);
        all += glm::dot(glm::dvec3(expected[i]), glm::dvec3(expected[i]));
    }
    return std::sqrt(error / all);
}

/// In double, from the rows themselves.
std::vector<glm::vec3> plain_product(const BlockedRows& rows, std::span<const glm::vec3> light) {
    std::vector<glm::vec3> radiance(rows.num_receivers);
    std::vector<float> values(rows.num_columns * 16);
    for (std::size_t i = 0; i < rows.num_receivers; ++i) {
        if (i % 16 == 0)
            rows.read(i / 16, values);
        glm::dvec3 sum(0.0);
        for (std::size_t column = 0; column < rows.num_columns; ++column)
            sum += static_cast<double>(values[column * 16 + i % 16]) * glm::dvec3(light[column]);
        radiance[i] = sum;
    }
    return radiance;
}

TEST(Baselines, HarmonicsAreOrthonormal) {
    constexpr std::uint32_t Order = 8, Texels = 64;
    constexpr std::size_t Count = Order * Order;
    std::vector<double> products(Count * Count, 0.0);
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(Texels);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < Texels; ++y)
            for (std::uint32_t x = 0; x < Texels; ++x) {
                const std::vector<double> basis =
                    spherical_harmonics(cubemap::texel_direction(face, x, y, Texels), Order);
                for (std::size_t i = 0; i < Count * Count; ++i)
                    products[i] +=
                        solid_angles[y * Texels + x] * basis[i / Count] * basis[i % Count];
            }
    for (std::size_t i = 0; i < Count * Count; ++i)
        EXPECT_NEAR(products[i], i / Count == i % Count ? 1.0 : 0.0, 5e-3) << i;
}

TEST(Baselines, HarmonicsHaveTheirPublishedConstants) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(0.3, -0.5, 0.7));
    const std::vector<double> basis = spherical_harmonics(d, 3);
    // Ramamoorthi and Hanrahan 2001, Eq. 3.
    const std::vector<double> expected = {0.282095,
                                          0.488603 * d.y,
                                          0.488603 * d.z,
                                          0.488603 * d.x,
                                          1.092548 * d.x * d.y,
                                          1.092548 * d.y * d.z,
                                          0.315392 * (3.0 * d.z * d.z - 1.0),
                                          1.092548 * d.x * d.z,
                                          0.546274 * (d.x * d.x - d.y * d.y)};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(basis[i], expected[i], 1e-5) << i;
}

TEST(Baselines, WaveletsKeepProducts) {
    constexpr std::size_t Count = 6 * Resolution * Resolution;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-1.0f, 1.0f);
    std::vector<float> a(Count), b(Count);
    double expected = 0.0, product = 0.0;
    for (std::size_t i = 0; i < Count; ++i) {
        a[i] = any(random), b[i] = any(random);
        expected += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    }
    transform_faces(a, Resolution, 1);
    transform_faces(b, Resolution, 1);
    for (std::size_t i = 0; i < Count; ++i)
        product += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    EXPECT_NEAR(product, expected, 1e-4);
}

TEST(Baselines, AnEvenFaceIsOneWavelet) {
    std::vector<float> even(6 * Resolution * Resolution, 1.0f);
    transform_faces(even, Resolution, 1);
    for (std::size_t i = 0; i < even.size(); ++i)
        EXPECT_NEAR(even[i], i % (Resolution * Resolution) == 0 ? Resolution : 0.0f, 1e-4f) << i;
}

TEST(Baselines, DenseTransportIsExactUnderEvenTexels) {
    // Of a sky that is even, the error is that of nine samples a texel.
    const cubemap::CubeMap white(Resolution, glm::vec3(1.0f));
    const std::vector<glm::vec3> light = mean_radiance(white, Resolution);
    const std::vector<glm::vec3> by_place = plain_product(transport().rows(), light);
    const Scene& scene = transport().scene();
    const SceneRays rays(scene);
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < scene.receivers.size(); i += 20)
        chosen.push_back(i);
    const std::vector<glm::dvec3> exact = relight::exact_radiance(
        scene.receivers, chosen, rays.of_mesh(), cubemap::CubeMap(128, glm::vec3(1.0f)),
        {.bias = scene.settings.bias});
    std::vector<glm::vec3> radiance(by_place.size());
    for (std::size_t place = 0; place < by_place.size(); ++place)
        radiance[scene.transfer.order[place]] = by_place[place];
    EXPECT_LT(relight::compare(chosen, exact, radiance).relative_l2, 0.01);
}

TEST(Baselines, CoarserRowsAreSums) {
    const std::vector<glm::vec3> coarse(6 * 4 * 4, glm::vec3(0.25f, 1.0f, 2.0f)),
        fine(6 * Resolution * Resolution, glm::vec3(0.25f, 1.0f, 2.0f));
    EXPECT_LT(relative_l2(plain_product(transport().rows(4), coarse),
                          plain_product(transport().rows(), fine)),
              1e-6);
}

TEST(Baselines, PackedMatricesRoundToHalfAStep) {
    const cubemap::CubeMap map = data_gen::two_soft_boxes(64);
    const Features features = texel_features(transport(), Resolution);
    const std::vector<glm::vec3> light = features.project(map);
    const std::vector<glm::vec3> expected = plain_product(features.rows, light);
    std::vector<glm::vec3> radiance;
    multiply(packed<std::int16_t>(features.rows), light, radiance);
    EXPECT_LT(relative_l2(radiance, expected), 1e-4);
    multiply(packed<std::int8_t>(features.rows), light, radiance);
    EXPECT_LT(relative_l2(radiance, expected), 0.01);
    EXPECT_GT(relative_l2(radiance, expected), 1e-6);
}

TEST(Baselines, AllWaveletsAreTheTexels) {
    const cubemap::CubeMap map = data_gen::two_soft_boxes(64);
    const Features texels = texel_features(transport(), Resolution),
                   wavelets = wavelet_features(transport());
    const std::vector<glm::vec3> expected = plain_product(texels.rows, texels.project(map));
    EXPECT_LT(relative_l2(plain_product(wavelets.rows, wavelets.project(map)), expected), 1e-5);
    const std::size_t all = wavelets.rows.num_receivers * wavelets.rows.num_columns;
    std::vector<glm::vec3> radiance;
    const SparseColumns every(wavelets.rows, all), some(wavelets.rows, all / 20);
    every.multiply(wavelets.project(map), 0, radiance);
    const double least = relative_l2(radiance, expected);
    EXPECT_LT(least, 0.01);
    some.multiply(wavelets.project(map), 0, radiance);
    EXPECT_GT(relative_l2(radiance, expected), least);
    EXPECT_LT(relative_l2(radiance, expected), 0.2);
    EXPECT_LE(some.bytes(), 3 * all / 20 + every.bytes() - 3 * (every.bytes() / 3) + (1u << 20));
    // A few of the light's wavelets carry most of it.
    every.multiply(wavelets.project(map), 200, radiance);
    EXPECT_LT(relative_l2(radiance, expected), 0.1);
}

TEST(Baselines, ClustersOfSingleTexelsAreTheTexels) {
    const cubemap::CubeMap map = data_gen::two_soft_boxes(64);
    const Features texels = texel_features(transport(), Resolution),
                   clusters = cluster_features(transport().scene().transfer);
    EXPECT_LT(relative_l2(plain_product(clusters.rows, clusters.project(map)),
                          plain_product(texels.rows, texels.project(map))),
              1e-5);
}

TEST(Baselines, WindowedHarmonicsLightSmoothSkiesRight) {
    // A sky of first order needs no higher bands; Hann's window dims the first one by half at order
    // two, and hardly at order twelve.
    cubemap::CubeMap sky(64);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 64; ++x)
                sky.at(face, x, y) = glm::vec3(
                    static_cast<float>(1.0 + 0.5 * cubemap::texel_direction(face, x, y, 64).y));
    const Features texels = texel_features(transport(), Resolution);
    const std::vector<glm::vec3> expected = plain_product(texels.rows, texels.project(sky));
    const HarmonicTransport harmonics(transport(), 12);
    const auto error = [&](std::uint32_t order, Window window) {
        const Features features = harmonics.features(order, window);
        return relative_l2(plain_product(features.rows, features.project(sky)), expected);
    };
    EXPECT_LT(error(3, Window::None), 1e-3);
    EXPECT_GT(error(2, Window::Hann), 0.05);
    EXPECT_LT(error(12, Window::Hann), 0.01);
}

TEST(Baselines, ComponentsOfAllColumnsAreTheRows) {
    const HarmonicTransport harmonics(transport(), 3);
    const Features features = harmonics.features(3, Window::None);
    const std::vector<glm::vec3> light = features.project(data_gen::two_soft_boxes(64));
    const std::vector<glm::vec3> expected = plain_product(features.rows, light);
    std::vector<glm::vec3> radiance;
    ClusteredComponents(features.rows, 4, 9).multiply(light, radiance);
    EXPECT_LT(relative_l2(radiance, expected), 1e-3);
    ClusteredComponents(features.rows, 4, 2).multiply(light, radiance);
    const double two = relative_l2(radiance, expected);
    ClusteredComponents(features.rows, 4, 4).multiply(light, radiance);
    EXPECT_LT(relative_l2(radiance, expected), two);
    ClusteredComponents(features.rows, 16, 2).multiply(light, radiance);
    EXPECT_LT(relative_l2(radiance, expected), two);
}

} // namespace
} // namespace relumine::bench
