#include "cubemap/resample/resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/image_layout.h"
#include "cubemap/resample/pixel_shares.h"
#include "files/parallel.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

constexpr std::array<Layout, 3> OldLayouts = {Layout::LatLong, Layout::Cube, Layout::VerticalCross};
constexpr std::array<Sampling, 2> AllSamplings = {Sampling::TexelCentres, Sampling::Borders};

std::string label(const EnvironmentImage& image, std::uint32_t resolution) {
    return std::string(name(image.layout)) +
           (image.sampling == Sampling::Borders ? " borders " : " centres ") +
           std::to_string(image.width) + "x" + std::to_string(image.height) + " -> " +
           std::to_string(resolution);
}

double largest_difference(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::vec3 difference = glm::abs(a[i] - b[i]);
        largest = std::max<double>(largest, std::max({difference.x, difference.y, difference.z}));
    }
    return largest;
}

/// The plain way: every pixel is cut into N x N pieces and each goes to the texel that holds a
/// random point of it.
CubeMap supersampled(const EnvironmentImage& image, std::uint32_t resolution, int n) {
    std::vector<glm::dvec3> sums(std::size_t{6} * resolution * resolution, glm::dvec3(0.0));
    std::vector<double> weights(sums.size(), 0.0);
    const CubeMap layout(resolution);
    const auto add = [&](const glm::dvec3& w, double weight, const glm::vec3& radiance) {
        const FacePoint point = face_point(w);
        const auto texel = [&](double s) {
            return std::min(static_cast<std::uint32_t>(s * resolution), resolution - 1);
        };
        const std::size_t index = layout.index(point.face, texel(point.s), texel(point.t));
        sums[index] += weight * glm::dvec3(radiance);
        weights[index] += weight;
    };
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> jitter(0.0, 1.0);
    const bool lat_long = image.layout == Layout::LatLong;
    const std::uint32_t faces = lat_long ? 1 : 6;
    const std::uint32_t width =
        lat_long ? image.width : FaceSquares(image.layout, image.width, image.height).resolution();
    const std::uint32_t height = lat_long ? image.height : width;
    const auto columns = cell_borders(width, image.sampling),
               rows = cell_borders(height, image.sampling);
    for (std::uint32_t f = 0; f < faces; ++f) {
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const glm::vec3 radiance =
                    image.pixels[lat_long ? std::size_t{y} * width + x
                                          : FaceSquares(image.layout, image.width, image.height)
                                                .pixel(AllFaces[f], x, y)];
                for (int k = 0; k < n * n; ++k) {
                    const double s = columns[x] + (columns[x + 1] - columns[x]) *
                                                      (k % n + jitter(generator)) / n;
                    const double t = rows[y] + (rows[y + 1] - rows[y]) *
                                                   (static_cast<int>(k / n) + jitter(generator)) /
                                                   n;
                    const double piece = (columns[x + 1] - columns[x]) * (rows[y + 1] - rows[y]);
                    if (lat_long) {
                        const double longitude = 2.0 * std::numbers::pi * (0.5 - s),
                                     polar = std::numbers::pi * t;
                        add({std::sin(polar) * std::sin(longitude), std::cos(polar),
                             std::sin(polar) * std::cos(longitude)},
                            piece * std::sin(polar), radiance);
                    } else {
                        const glm::dvec3 point = cube_point(AllFaces[f], s, t);
                        add(point, piece / std::pow(glm::dot(point, point), 1.5), radiance);
                    }
                }
            }
        }
    }
    CubeMap map(resolution);
    for (std::size_t i = 0; i < sums.size(); ++i)
        map.texels[i] = sums[i] / weights[i];
    return map;
}

TEST(Resample, AgreesWithDenseSupersampling) {
    for (const Layout layout : OldLayouts) {
        for (const Sampling sampling : AllSamplings) {
            EnvironmentImage image =
                black_image(layout, sampling, layout == Layout::LatLong ? 9 : 5);
            fill_randomly(image.pixels, 3);
            for (const std::uint32_t resolution : {1u, 3u, 4u, 7u}) {
                const CubeMap expected = supersampled(image, resolution, 100);
                EXPECT_LT(largest_difference(resample(image, resolution).texels, expected.texels),
                          4e-3)
                    << label(image, resolution);
            }
        }
    }
}

TEST(Resample, ConstantsStayConstant) {
    for (const Layout layout : OldLayouts) {
        for (const Sampling sampling : AllSamplings) {
            for (const std::uint32_t size : {1u, 2u, 7u, 64u, 128u}) {
                EnvironmentImage image = black_image(layout, sampling, size);
                image.pixels.assign(image.pixels.size(), glm::vec3(3.0f));
                for (const std::uint32_t resolution : {1u, 2u, 3u, 16u, 33u, 64u, 256u}) {
                    const CubeMap map = resample(image, resolution);
                    const std::vector<glm::vec3> expected(map.texels.size(), glm::vec3(3.0f));
                    ASSERT_LT(largest_difference(map.texels, expected), 3e-5)
                        << label(image, resolution);
                }
                const EnvironmentImage back = to_image(CubeMap(9, glm::vec3(3.0f)), layout,
                                                       image.width, image.height, sampling);
                std::vector<glm::vec3> expected(back.pixels.size(), glm::vec3(0.0f));
                for_each_pixel(shape_of(back), [&](std::size_t index, const PixelPlace&) {
                    expected[index] = glm::vec3(3.0f);
                });
                ASSERT_LT(largest_difference(back.pixels, expected), 3e-5) << label(image, 9);
            }
        }
    }
}

TEST(Resample, RandomImagesKeepTheirPower) {
    for (const Layout layout : OldLayouts) {
        for (const Sampling sampling : AllSamplings) {
            for (const std::uint32_t size : {1u, 3u, 20u, 64u}) {
                EnvironmentImage image = black_image(layout, sampling, size);
                fill_randomly(image.pixels, size);
                const glm::dvec3 expected = total_power(image);
                for (const std::uint32_t resolution : {1u, 5u, 16u, 31u, 100u}) {
                    const glm::dvec3 ratio = total_power(resample(image, resolution)) / expected;
                    ASSERT_NEAR(ratio.x, 1.0, 1e-6) << label(image, resolution);
                    ASSERT_NEAR(ratio.z, 1.0, 1e-6) << label(image, resolution);
                    CubeMap map(resolution);
                    fill_randomly(map.texels, resolution);
                    const EnvironmentImage back =
                        to_image(map, layout, image.width, image.height, sampling);
                    ASSERT_NEAR(total_power(back).y / total_power(map).y, 1.0, 1e-5)
                        << label(image, resolution);
                }
            }
        }
    }
}

/// Irradiance that a pixel of radiance 1 causes on a surface that all of it is above: n . (vector
/// irradiance).
glm::dvec3 vector_irradiance(const EnvironmentImage& image, std::size_t pixel) {
    EnvironmentImage one = image;
    one.pixels.assign(image.pixels.size(), glm::vec3(0.0f));
    one.pixels[pixel] = glm::vec3(1.0f);
    const CubeMap fine = resample(one, 256);
    const auto angles = texel_solid_angles(256);
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < fine.texels.size(); ++i) {
        if (fine.texels[i].x == 0.0f)
            continue;
        const std::size_t texel = i % (256 * 256);
        sum += double{fine.texels[i].x} * angles[texel] *
               texel_direction(AllFaces[i / (256 * 256)], static_cast<std::uint32_t>(texel % 256),
                               static_cast<std::uint32_t>(texel / 256), 256);
    }
    return sum;
}

/// A spiral of directions over the sphere.
std::vector<glm::dvec3> spread_normals(int n) {
    std::vector<glm::dvec3> normals;
    for (int i = 0; i < n; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / n,
                     angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0)),
                     radius = std::sqrt(1.0 - y * y);
        normals.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
    }
    return normals;
}

TEST(Resample, AOnePixelSunKeepsPowerAndIrradiance) {
    for (const Layout layout : OldLayouts) {
        for (const Sampling sampling : AllSamplings) {
            const std::uint32_t size = layout == Layout::LatLong ? 64 : 32;
            const EnvironmentImage empty = black_image(layout, sampling, size);
            std::vector<std::pair<std::size_t, PixelPlace>> places;
            for_each_pixel(shape_of(empty), [&](std::size_t index, const PixelPlace& place) {
                places.emplace_back(index, place);
            });
            // Corners, edges and centres of the image or its faces, poles and seams, and anything
            // between.
            std::vector<std::size_t> chosen = {0,
                                               size / 2,
                                               size - 1,
                                               places.size() / 2,
                                               places.size() / 2 + size,
                                               places.size() - 1,
                                               places.size() - size / 2};
            for (std::size_t i = 1; i < 5; ++i)
                chosen.push_back(i * 7919 % places.size());
            for (const std::size_t i : chosen) {
                const auto& [index, place] = places[i];
                EnvironmentImage image = empty;
                image.pixels[index] = glm::vec3(1e5f);
                const glm::dvec3 exact = 1e5 * vector_irradiance(empty, index);
                for (const std::uint32_t resolution : {8u, 32u, 64u, 128u}) {
                    const CubeMap map = resample(image, resolution);
                    ASSERT_NEAR(total_power(map).x / (1e5 * place.solid_angle), 1.0, 1e-5)
                        << label(image, resolution) << " pixel " << index;
                    // A texel only says that the sun is within it: the more texels a pixel spans,
                    // the better they say where. The pixels beside the poles are slivers thinner
                    // than any texel; those on borders are half as wide as others.
                    const bool is_sliver =
                        layout == Layout::LatLong && std::abs(place.direction.y) > 0.95;
                    const double tolerance = is_sliver || resolution < 64    ? 2.0 / resolution
                                             : resolution < 128              ? 6e-3
                                             : sampling == Sampling::Borders ? 2e-3
                                                                             : 1e-3;
                    if (resolution < 32)
                        continue;
                    for (const glm::dvec3& normal : spread_normals(32)) {
                        if (glm::dot(normal, place.direction) < 0.5)
                            continue;
                        ASSERT_NEAR(irradiance(map, normal).x / glm::dot(normal, exact), 1.0,
                                    tolerance)
                            << label(image, resolution) << " pixel " << index;
                    }
                }
            }
        }
    }
}

TEST(Resample, SameResolutionCubesAreCopiedBitByBit) {
    EnvironmentImage image = black_image(Layout::Cube, Sampling::TexelCentres, 12);
    fill_randomly(image.pixels, 5);
    image.pixels[7].y = std::numeric_limits<float>::infinity();
    EXPECT_EQ(resample(image, 12).texels, image.pixels);
    CubeMap map(12);
    map.texels = image.pixels;
    EXPECT_EQ(resample(map, 12).texels, map.texels);
    EXPECT_EQ(to_image(map, Layout::Cube, 12, 72).pixels, image.pixels);
}

TEST(Resample, CrossOfTheSameResolutionIsReordered) {
    CubeMap map(16);
    fill_randomly(map.texels, 6);
    const EnvironmentImage cross = to_image(map, Layout::VerticalCross, 48, 64);
    EXPECT_EQ(resample(cross, 16).texels, map.texels);
    // -Z at the centre upright, +Z at the bottom upside down.
    EXPECT_EQ(cross.pixels[16 * 48 + 16], map.at(Face::NegativeZ, 0, 0));
    EXPECT_EQ(cross.pixels[48 * 48 + 16], map.at(Face::PositiveZ, 15, 15));
}

TEST(Resample, CubeMapsGrowAndShrink) {
    CubeMap map(6);
    fill_randomly(map.texels, 7);
    const CubeMap larger = resample(map, 18);
    EXPECT_EQ(larger.at(Face::PositiveY, 4, 16), map.at(Face::PositiveY, 1, 5));
    EXPECT_LT(largest_difference(resample(larger, 6).texels, map.texels), 1e-6);
    for (const std::uint32_t resolution : {1u, 4u, 5u, 7u, 64u})
        EXPECT_NEAR(total_power(resample(map, resolution)).x / total_power(map).x, 1.0, 1e-7)
            << resolution;
}

TEST(Resample, AnInfinitePixelSpoilsOnlyTheTexelsUnderIt) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 64);
    image.pixels[30 * 128 + 50].x = std::numeric_limits<float>::infinity();
    std::size_t num_spoilt = 0;
    for (const glm::vec3& texel : resample(image, 32).texels)
        num_spoilt += std::isfinite(texel.x) ? 0u : 1u;
    EXPECT_GE(num_spoilt, 1u);
    EXPECT_LE(num_spoilt, 9u);
}

TEST(Resample, SmoothPicturesSurviveTheRoundTrip) {
    CubeMap map(64);
    for (const Face face : AllFaces) {
        for (std::uint32_t y = 0; y < 64; ++y) {
            for (std::uint32_t x = 0; x < 64; ++x)
                map.at(face, x, y) = glm::vec3(texel_direction(face, x, y, 64) * 0.5 + 0.5);
        }
    }
    for (const Sampling sampling : AllSamplings) {
        EXPECT_LT(largest_difference(
                      resample(to_image(map, Layout::LatLong, 256, 128, sampling), 64).texels,
                      map.texels),
                  0.02);
        EXPECT_LT(
            largest_difference(resample(to_image(map, Layout::Cube, 64, 384, sampling), 64).texels,
                               map.texels),
            0.02);
    }
}

TEST(Resample, OneThreadAndTwoGiveTheSameBits) {
    EnvironmentImage lat_long = black_image(Layout::LatLong, Sampling::TexelCentres, 100);
    EnvironmentImage cube = black_image(Layout::Cube, Sampling::Borders, 40);
    fill_randomly(lat_long.pixels, 8);
    fill_randomly(cube.pixels, 9);
    const auto all = [&] {
        const CubeMap map = resample(lat_long, 53);
        return std::tuple{map.texels,
                          resample(cube, 37).texels,
                          to_image(map, Layout::LatLong, 90, 45).pixels,
                          rotated(map, 12.5).texels,
                          total_power(map),
                          irradiance(map, {0.0, 1.0, 0.0})};
    };
    const auto many = all();
    const files::ThreadLimit one(1);
    EXPECT_TRUE(all() == many);
}

/// The plain way: the footprint of every pixel, a polygon of the sphere, cut at the texels of each
/// face.
CubeMap from_polygons(const EnvironmentImage& image, std::uint32_t resolution) {
    CubeMap map(resolution);
    std::vector<glm::dvec3> sums(map.texels.size(), glm::dvec3(0.0));
    std::vector<double> weights(sums.size(), 0.0);
    detail::for_each_row_of_shares(
        shape_of(image), glm::dmat3(1.0), resolution, [&](std::span<const detail::PixelShare> row) {
            for (const detail::PixelShare& share : row) {
                sums[share.texel] += glm::dvec3(image.pixels[share.pixel]) * share.solid_angle;
                weights[share.texel] += share.solid_angle;
            }
        });
    for (std::size_t i = 0; i < sums.size(); ++i)
        map.texels[i] = sums[i] / weights[i];
    return map;
}

TEST(Resample, LatLongsAgreeWithPolygonsOfTheSphere) {
    // Widths with and without quarter turns, odd and even faces, fine and coarse against both.
    const std::array<std::array<std::uint32_t, 3>, 9> cases = {{{64, 32, 16},
                                                                {64, 32, 33},
                                                                {64, 32, 64},
                                                                {50, 31, 20},
                                                                {51, 20, 21},
                                                                {8, 3, 40},
                                                                {400, 200, 7},
                                                                {256, 128, 2},
                                                                {33, 1, 5}}};
    for (const Sampling sampling : AllSamplings) {
        for (const auto& [width, height, resolution] : cases) {
            if (sampling == Sampling::Borders && height == 1)
                continue;
            EnvironmentImage image = black_image(Layout::LatLong, sampling, width, height);
            fill_randomly(image.pixels, width + resolution);
            const CubeMap plain = from_polygons(image, resolution),
                          fast = resample(image, resolution);
            // The polygons have short arcs in place of parallels, which moves up to 3e-4 of a
            // texel's area between the rows of such coarse maps.
            EXPECT_LT(largest_difference(fast.texels, plain.texels), 5e-4)
                << label(image, resolution);
            EXPECT_NEAR(total_power(fast).y / total_power(plain).y, 1.0, 1e-6);
        }
    }
}

TEST(Resample, TexelsWithinOnePixelAreItsCopies) {
    EnvironmentImage image = black_image(Layout::LatLong, Sampling::TexelCentres, 16, 8);
    fill_randomly(image.pixels, 1);
    const CubeMap map = resample(image, 256);
    std::size_t num_copies = 0;
    for (const glm::vec3& texel : map.texels)
        num_copies += static_cast<std::size_t>(
            std::find(image.pixels.begin(), image.pixels.end(), texel) != image.pixels.end());
    EXPECT_GT(num_copies, map.texels.size() * 9 / 10);
}

TEST(Resample, RefusesImagesThatAreNone) {
    EXPECT_THROW((void)resample(EnvironmentImage(), 8), std::invalid_argument);
    EXPECT_THROW((void)resample(black_image(Layout::Cube, Sampling::TexelCentres, 4, 23), 8),
                 std::invalid_argument);
    EXPECT_THROW((void)to_image(CubeMap(4), Layout::VerticalCross, 5, 7), std::invalid_argument);
}

} // namespace
} // namespace relumine::cubemap
