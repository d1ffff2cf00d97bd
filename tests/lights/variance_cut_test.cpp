#include "lights/variance_cut.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "lights/place_lights.h"
#include "tests/lights/test_maps.h"

namespace relumine::lights {

namespace {

/// By the definition: the centroid first, then every pixel's distance from it; every cut tried.
class NaiveVarianceCut {
public:
    explicit NaiveVarianceCut(const LatLongGrid& grid) : grid_(grid) {}

    struct Sums {
        double energy = 0.0, variance = 0.0;
    };
    [[nodiscard]] Sums sums(const PixelRectangle& r) const {
        glm::dvec3 moment(0.0);
        Sums result;
        const auto each = [&](const auto& visit) {
            for (std::uint32_t y = r.y0; y < r.y1; ++y)
                for (std::uint32_t x = r.x0; x < r.x1; ++x)
                    visit(luminance(grid_.radiance(x, y)), grid_.moments(x, y));
        };
        each([&](double value, const glm::dvec4& m) {
            moment += value * glm::dvec3(m);
            result.energy += value * m.w;
        });
        if (result.energy <= 0.0)
            return {};
        const glm::dvec3 c = moment / result.energy;
        each([&](double value,
                 const glm::dvec4& m) { // integral of |w - c|^2 over the pixel, |w| = 1
            result.variance +=
                value * (m.w - 2.0 * glm::dot(c, glm::dvec3(m)) + glm::dot(c, c) * m.w);
        });
        return result;
    }

    [[nodiscard]] std::vector<PixelRectangle> regions(std::size_t n) const {
        std::vector<PixelRectangle> all = {grid_.whole()};
        while (all.size() < n) {
            std::size_t next = all.size();
            double largest = -1.0;
            for (std::size_t i = 0; i < all.size(); ++i) {
                const Sums s = sums(all[i]);
                const double error = s.energy * std::sqrt(std::max(s.variance, 0.0));
                if (all[i].width() * all[i].height() > 1 && error > largest) {
                    largest = error;
                    next = i;
                }
            }
            const PixelRectangle r = all[next];
            double best = 1e300;
            PixelRectangle first, second;
            const auto consider = [&](const PixelRectangle& a, const PixelRectangle& b) {
                const double sum = sums(a).variance + sums(b).variance;
                if (sum < best) {
                    best = sum;
                    first = a;
                    second = b;
                }
            };
            for (std::uint32_t x = r.x0 + 1; x < r.x1; ++x)
                consider({r.x0, r.y0, x, r.y1}, {x, r.y0, r.x1, r.y1});
            for (std::uint32_t y = r.y0 + 1; y < r.y1; ++y)
                consider({r.x0, r.y0, r.x1, y}, {r.x0, y, r.x1, r.y1});
            all[next] = first;
            all.push_back(second);
        }
        return all;
    }

private:
    const LatLongGrid& grid_;
};

TEST(VarianceCut, CutsWhereTheNaiveOneDoes) {
    for (const auto& image : {wild(24, 12), wild(17, 9, 4), wild(10, 20, 5)}) {
        const LatLongGrid grid(image);
        const NaiveVarianceCut naive(grid);
        for (const std::size_t n : {1u, 2u, 3u, 5u, 8u, 20u, 32u})
            EXPECT_EQ(variance_cut(grid, n), naive.regions(n))
                << image.width << "x" << image.height << " " << n;
    }
}

/// [VD09] Fig. 2: two lamps, the left one three times as bright, on a dark map.
cubemap::EnvironmentImage two_lamps() {
    return lat_long(64, 32, [](std::uint32_t x, std::uint32_t y) {
        const bool level = y >= 14 && y < 18;
        return glm::vec3(level && x >= 10 && x < 16   ? 3.0f
                         : level && x >= 40 && x < 46 ? 1.0f
                                                      : 0.0f);
    });
}

TEST(VarianceCut, GivesEachOfTwoLampsItsLightWhereMedianCutCutsThroughTheBrighter) {
    const auto image = two_lamps();
    const glm::dvec3 bright = LatLongGrid(image).centre({10, 14, 16, 18});
    const glm::dvec3 dim = LatLongGrid(image).centre({40, 14, 46, 18});

    const Placement variance = place(Method::VarianceCut, image, 2);
    EXPECT_NEAR(glm::distance(variance.lights[0].direction, bright), 0.0, 1e-9);
    EXPECT_NEAR(glm::distance(variance.lights[1].direction, dim), 0.0, 1e-9);
    EXPECT_NEAR(variance.lights[0].irradiance.g, 3.0 * variance.lights[1].irradiance.g, 1e-9);

    const Placement median = place(Method::MedianCut, image, 2);
    EXPECT_GT(median.regions[0].x1, 10u);
    EXPECT_LT(median.regions[0].x1, 16u);
    EXPECT_NEAR(median.lights[0].irradiance.g, median.lights[1].irradiance.g, 1e-9);
    // The second light has the dim lamp and a third of the bright one, and stands between them
    // where no light comes from.
    EXPECT_GT(glm::distance(median.lights[1].direction, dim), 0.5);
    EXPECT_GT(glm::distance(median.lights[1].direction, bright), 0.5);
}

TEST(VarianceCut, PolesAreOnePlace) {
    // A lamp around the pole is wide in the image but small on the sphere: it is not cut before a
    // wide one at the horizon.
    const auto image = lat_long(64, 32, [](std::uint32_t x, std::uint32_t y) {
        return glm::vec3(y < 2 ? 10.0f : y >= 14 && y < 18 && x >= 16 && x < 48 ? 1.0f : 0.0f);
    });
    const auto lights = place(Method::VarianceCut, image, 3).lights;
    const auto at_the_pole =
        std::count_if(lights.begin(), lights.end(), [](const DistantLight& light) {
            return light.direction.y > 0.999 && light.irradiance.g > 0.0;
        });
    EXPECT_EQ(at_the_pole, 1);
}

} // namespace
} // namespace relumine::lights
