#include "cubemap/kelvin.h"
#include "cubemap/layers/layer_composite.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <span>
#include <stdexcept>
#include <variant>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/layers/texel_range.h"
#include "files/parallel.h"
#include "tests/cubemap/layer_places.h"
#include "tests/cubemap/test_images.h"

namespace relumine::cubemap {
namespace {

CubeMap random_map(std::uint32_t resolution, std::uint32_t seed) {
    CubeMap map(resolution);
    fill_randomly(map.texels, seed);
    return map;
}

std::vector<LightLayer> random_layers(std::size_t number, std::uint32_t seed) {
    std::mt19937 generator(seed);
    std::vector<LightLayer> layers;
    while (layers.size() < number)
        layers.push_back(random_layer(generator));
    return layers;
}

bool same_bits(const CubeMap& a, const CubeMap& b) {
    return a.texels.size() == b.texels.size() &&
           std::memcmp(a.texels.data(), b.texels.data(), a.texels.size() * sizeof(glm::vec3)) == 0;
}

bool contains(const TexelRectangle& r, Face face, std::uint32_t x, std::uint32_t y) {
    return r.face == face && x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

/// What is seen in a direction.
glm::vec3 seen(const CubeMap& map, const glm::dvec3& direction) {
    const FacePoint point = face_point(direction);
    const auto texel = [&](double s) {
        return std::min(static_cast<std::uint32_t>(s * map.resolution), map.resolution - 1);
    };
    return map.at(point.face, texel(point.s), texel(point.t));
}

TEST(LayerComposite, GoesInOrder) {
    const CubeMap base(16, glm::vec3(1.0f));
    const LightLayer emit{
        .name = "emit", .region = Disc{.radius_degrees = 30.0}, .effect = Emit{{1, 2, 3}}};
    const LightLayer gain{
        .name = "gain", .region = Disc{.radius_degrees = 40.0}, .effect = Gain{2.0f, {1, 1, 0.5f}}};
    EXPECT_EQ(seen(composite(base, std::array{emit, gain}), {0, 0, 1}), glm::vec3(4, 6, 4));
    EXPECT_EQ(seen(composite(base, std::array{gain, emit}), {0, 0, 1}), glm::vec3(3, 4, 4));
    EXPECT_EQ(seen(composite(base, std::array{gain, emit}), {0, 0, -1}), glm::vec3(1.0f));
}

TEST(LayerComposite, LeavesOutWhatIsOff) {
    const CubeMap base = random_map(16, 1);
    std::vector<LightLayer> layers = random_layers(4, 2);
    layers[1].on = layers[2].on = false;
    EXPECT_TRUE(
        same_bits(composite(base, layers), composite(base, std::array{layers[0], layers[3]})));
    layers[0].on = layers[3].on = false;
    EXPECT_TRUE(same_bits(composite(base, layers), base));
    EXPECT_TRUE(touched_texels(layers[0], 16).empty());
}

TEST(LayerComposite, GainIsInStops) {
    const CubeMap base(8, glm::vec3(3.0f));
    LightLayer layer{.name = "a",
                     .gain_ev = 2.0,
                     .region = Disc{.radius_degrees = 180.0},
                     .effect = Emit{{1, 2, 3}}};
    EXPECT_EQ(seen(composite(base, std::span(&layer, 1)), {1, 0, 0}), glm::vec3(7, 11, 15));
    layer.effect = Gain{1.0f, {1.0f, 0.5f, 0.0f}};
    layer.gain_ev = -1.0;
    EXPECT_EQ(seen(composite(base, std::span(&layer, 1)), {1, 0, 0}), glm::vec3(1.5f, 0.75f, 0.0f));
}

TEST(LayerComposite, KelvinTintsEveryEffect) {
    const CubeMap base(8, glm::vec3(3.0f));
    const glm::vec3 tint = kelvin_color(3200.0);
    LightLayer layer{.name = "a",
                     .gain_ev = 1.0,
                     .kelvin = 3200.0,
                     .region = Disc{.radius_degrees = 180.0},
                     .effect = Emit{{1, 2, 3}}};
    const glm::vec3 lit = seen(composite(base, std::span(&layer, 1)), {1, 0, 0});
    EXPECT_LT(glm::length(lit - (3.0f + 2.0f * tint * glm::vec3(1, 2, 3))), 1e-5f);
    layer.effect = Gain{};
    const glm::vec3 filtered = seen(composite(base, std::span(&layer, 1)), {1, 0, 0});
    EXPECT_LT(glm::length(filtered - 6.0f * tint), 1e-5f);
}

TEST(LayerComposite, SoloShinesAloneOverBlack) {
    const CubeMap base = random_map(16, 1), black(16, glm::vec3(0.0f));
    std::vector<LightLayer> layers = random_layers(4, 2);
    layers[1].solo = layers[2].solo = true;
    EXPECT_TRUE(
        same_bits(composite(base, layers), composite(black, std::array{layers[1], layers[2]})));
    layers[2].on = false;
    EXPECT_TRUE(same_bits(composite(base, layers), composite(black, std::array{layers[1]})));
    layers[1].on = false; // and nobody has it
    EXPECT_TRUE(
        same_bits(composite(base, layers), composite(base, std::array{layers[0], layers[3]})));
}

TEST(LayerComposite, CoverageOfSmallTexelsIsThatOfTheirCentres) {
    std::mt19937 generator(7);
    const std::uint32_t resolution = 128;
    for (int round = 0; round < 40; ++round) {
        LightLayer layer = random_layer(generator);
        layer.gain_ev = 0.0;
        layer.effect = Emit{{1, 1, 1}};
        const CubeMap map = composite(CubeMap(resolution), std::span(&layer, 1));
        double difference = 0.0;
        for (const Face face : AllFaces) {
            for (std::uint32_t i = 0; i < 400; ++i) {
                const std::uint32_t x = (i * 37) % resolution, y = (i * 101) % resolution;
                const glm::dvec3 w = texel_direction(face, x, y, resolution);
                difference +=
                    std::abs(static_cast<double>(map.at(face, x, y).x) - coverage(layer.region, w));
            }
        }
        EXPECT_LT(difference / 2400.0, 0.02) << round;
    }
}

TEST(LayerComposite, TouchedTexelsHoldEveryChange) {
    for (const std::uint32_t resolution : {1u, 7u, 64u, 100u}) {
        const CubeMap base = random_map(resolution, 3);
        for (const LightLayer& layer : random_layers(resolution < 50 ? 150 : 60, resolution)) {
            const CubeMap changed = composite(base, std::span(&layer, 1));
            const std::vector<TexelRectangle> touched = touched_texels(layer, resolution);
            for (const Face face : AllFaces) {
                ASSERT_LE(std::count_if(touched.begin(), touched.end(),
                                        [&](const TexelRectangle& r) { return r.face == face; }),
                          8);
                for (std::uint32_t y = 0; y < resolution; ++y) {
                    for (std::uint32_t x = 0; x < resolution; ++x) {
                        const auto holding = std::count_if(
                            touched.begin(), touched.end(),
                            [&](const TexelRectangle& r) { return contains(r, face, x, y); });
                        ASSERT_LE(holding, 1);
                        ASSERT_TRUE(holding == 1 || changed.at(face, x, y) == base.at(face, x, y));
                    }
                }
            }
            // The edit alone gives the whole map.
            CubeMap target = base;
            composite(base, std::span(&layer, 1), touched, target);
            ASSERT_TRUE(same_bits(target, changed));
        }
    }
}

TEST(LayerComposite, TouchesLittleMoreThanADisc) {
    const std::uint32_t resolution = 256;
    for (const glm::dvec3& place : Places) {
        const LightLayer layer{.name = "a", .region = Disc{place, 3.0, 0.0}};
        const CubeMap map = composite(CubeMap(resolution), std::span(&layer, 1));
        const auto num_lit = std::count_if(map.texels.begin(), map.texels.end(),
                                           [](const glm::vec3& t) { return t.x > 0; });
        std::uint64_t num_touched = 0;
        for (const TexelRectangle& r : touched_texels(layer, resolution))
            num_touched += std::uint64_t{r.x1 - r.x0} * (r.y1 - r.y0);
        // A box about a circle has 1.27 of its area; at a corner, the face's part of a disc is an
        // ellipse's sector.
        EXPECT_LT(static_cast<double>(num_touched), 2.0 * static_cast<double>(num_lit));
    }
}

TEST(LayerComposite, DoesNotDependOnHowRectanglesAreCut) {
    for (const std::uint32_t resolution : {33u, 128u}) {
        const CubeMap base = random_map(resolution, 4);
        const std::vector<LightLayer> layers = random_layers(12, resolution + 1);
        const CubeMap whole = composite(base, layers);
        CubeMap target(resolution, glm::vec3(-1.0f));
        std::vector<TexelRectangle> pieces;
        for (const Face face : AllFaces) {
            for (std::uint32_t y = 0; y < resolution; y += 13) {
                for (std::uint32_t x = 0; x < resolution; x += 29) // overlapping
                    pieces.push_back(
                        {face, x, y, std::min(x + 35, resolution), std::min(y + 13, resolution)});
            }
        }
        pieces.push_back({});
        composite(base, layers, pieces, target);
        EXPECT_TRUE(same_bits(target, whole));
        // Over what is there.
        CubeMap in_place = base;
        composite(in_place, layers, all_texels(resolution), in_place);
        EXPECT_TRUE(same_bits(in_place, whole));
    }
}

TEST(LayerComposite, LargeMapsGoPastTheCaches) {
    // Whole faces are streamed, rectangles are not.
    for (const std::uint32_t resolution : {741u, 768u}) {
        const CubeMap base = random_map(resolution, 8);
        EXPECT_TRUE(same_bits(composite(base, {}), base));
        const std::vector<LightLayer> layers = random_layers(3, 9);
        const CubeMap whole = composite(base, layers);
        CubeMap by_rows(resolution);
        std::vector<TexelRectangle> rows;
        for (const Face face : AllFaces)
            for (std::uint32_t y = 0; y < resolution; y += 57)
                rows.push_back({face, 0, y, resolution, std::min(y + 57, resolution)});
        composite(base, layers, rows, by_rows);
        EXPECT_TRUE(same_bits(by_rows, whole));
    }
}

TEST(LayerComposite, DoesNotDependOnTheNumberOfThreads) {
    const CubeMap base = random_map(200, 5);
    const std::vector<LightLayer> layers = random_layers(20, 6);
    const auto with_threads = [&](std::size_t number) {
        const files::ThreadLimit control(number);
        return composite(base, layers);
    };
    EXPECT_TRUE(same_bits(with_threads(1), with_threads(2)));
}

TEST(LayerComposite, ThousandsOfEditsLeaveNoTrace) {
    const CubeMap base = random_map(32, 8);
    std::vector<LightLayer> layers = random_layers(4, 9);
    const CubeMap before = composite(base, layers);
    CubeMap map = before;
    std::mt19937 generator(10);
    const std::vector<LightLayer> original = layers;
    for (int edit = 0; edit <= 2000; ++edit) {
        const std::size_t index = generator() % layers.size();
        const auto replace = [&](std::size_t i, const LightLayer& by) {
            std::vector<TexelRectangle> changed = touched_texels(layers[i], 32);
            layers[i] = by;
            const std::vector<TexelRectangle> more = touched_texels(by, 32);
            changed.insert(changed.end(), more.begin(), more.end());
            composite(base, layers, changed, map);
        };
        if (edit < 2000) {
            replace(index, random_layer(generator));
        } else {
            for (std::size_t i = 0; i < layers.size(); ++i)
                replace(i, original[i]);
        }
    }
    EXPECT_TRUE(same_bits(map, before));
}

TEST(LayerComposite, PlacesPictures) {
    // Red, green over blue, white: top left, top right, bottom left, bottom right, each of 8 x 8
    // pixels.
    std::vector<glm::vec3> pixels;
    for (std::uint32_t i = 0; i < 256; ++i) {
        const bool right = i % 16 >= 8, bottom = i / 16 >= 8;
        pixels.push_back(bottom ? (right ? glm::vec3(1) : glm::vec3(0, 0, 1))
                                : (right ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    }
    ImagePatch patch{"p.exr", std::make_shared<const ImagePyramid>(Picture{16, 16, pixels}),
                     ImagePatch::Blend::Replace};
    LightLayer layer{.name = "a",
                     .gain_ev = 1.0,
                     .region = Rectangle{{0, 0, -1}, 40.0, 40.0, 0.0, 0.0},
                     .effect = patch};
    const CubeMap base(128, glm::vec3(5.0f));
    CubeMap map = composite(base, std::span(&layer, 1));
    // Looking along -Z, +X is to the right.
    EXPECT_EQ(seen(map, {-0.2, 0.2, -1}), glm::vec3(2, 0, 0));
    EXPECT_EQ(seen(map, {0.2, 0.2, -1}), glm::vec3(0, 2, 0));
    EXPECT_EQ(seen(map, {-0.2, -0.2, -1}), glm::vec3(0, 0, 2));
    EXPECT_EQ(seen(map, {0.2, -0.2, -1}), glm::vec3(2, 2, 2));
    EXPECT_EQ(seen(map, {0.0, 0.6, -1}), glm::vec3(5.0f));
    // A quarter turn, counter-clockwise.
    std::get<Rectangle>(layer.region).roll_degrees = 90.0;
    map = composite(base, std::span(&layer, 1));
    EXPECT_EQ(seen(map, {-0.2, 0.2, -1}), glm::vec3(0, 2, 0));
    patch.blend = ImagePatch::Blend::Add;
    layer.effect = patch;
    EXPECT_EQ(seen(composite(base, std::span(&layer, 1)), {-0.2, 0.2, -1}), glm::vec3(5, 7, 5));
}

TEST(LayerComposite, PicturesKeepTheirEnergy) {
    // One bright pixel in a fine picture, in every place: its solid angle times its radiance.
    constexpr std::uint32_t N = 64;
    for (const std::uint32_t resolution : {8u, 32u, 256u}) {
        for (const glm::dvec3& place : Places) {
            std::vector<glm::vec3> pixels(std::size_t{N} * N, glm::vec3(1.0f, 0.0f, 0.0f));
            pixels[20 * N + 45].y = 1000.0f;
            const ImagePatch patch{"p.exr",
                                   std::make_shared<const ImagePyramid>(Picture{N, N, pixels}),
                                   ImagePatch::Blend::Replace};
            const LightLayer layer{
                .name = "a", .region = Rectangle{place, 30.0, 30.0, 20.0, 0.0}, .effect = patch};
            const glm::dvec3 power =
                total_power(composite(CubeMap(resolution), std::span(&layer, 1)));
            const double half = std::tan(radians(15.0));
            EXPECT_NEAR(power.x /
                            (4.0 * std::atan(half * half / std::sqrt(1.0 + 2.0 * half * half))),
                        1.0, 1e-3);
            const double x = half * (91.0 / N - 1.0), y = half * (41.0 / N - 1.0),
                         q = 1.0 + x * x + y * y;
            EXPECT_NEAR(power.y / (1000.0 * 4.0 * half * half / (N * N) / (q * std::sqrt(q))), 1.0,
                        0.06)
                << resolution;
        }
    }
}

TEST(LayerComposite, RefusesWhatDoesNotFit) {
    CubeMap base(8), other(9), target(8);
    const LightLayer good{.name = "a"}, bad{.name = "a", .region = Disc{.radius_degrees = -1.0}};
    EXPECT_THROW(composite(base, std::span(&good, 1), all_texels(8), other), std::invalid_argument);
    EXPECT_THROW(composite(base, std::span(&bad, 1), all_texels(8), target), std::invalid_argument);
    EXPECT_THROW(composite(base, std::span(&good, 1), all_texels(9), target),
                 std::invalid_argument);
    const TexelRectangle turned{Face::PositiveX, 5, 0, 4, 8};
    EXPECT_THROW(composite(base, std::span(&good, 1), std::span(&turned, 1), target),
                 std::invalid_argument);
    EXPECT_TRUE(same_bits(base, target)) << "nothing has changed";
    EXPECT_THROW((void)touched_texels(bad, 8), std::invalid_argument);
    EXPECT_THROW((void)touched_texels(good, 0), std::invalid_argument);
}

/// Points on a wavy line or, closed, around a wavy circle.
std::vector<glm::dvec3> wavy_points(int count, bool closed, double waves) {
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / count;
        const double angle = closed ? 2.0 * std::numbers::pi * t : 2.5 * (t - 0.5);
        const double wave = 0.15 * std::sin(waves * angle);
        if (closed)
            points.emplace_back((0.6 + wave) * std::cos(angle) + 0.3,
                                (0.6 + wave) * std::sin(angle), 1.0);
        else
            points.emplace_back(std::sin(angle), wave, std::cos(angle));
    }
    return points;
}

/// Texel by texel, with all arcs of the region, without any blocks: the composite's shapes narrowed
/// to blocks must be them bit by bit.
template<typename Region>
void expect_as_texel_by_texel(const Region& region, std::uint32_t resolution) {
    const std::vector<float> coverage = coverage_map(region, resolution);
    const RegionShape whole = shape(region);
    std::size_t i = 0;
    std::size_t num_partial = 0;
    for (const Face face : AllFaces) {
        const FaceGrid grid(face, resolution);
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x, ++i) {
                const TexelRange texel(x, y, 1, resolution);
                const auto expected = std::visit(
                    [&](const auto& of_kind) {
                        switch (bound(of_kind, grid, texel)) {
                        case Overlap::None:
                            return 0.0f;
                        case Overlap::All:
                            return 1.0f;
                        default:
                            return static_cast<float>(
                                mean_coverage(of_kind, grid.plane, grid.square(x, y)));
                        }
                    },
                    whole);
                ASSERT_EQ(coverage[i], expected)
                    << static_cast<int>(face) << ": " << x << ", " << y;
                num_partial += static_cast<std::size_t>(expected > 0.0f && expected < 1.0f);
            }
    }
    EXPECT_GT(num_partial, 10u);
}

TEST(LayerComposite, StrokesAndLassosAreTheSameWithAllTheirArcs) {
    for (const std::uint32_t resolution : {50u, 128u}) {
        for (const int count : {1, 2, 7, 40, 300})
            for (const double softness : {0.0, 0.4, 1.0})
                expect_as_texel_by_texel(
                    Stroke{wavy_points(count, false, 5.0), count > 100 ? 12.0 : 6.0, softness},
                    resolution);
        for (const int count : {3, 12, 150})
            for (const double softness : {0.0, 5.0, 40.0})
                expect_as_texel_by_texel(Lasso{wavy_points(count, true, 7.0), softness},
                                         resolution);
    }
}

} // namespace
} // namespace relumine::cubemap
