#include "cubemap/resample/pixel_symmetry.h"

#include <map>

#include <gtest/gtest.h>

#include "cubemap/resample/pixel_shares.h"

namespace relumine::cubemap::detail {
namespace {

using Shares = std::map<std::pair<std::uint32_t, std::uint32_t>, double>;

/// Solid angles of all pairs of pixel and texel.
Shares all_shares(const ImageShape& shape, const glm::dmat3& turn, std::uint32_t resolution,
                  std::span<const PixelSymmetry> symmetries) {
    Shares result;
    std::vector<PixelShare> row;
    RowsOfShares finder(shape, turn, resolution, symmetries);
    for (std::uint32_t y = 0; y < PixelFootprints(shape).num_rows(); ++y) {
        finder.find(y, row);
        for (const PixelShare& share : row)
            result[{share.pixel, share.texel}] += share.solid_angle;
    }
    return result;
}

void expect_same(const ImageShape& shape, const glm::dmat3& turn, std::uint32_t resolution,
                 std::size_t num_symmetries) {
    const std::vector<PixelSymmetry> symmetries = pixel_symmetries(shape, turn, resolution);
    EXPECT_EQ(symmetries.size(), num_symmetries) << name(shape.layout) << shape.width;
    const Shares fast = all_shares(shape, turn, resolution, symmetries),
                 plain = all_shares(shape, turn, resolution, std::span(symmetries).first(1));
    double largest = 0.0;
    for (const auto& [pair, solid_angle] : plain) {
        const auto found = fast.find(pair);
        largest =
            std::max(largest, std::abs(solid_angle - (found == fast.end() ? 0.0 : found->second)));
    }
    for (const auto& [pair, solid_angle] : fast)
        largest = std::max(largest, plain.contains(pair) ? 0.0 : solid_angle);
    EXPECT_LT(largest, 1e-7) << name(shape.layout) << ' ' << shape.width << ' ' << resolution;
}

TEST(PixelSymmetry, SharesAreThoseOfEveryPixelByItself) {
    const glm::dmat3 quarter = turn_about_y(90.0), over = turn_about_x(90.0);
    const glm::dmat3 mirror = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    for (const std::uint32_t resolution : {8u, 9u}) {
        for (const Layout layout : {Layout::AngularMap, Layout::MirrorBall, Layout::Octahedral}) {
            for (const std::uint32_t width : {20u, 21u}) {
                const ImageShape shape{layout, Sampling::TexelCentres, width, width};
                expect_same(shape, glm::dmat3(1.0), resolution, 8);
                expect_same(shape, quarter * over * mirror, resolution, 8);
                expect_same(shape, turn_about_y(20.0), resolution, 1);
            }
        }
        for (const Sampling sampling : {Sampling::TexelCentres, Sampling::Borders}) {
            const bool is_centred = sampling == Sampling::TexelCentres;
            const ImageShape shape{Layout::LatLong, sampling, 32, 16};
            expect_same(shape, glm::dmat3(1.0), resolution, is_centred ? 16 : 4);
            expect_same(shape, over, resolution, is_centred ? 16 : 4);
            expect_same({Layout::LatLong, sampling, 30, 15}, quarter, resolution, 4);
        }
        expect_same({Layout::Cube, Sampling::TexelCentres, 6, 36}, quarter, resolution, 1);
    }
}

} // namespace
} // namespace relumine::cubemap::detail
