#include "lights/median_cut.h"

#include <bit>
#include <numbers>

#include <gtest/gtest.h>

#include "lights/place_lights.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {

namespace {

/// The paper's steps word by word: every cut tried, every sum added anew.
class NaiveMedianCut {
public:
    explicit NaiveMedianCut(const cubemap::EnvironmentImage& image) : image_(image) {
        cubemap::for_each_pixel(cubemap::shape_of(image),
                                [&](std::size_t pixel, const cubemap::PixelPlace& place) {
                                    const glm::vec3& rgb = image.pixels[pixel];
                                    energy_.push_back((0.2125 * static_cast<double>(rgb.r) +
                                                       0.7154 * static_cast<double>(rgb.g) +
                                                       0.0721 * static_cast<double>(rgb.b)) *
                                                      place.solid_angle);
                                });
    }

    [[nodiscard]] double energy(const PixelRectangle& r) const {
        double sum = 0.0;
        for (std::uint32_t y = r.y0; y < r.y1; ++y)
            for (std::uint32_t x = r.x0; x < r.x1; ++x)
                sum += energy_[y * image_.width + x];
        return sum;
    }

    [[nodiscard]] std::vector<PixelRectangle> regions(std::size_t n) const {
        std::vector<PixelRectangle> all = {{0, 0, image_.width, image_.height}};
        if (std::has_single_bit(n)) {
            for (; all.size() < n;) {
                std::vector<PixelRectangle> next;
                for (const PixelRectangle& r : all)
                    cut(r, next);
                all = next;
            }
            return all;
        }
        while (all.size() < n) {
            std::size_t most = 0;
            for (std::size_t i = 1; i < all.size(); ++i)
                if (energy(all[i]) > energy(all[most]))
                    most = i;
            std::vector<PixelRectangle> halves;
            cut(all[most], halves);
            all[most] = halves[0];
            all.push_back(halves[1]);
        }
        return all;
    }

private:
    void cut(const PixelRectangle& r, std::vector<PixelRectangle>& out) const {
        const double height = std::numbers::pi * r.height() / image_.height;
        const double inclination = std::numbers::pi * (0.5 - 0.5 * (r.y0 + r.y1) / image_.height);
        const double width =
            2.0 * std::numbers::pi * r.width() / image_.width * std::cos(inclination);
        const bool columns = r.height() == 1 || (r.width() > 1 && width >= height);
        double best = 1e300;
        PixelRectangle first, second;
        for (std::uint32_t at = (columns ? r.x0 : r.y0) + 1; at < (columns ? r.x1 : r.y1); ++at) {
            PixelRectangle a = r, b = r;
            (columns ? a.x1 : a.y1) = at;
            (columns ? b.x0 : b.y0) = at;
            const double imbalance = std::abs(energy(a) - energy(b));
            if (imbalance < best) {
                best = imbalance;
                first = a;
                second = b;
            }
        }
        out.push_back(first);
        out.push_back(second);
    }

    const cubemap::EnvironmentImage& image_;
    std::vector<double> energy_;
};

TEST(MedianCut, CutsWhereTheNaiveOneDoes) {
    for (const auto& image : {wild(48, 24), wild(31, 17, 4), wild(20, 40, 5)}) {
        const LatLongGrid grid(image);
        const NaiveMedianCut naive(image);
        for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 8u, 11u, 16u, 27u, 32u})
            EXPECT_EQ(median_cut(grid, n), naive.regions(n))
                << image.width << "x" << image.height << " " << n;
    }
}

TEST(MedianCut, WorkedByHand) {
    // Constant: across, then (2 x 2 pixels are pi wide and pi high) across again, then along.
    const auto even = constant(4, 2, glm::vec3(1.0f));
    const LatLongGrid grid(even);
    EXPECT_EQ(median_cut(grid, 1), (std::vector<PixelRectangle>{{0, 0, 4, 2}}));
    EXPECT_EQ(median_cut(grid, 2), (std::vector<PixelRectangle>{{0, 0, 2, 2}, {2, 0, 4, 2}}));
    EXPECT_EQ(median_cut(grid, 4), (std::vector<PixelRectangle>{
                                       {0, 0, 1, 2}, {1, 0, 2, 2}, {2, 0, 3, 2}, {3, 0, 4, 2}}));
    EXPECT_EQ(median_cut(grid, 8)[1], (PixelRectangle{0, 1, 1, 2}));

    // One row, 8 | 1 1 1 1 1 1 1: the first cut leaves 8 and 7; the bright pixel cannot be cut, so
    // the other region is.
    const auto row = lat_long(
        8, 1, [](std::uint32_t x, std::uint32_t) { return glm::vec3(x == 0 ? 8.0f : 1.0f); });
    const LatLongGrid row_grid(row);
    EXPECT_EQ(median_cut(row_grid, 2), (std::vector<PixelRectangle>{{0, 0, 1, 1}, {1, 0, 8, 1}}));
    const auto three = median_cut(row_grid, 3);
    EXPECT_EQ(three[0], (PixelRectangle{0, 0, 1, 1}));
    EXPECT_EQ(three[1].width() + three[2].width(), 7u);
    EXPECT_LE(three[1].width() > three[2].width() ? three[1].width() : three[2].width(), 4u);
    // Rounds of cutting all regions leave one short here; the region with most energy makes it up.
    EXPECT_EQ(median_cut(row_grid, 4).size(), 4u);
    EXPECT_EQ(median_cut(row_grid, 8).size(), 8u);
}

TEST(MedianCut, ColumnsNearThePolesAreNarrow) {
    // All light in the top row of 16: seen from above a small cap, wide in the image only.
    const auto image = lat_long(
        32, 16, [](std::uint32_t, std::uint32_t y) { return glm::vec3(y < 4 ? 1.0f : 0.0f); });
    const LatLongGrid grid(image);
    for (const PixelRectangle& region : median_cut(grid, 4)) {
        if (region.y1 <= 4) {
            EXPECT_GT(region.width() * 2.0 * std::numbers::pi / 32,
                      region.height() * std::numbers::pi / 16);
        }
    }
}

TEST(MedianCut, EqualEnergyWhereTheMapAllowsIt) {
    const auto image = lat_long(512, 256, [](std::uint32_t x, std::uint32_t y) {
        return glm::vec3(1.0f + static_cast<float>((x * y) % 7));
    });
    const auto lights = place(Method::MedianCut, image, 64).lights;
    const double share = luminance(total_irradiance(lights)) / 64.0;
    for (const DistantLight& light : lights)
        EXPECT_NEAR(luminance(light.irradiance), share, 0.1 * share);
}

TEST(MedianCut, TheLightStandsAtTheCentroidInTheColourOfItsRegion) {
    // One lamp of two pixels, green and dim red: the centroid lies between them, nearer to green.
    auto image = constant(64, 32, glm::vec3(0.0f));
    image.pixels[16 * 64 + 20] = {0.0f, 3.0f, 0.0f};
    image.pixels[16 * 64 + 21] = {1.0f, 0.0f, 0.0f};
    const DistantLight light = place(Method::MedianCut, image, 1).lights[0];
    const double area = LatLongGrid(image).solid_angle(20, 16);
    EXPECT_NEAR(light.irradiance.r, area, 1e-12);
    EXPECT_NEAR(light.irradiance.g, 3.0 * area, 1e-12);
    EXPECT_EQ(light.irradiance.b, 0.0);
    const double pixel = 2.0 * std::numbers::pi / 64.0;
    const double longitude = std::atan2(light.direction.x, light.direction.z);
    const double expected = std::numbers::pi - pixel * (20.5 + 0.2125 / (0.2125 + 3.0 * 0.7154));
    EXPECT_NEAR(longitude, expected, 1e-4);
    EXPECT_NEAR(std::asin(light.direction.y), -0.5 * std::numbers::pi / 32.0, 1e-4);
}

} // namespace
} // namespace relumine::lights
