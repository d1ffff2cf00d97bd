#include "relight/kernels/cluster_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "relight/kernels/texel_kernel.h"
#include "relight/radiance.h"
#include "tests/prt/every_target.h"
#include "tests/prt/scenes.h"
#include "tests/relight/environments.h"

namespace relumine::relight {
namespace {

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance,
                 const std::string& what) {
    EXPECT_LE(glm::length(a - b), tolerance) << what;
}

void expect_near(const VectorIrradiance& a, const VectorIrradiance& b, double tolerance,
                 const std::string& what) {
    expect_near(a.red, b.red, tolerance, what + ", red");
    expect_near(a.green, b.green, tolerance, what + ", green");
    expect_near(a.blue, b.blue, tolerance, what + ", blue");
}

VectorIrradiance total(std::span<const VectorIrradiance> sums) {
    VectorIrradiance result;
    for (const VectorIrradiance& sum : sums)
        result += sum;
    return result;
}

/// The sum of L dw w over the texels with their exact vector irradiance, or with dw times the
/// centre's direction.
VectorIrradiance sum_over_texels(const cubemap::CubeMap& environment, bool exact) {
    VectorIrradiance result;
    const std::uint32_t r = environment.resolution;
    const double n = r;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < r; ++y)
            for (std::uint32_t x = 0; x < r; ++x) {
                const glm::dvec3 e =
                    exact ? scenes::vector_irradiance_of_white(face, x / n, y / n, (x + 1) / n,
                                                               (y + 1) / n)
                          : cubemap::solid_angle(x / n, y / n, (x + 1) / n, (y + 1) / n) *
                                cubemap::texel_direction(face, x, y, r);
                const glm::dvec3 radiance = environment.at(face, x, y);
                result += {.red = radiance.r * e, .green = radiance.g * e, .blue = radiance.b * e};
            }
    return result;
}

double power_of(const cubemap::CubeMap& environment) {
    const glm::dvec3 power = cubemap::total_power(environment);
    return power.r + power.g + power.b;
}

// Weights are stored in float: 2^-24, here with room for a sum.
constexpr double FloatWeights = 1e-7;

// A part of side h (in u) stands for itself by its centre. The solid angle's density falls by up to
// 1 for each unit of u or v, and u and v have the variance h^2 / 12 in it: relative error h^2 / 6.
double midpoint_error(double h) {
    return h * h / 6.0;
}

TEST(LightBinning, LeavesThatFitTexelsAddUpToTheDirectSum) {
    std::mt19937 random(1);
    for (const std::uint32_t r : {32u, 64u}) {
        const prt::Quadtree tree(scenes::random_split_flags(random, 5, 0.7));
        const cubemap::CubeMap environment = scenes::random_environment(r, r);
        const auto sums = LightBinning(r).sums(environment, tree.leaves());
        ASSERT_EQ(sums.size(), tree.num_leaves());
        expect_near(total(sums), sum_over_texels(environment, false),
                    FloatWeights * power_of(environment), "R = " + std::to_string(r));
    }
}

TEST(LightBinning, LeavesThatCutTexelsAddUpToTheExactSum) {
    std::mt19937 random(2);
    for (const std::uint32_t r : {1u, 2u, 5u, 12u, 16u, 100u}) {
        const prt::Quadtree tree(scenes::random_split_flags(random, 6, 0.8));
        const cubemap::CubeMap environment = scenes::random_environment(r, r);
        const auto sums = LightBinning(r).sums(environment, tree.leaves());
        // Leaves may be large, but then they are summed texel by texel.
        expect_near(total(sums), sum_over_texels(environment, true),
                    (midpoint_error(std::min(2.0 / r, 2.0)) + FloatWeights) * power_of(environment),
                    "R = " + std::to_string(r));
    }
}

TEST(LightBinning, EveryLeafGetsItsOwnPart) {
    // Against each texel's exact overlap with each leaf.
    std::mt19937 random(3);
    for (const std::uint32_t r : {3u, 8u, 12u, 20u}) {
        const prt::Quadtree tree(scenes::random_split_flags(random, 5, 0.75));
        const cubemap::CubeMap environment = scenes::random_environment(r, 10 + r);
        const LightBinning binning(r);
        const double n = r;
        for (const prt::Cell& cell : tree.leaves()) {
            VectorIrradiance expected;
            double power = 0.0;
            const double size = cell.size();
            for (std::uint32_t y = 0; y < r; ++y)
                for (std::uint32_t x = 0; x < r; ++x) {
                    const double s0 = std::max(x / n, cell.x * size),
                                 s1 = std::min((x + 1) / n, (cell.x + 1) * size);
                    const double t0 = std::max(y / n, cell.y * size),
                                 t1 = std::min((y + 1) / n, (cell.y + 1) * size);
                    if (s0 >= s1 || t0 >= t1)
                        continue;
                    const glm::dvec3 radiance = environment.at(cell.face, x, y);
                    const glm::dvec3 e =
                        scenes::vector_irradiance_of_white(cell.face, s0, t0, s1, t1);
                    expected +=
                        {.red = radiance.r * e, .green = radiance.g * e, .blue = radiance.b * e};
                    power += (radiance.r + radiance.g + radiance.b) *
                             cubemap::solid_angle(s0, t0, s1, t1);
                }
            expect_near(binning.sum(environment, cell), expected,
                        (midpoint_error(2.0 * std::min(1.0 / n, size)) + FloatWeights) * power,
                        "R = " + std::to_string(r) + ", level " + std::to_string(cell.level));
        }
    }
}

TEST(LightBinning, AllCellsAtOnceHaveTheBitsOfEachAlone) {
    // Cells higher than a column may be, as high as a column is wide, smaller, and larger than the
    // part of a face that is read at once; and a resolution whose cells do not fit columns.
    std::mt19937 random(4);
    for (const std::uint32_t r : {64u, 192u, 1024u}) {
        const prt::Quadtree tree(scenes::random_split_flags(random, 8, 0.8));
        const cubemap::CubeMap environment = scenes::random_environment(r, 10 + r);
        const LightBinning binning(r);
        scenes::on_every_target([&] {
            const auto sums = binning.sums(environment, tree.leaves());
            for (std::size_t i = 0; i < sums.size(); ++i)
                ASSERT_EQ(sums[i], binning.sum(environment, tree.leaves()[i]))
                    << "R = " << r << ", level " << tree.leaves()[i].level;
        });
    }
}

TEST(LightBinning, RefusesWhatIsNoRadiance) {
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    std::mt19937 random(4);
    const prt::Quadtree tree(scenes::random_split_flags(random, 6, 0.8));
    for (const std::uint32_t r : {32u, 256u}) {
        cubemap::CubeMap environment = scenes::random_environment(r, 3);
        const LightBinning binning(r);
        const auto sums = [&] {
            return binning.sums(environment, tree.leaves(), LightBinning::Texels::Unchecked);
        };
        scenes::on_every_target([&] {
            float& value = environment.at(cubemap::Face::NegativeZ, r - 1, r / 3).z;
            for (const float bad :
                 {-1e-30f, -Infinity, Infinity, std::nanf(""), 1.01f * MaxRadiance}) {
                value = bad;
                EXPECT_THROW(static_cast<void>(sums()), std::invalid_argument) << r << " " << bad;
            }
            for (const float good : {0.0f, -0.0f, MaxRadiance}) {
                value = good;
                EXPECT_NO_THROW(static_cast<void>(sums())) << r << " " << good;
            }
            value = 1.0f;
        });
    }
}

TEST(LightBinning, CellsMayOverlap) {
    const cubemap::CubeMap environment = scenes::random_environment(256, 3);
    const LightBinning binning(256);
    const auto cell = [](std::uint8_t level, std::uint32_t x) {
        return prt::Cell{.face = cubemap::Face::PositiveY, .level = level, .x = x, .y = x};
    };
    const std::vector<prt::Cell> cells = {cell(5, 9), cell(3, 2), cell(4, 4), cell(3, 2)};
    const auto sums = binning.sums(environment, cells);
    for (std::size_t i = 0; i < cells.size(); ++i)
        EXPECT_EQ(sums[i], binning.sum(environment, cells[i])) << i;
}

TEST(LightBinning, WhiteFaceHasTheVectorIrradianceOfASquare) {
    // Half the sum over four edges of the angle acos(1/3) times the edge plane's normal, which
    // leans by 45 degrees.
    const double expected = 2.0 * std::acos(1.0 / 3.0) / std::sqrt(2.0);
    for (const std::uint32_t r : {64u, 100u, 256u}) {
        const cubemap::CubeMap white(r, glm::vec3(1.0f, 2.0f, 0.0f));
        const LightBinning binning(r);
        for (const cubemap::Face face : cubemap::AllFaces) {
            const VectorIrradiance sum = binning.sum(white, {.face = face});
            const glm::dvec3 e = expected * cubemap::direction(face, 0.5, 0.5);
            expect_near(sum, {.red = e, .green = 2.0 * e}, 2.0 * expected * midpoint_error(2.0 / r),
                        "face");
        }
    }
}

TEST(LightBinning, ACellIsTheSumOfItsChildren) {
    std::mt19937 random(4);
    for (const std::uint32_t r : {1u, 5u, 16u, 64u, 100u}) {
        const cubemap::CubeMap environment = scenes::random_environment(r, 20 + r);
        const LightBinning binning(r);
        for (const prt::Cell cell :
             {prt::Cell{}, prt::Cell{.face = cubemap::Face::NegativeZ, .level = 2, .x = 1, .y = 3},
              prt::Cell{.face = cubemap::Face::PositiveY, .level = 4, .x = 9, .y = 2}}) {
            VectorIrradiance children;
            for (std::uint32_t i = 0; i < 4; ++i)
                children += binning.sum(environment, cell.child(i));
            const VectorIrradiance sum = binning.sum(environment, cell);
            const double power =
                glm::length(sum.red) + glm::length(sum.green) + glm::length(sum.blue);
            // Where the children cut texels, the cell still takes them whole.
            const bool fits = r % (2u << cell.level) == 0;
            const double h = 2.0 * std::min(1.0 / r, cell.size());
            expect_near(sum, children, power * (FloatWeights + (fits ? 0.0 : midpoint_error(h))),
                        "R = " + std::to_string(r));
        }
    }
}

TEST(LightBinning, ALightOfOneTexelIsItsDirectionTimesItsPower) {
    cubemap::CubeMap environment(32);
    environment.at(cubemap::Face::NegativeX, 7, 30) = {100.0f, 0.0f, 1.0f};
    const VectorIrradiance sum = LightBinning(32).sum(
        environment, {.face = cubemap::Face::NegativeX, .level = 1, .x = 0, .y = 1});
    const double power = 100.0 * cubemap::solid_angle(7 / 32.0, 30 / 32.0, 8 / 32.0, 31 / 32.0);
    expect_near(sum.red, power * cubemap::texel_direction(cubemap::Face::NegativeX, 7, 30, 32),
                FloatWeights * power, "");
    EXPECT_EQ(sum.green, glm::dvec3(0.0));
    // Products with the weights are in float: half a unit of 2^-24 each.
    expect_near(sum.blue, 0.01 * sum.red, 1e-7 * glm::length(sum.blue), "");
    EXPECT_EQ(LightBinning(32).sum(environment, {.face = cubemap::Face::NegativeX, .level = 1}),
              VectorIrradiance{});
}

TEST(TexelSums, EqualAPlainLoopForAnySizeOnEveryTarget) {
    std::mt19937 random(8);
    std::uniform_real_distribution<float> value(0.0f, 2.0f);
    constexpr std::size_t Stride = 60;
    for (const std::size_t width : {1u, 3u, 4u, 7u, 8u, 16u, 17u, 31u, 60u})
        for (const std::size_t height : {1u, 2u, 63u, 64u, 65u, 200u}) {
            // What lies beside the rectangle must not matter, not even to lanes that are not
            // counted.
            constexpr float Outside = std::numeric_limits<float>::quiet_NaN();
            std::vector<glm::vec3> radiance((height - 1) * Stride + width, glm::vec3(Outside));
            std::vector<float> weights(radiance.size(), Outside);
            TexelSums expected;
            for (std::size_t y = 0; y < height; ++y)
                for (std::size_t x = 0; x < width; ++x) {
                    const std::size_t i = y * Stride + x;
                    radiance[i] = {value(random), value(random),
                                   x == width / 2 ? 1e5f : value(random)};
                    weights[i] = value(random);
                    const glm::dvec3 weighted =
                        glm::dvec3(radiance[i]) * static_cast<double>(weights[i]);
                    expected.one += weighted;
                    expected.x += weighted * static_cast<double>(x);
                    expected.y += weighted * static_cast<double>(y);
                }
            scenes::on_every_target([&] {
                const TexelSums sums =
                    texel_sums(radiance.data(), weights.data(), Stride, width, height);
                // At most 64 additions in float, errors half a unit of 2^-24 each that mostly
                // cancel.
                for (int channel = 0; channel < 3; ++channel) {
                    EXPECT_NEAR(sums.one[channel], expected.one[channel],
                                1e-6 * expected.one[channel]);
                    EXPECT_NEAR(sums.x[channel], expected.x[channel], 1e-6 * expected.x[channel]);
                    EXPECT_NEAR(sums.y[channel], expected.y[channel], 1e-6 * expected.y[channel]);
                }
            });
        }
}

TEST(LightBinning, AnyNumberOfThreadsGivesTheSameBits) {
    std::mt19937 random(5);
    const prt::Quadtree tree(scenes::random_split_flags(random, 5, 0.8));
    const cubemap::CubeMap environment = scenes::random_environment(30, 6);
    const LightBinning binning(30);
    std::vector<VectorIrradiance> first;
    for (const std::size_t num_threads : {1u, 2u, 3u}) {
        const files::ThreadLimit threads(num_threads);
        const auto sums = binning.sums(environment, tree.leaves());
        if (!first.empty()) {
            EXPECT_EQ(sums, first);
        }
        first = sums;
    }
}

} // namespace
} // namespace relumine::relight
