#include "relight/reference/exact.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <set>
#include <stop_token>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/image/image_layout.h"
#include "cubemap/resample/pixel_parts.h"
#include "files/parallel.h"
#include "relight/relighter.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

TEST(Exact, EqualsALoopOverTexelsWithSingleRays) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 3; i < scene.receivers.size(); i += 4)
        some.push_back(i);
    for (const std::uint32_t r : {1u, 6u, 16u}) { // tiles of 4 x 4: one of them cut, several, none
        const cubemap::CubeMap environment = scenes::random_environment(r, r);
        const auto radiance = exact_radiance(scene.receivers, some, scene.rays, environment,
                                             {.bias = scene.options.bias});
        ASSERT_EQ(radiance.size(), some.size());
        for (std::size_t i = 0; i < some.size(); ++i) {
            const glm::vec3& normal = scene.receivers.normals[some[i]];
            const glm::vec3 origin =
                prt::ray_origin(scene.receivers.positions[some[i]], normal, scene.options.bias);
            glm::dvec3 expected(0.0);
            for (const cubemap::Face face : cubemap::AllFaces)
                for (std::uint32_t y = 0; y < r; ++y)
                    for (std::uint32_t x = 0; x < r; ++x) {
                        const glm::dvec3 w = cubemap::texel_direction(face, x, y, r);
                        const double cosine = glm::dot(glm::dvec3(normal), w);
                        const double n = r;
                        const double dw =
                            cubemap::solid_angle(x / n, y / n, (x + 1) / n, (y + 1) / n);
                        if (cosine > 0.0 && !scene.rays.occluded(origin, glm::vec3(w)))
                            expected += glm::dvec3(environment.at(face, x, y)) *
                                        (cosine * dw / std::numbers::pi);
                    }
            EXPECT_LT(glm::length(radiance[i] - expected), 1e-6 * (1.0 + glm::length(expected)));
        }
    }
}

/// An image of one radiance.
cubemap::EnvironmentImage flat_image(cubemap::Layout layout, std::uint32_t face_resolution) {
    const cubemap::ImageSize size = cubemap::natural_size(layout, face_resolution);
    cubemap::EnvironmentImage image;
    image.layout = layout;
    image.width = size.width;
    image.height = size.height;
    image.pixels.assign(std::size_t{size.width} * size.height, glm::vec3(1.0f));
    return image;
}

TEST(ExactOfFile, EveryLayoutIsAWhiteFurnace) {
    const prt::Receivers receivers{.positions = std::vector<glm::vec3>(3, glm::vec3(0.0f)),
                                   .normals = {{0, 1, 0}, {0.6f, -0.8f, 0.0f}, {0, 0, -1}}};
    const std::vector<std::uint32_t> all = {0, 1, 2};
    for (const cubemap::Layout layout : cubemap::AllLayouts)
        for (const std::uint32_t r : {8u, 64u, 400u}) { // pixels cut, as they are, and in groups
            const auto image =
                std::make_shared<const cubemap::EnvironmentImage>(flat_image(layout, r));
            for (const glm::dvec3& b : exact_radiance(receivers, all, scenes::no_blockers(),
                                                      cubemap::EnvironmentFile{.image = image}))
                EXPECT_NEAR(b.g, 1.0, 3e-3) << cubemap::name(layout) << " " << r;
        }
}

TEST(ExactOfFile, ABrightPixelIsASmallAreaWhereItIs) {
    // One pixel of a lat-long over a half-plane's edge: the part of its area that the receiver
    // sees.
    cubemap::EnvironmentImage image = flat_image(cubemap::Layout::LatLong, 16);
    std::fill(image.pixels.begin(), image.pixels.end(), glm::vec3(0.0f));
    constexpr std::uint32_t X = 20, Y = 5; // of 64 x 32
    image.pixels[Y * image.width + X] = glm::vec3(1000.0f);
    const auto shared = std::make_shared<const cubemap::EnvironmentImage>(image);
    const prt::Receivers receivers{.positions = {glm::vec3(0.0f)}, .normals = {{0, 1, 0}}};
    const std::vector<std::uint32_t> one = {0};
    const double top = std::numbers::pi * Y / 32.0, bottom = std::numbers::pi * (Y + 1) / 32.0;
    // The integral of the cosine over the pixel: half of its longitudes times the squared sines.
    const double expected = 1000.0 / std::numbers::pi * (2.0 * std::numbers::pi / 64.0) * 0.5 *
                            (std::sin(bottom) * std::sin(bottom) - std::sin(top) * std::sin(top));
    for (const double degrees : {0.0, 77.0}) {
        const cubemap::EnvironmentFile file{.image = shared,
                                            .turn = cubemap::turn_about_y(degrees)};
        EXPECT_NEAR(exact_radiance(receivers, one, scenes::no_blockers(), file)[0].r, expected,
                    1e-4 * expected);
    }
    // A blocker of one side of the world cuts it in two where its edge is.
    const double longitude = (0.5 - (X + 0.25) / 64.0) * 2.0 * std::numbers::pi;
    class Wedge final : public prt::Blockers {
    public:
        explicit Wedge(double longitude) : longitude_(longitude) {}
        [[nodiscard]] std::uint32_t occluded(const glm::vec3&, const prt::DirectionPacket& w,
                                             std::uint32_t active) const override {
            std::uint32_t blocked = 0;
            for (std::uint32_t i = 0; i < prt::PacketSize; ++i)
                blocked |=
                    static_cast<std::uint32_t>(std::atan2(static_cast<double>(w.x[i]),
                                                          static_cast<double>(w.z[i])) < longitude_)
                    << i;
            return blocked & active;
        }

    private:
        double longitude_;
    };
    EXPECT_NEAR(exact_radiance(receivers, one, Wedge(longitude),
                               cubemap::EnvironmentFile{.image = shared})[0]
                    .r,
                0.25 * expected, 0.01 * expected);
}

TEST(ExactOfFile, PixelsThatShareARayGiveTheLightOfAll) {
    // Four pixels to a ray, each of its own radiance, behind edges of a mesh.
    cubemap::EnvironmentImage image = flat_image(cubemap::Layout::LatLong, 256);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> radiance(0.0f, 1.0f);
    for (glm::vec3& pixel : image.pixels)
        pixel = glm::vec3(radiance(random), radiance(random), radiance(random));
    const scenes::RelitScene& scene = scenes::relit_scene();
    const std::vector<std::uint32_t> some = {5, 60, 120, 200, 280};
    const auto shared = std::make_shared<const cubemap::EnvironmentImage>(image);
    const auto found =
        exact_radiance(scene.receivers, some, scene.rays, cubemap::EnvironmentFile{.image = shared},
                       {.bias = scene.options.bias});
    for (std::size_t i = 0; i < some.size(); ++i) {
        const glm::vec3& normal = scene.receivers.normals[some[i]];
        const glm::vec3 origin =
            prt::ray_origin(scene.receivers.positions[some[i]], normal, scene.options.bias);
        glm::dvec3 expected(0.0);
        cubemap::for_each_pixel(
            cubemap::shape_of(image), [&](std::size_t pixel, const cubemap::PixelPlace& place) {
                const double cosine = glm::dot(glm::dvec3(normal), place.direction);
                if (cosine > 0.0 && !scene.rays.occluded(origin, glm::vec3(place.direction)))
                    expected += glm::dvec3(image.pixels[pixel]) *
                                (cosine * place.solid_angle / std::numbers::pi);
            });
        EXPECT_LT(glm::length(found[i] - expected), 5e-4 * glm::length(expected)) << some[i];
    }
}

TEST(Exact, WhiteFurnaceOfAFloor) {
    const prt::Receivers receivers{.positions = {glm::vec3(0.0f)}, .normals = {{0, 1, 0}}};
    const std::vector<std::uint32_t> one = {0};
    const auto b = exact_radiance(receivers, one, scenes::no_blockers(),
                                  cubemap::CubeMap(128, glm::vec3(1.0f)));
    EXPECT_NEAR(b[0].r, 1.0, 4.0 / 128 / 128); // midpoint rule: h^2 with h = 2 / R
}

TEST(Exact, BlackTexelsCastNoRay) {
    const scenes::AnalyticBlockers never([](const glm::dvec3&, const glm::dvec3&) {
        ADD_FAILURE() << "a ray into the dark";
        return false;
    });
    const prt::Receivers receivers{.positions = {glm::vec3(0.0f)}, .normals = {{0, 1, 0}}};
    cubemap::CubeMap environment(8);
    environment.at(cubemap::Face::NegativeY, 3, 3) = glm::vec3(9.0f); // below the horizon
    const std::vector<std::uint32_t> one = {0};
    EXPECT_EQ(exact_radiance(receivers, one, never, environment)[0], glm::dvec3(0.0));
}

TEST(Exact, ToleranceZeroReproducesTheFullProduct) {
    for (const std::uint32_t r : {8u, 16u}) {
        const scenes::RelitScene scene(0.0f, r);
        const cubemap::CubeMap environment = scenes::random_environment(r, r, 1000.0f);
        const auto exact = exact_radiance(scene.receivers, all_of(scene.receivers.size()),
                                          scene.rays, environment, {.bias = scene.options.bias});
        const std::vector<glm::vec3> expected(exact.begin(), exact.end());
        scenes::expect_close(relight(scene.transfer, environment), expected, 4e-6);
    }
}

TEST(Exact, ATighterToleranceDoesNotRaiseTheVerifiedError) {
    const cubemap::CubeMap environment = scenes::random_environment(64, 1, 20.0f);
    std::vector<double> errors;
    std::vector<glm::dvec3> exact;
    for (const float tolerance : {0.1f, 0.05f, 0.02f, 0.0135f, 0.005f, 0.0f}) {
        const scenes::RelitScene scene(tolerance, 64);
        const auto all = all_of(scene.receivers.size());
        if (exact.empty())
            exact = exact_radiance(scene.receivers, all, scene.rays, environment,
                                   {.bias = scene.options.bias});
        const double error = compare(all, exact, relight(scene.transfer, environment)).relative_l2;
        if (!errors.empty()) {
            EXPECT_LE(error, 1.05 * errors.back() + 1e-6)
                << "tolerance " << tolerance; // by chance, not materially
        }
        errors.push_back(error);
    }
    EXPECT_LT(errors[3], 0.01) << "the default tolerance";
    EXPECT_LT(errors.back(), 1e-5);
}

TEST(Exact, AnyNumberOfThreadsGivesTheSameBitsAndProgressEndsAtOne) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::vector<std::vector<glm::dvec3>> results;
    for (const std::size_t num_threads : {1u, 2u}) {
        const files::ThreadLimit threads(num_threads);
        std::vector<double> fractions;
        const prt::Work work{.on_progress = [&](double fraction) {
            fractions.push_back(fraction);
        }};
        results.push_back(exact_radiance(scene.receivers, all_of(scene.receivers.size()),
                                         scene.rays, scenes::random_environment(8, 2),
                                         {.bias = scene.options.bias}, work));
        EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
        ASSERT_FALSE(fractions.empty());
        EXPECT_EQ(fractions.back(), 1.0);
    }
    EXPECT_EQ(results[0], results[1]);
}

TEST(Exact, Stops) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::stop_source stop;
    int num_calls = 0;
    const prt::Work work{.stop = stop.get_token(), .on_progress = [&](double) {
                             ++num_calls;
                             stop.request_stop();
                         }};
    EXPECT_THROW(
        static_cast<void>(exact_radiance(scene.receivers, all_of(scene.receivers.size()),
                                         scene.rays, scenes::random_environment(64, 3), {}, work)),
        prt::Cancelled);
    EXPECT_LE(num_calls, 64) << "at most one row for each thread";
}

TEST(Exact, RefusesIndicesAndSizesThatDoNotFit) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    const cubemap::CubeMap white(4, glm::vec3(1.0f));
    const auto run = [&](const prt::Receivers& receivers, std::vector<std::uint32_t> some,
                         const cubemap::CubeMap& environment) {
        return exact_radiance(receivers, some, scene.rays, environment);
    };
    const auto n = static_cast<std::uint32_t>(scene.receivers.size());
    EXPECT_EQ(run(scene.receivers, {n - 1}, white).size(), 1u);
    EXPECT_THROW(run(scene.receivers, {n}, white), std::invalid_argument);
    EXPECT_THROW(run({}, {0}, white), std::invalid_argument);
    EXPECT_THROW(run(scene.receivers, {0}, {}), std::invalid_argument);
    cubemap::CubeMap torn = white;
    torn.texels.pop_back();
    EXPECT_THROW(run(scene.receivers, {0}, torn), std::invalid_argument);
    prt::Receivers without_normals = scene.receivers;
    without_normals.normals.pop_back();
    EXPECT_THROW(run(without_normals, {0}, white), std::invalid_argument);

    const std::vector<glm::vec3> relit(3);
    const std::vector<glm::dvec3> exact(2);
    EXPECT_THROW(static_cast<void>(compare(std::vector<std::uint32_t>{0, 3}, exact, relit)),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(compare(std::vector<std::uint32_t>{0}, exact, relit)),
                 std::invalid_argument);
}

TEST(Exact, RandomReceiversDoNotRepeat) {
    const prt::Transfer& transfer = scenes::relit_scene().transfer;
    const std::size_t n = transfer.num_receivers();
    for (const std::size_t count : {std::size_t{1}, std::size_t{50}, n - 1, n}) {
        const auto receivers = random_receivers(transfer, count, 7);
        ASSERT_EQ(receivers.size(), count);
        EXPECT_EQ(std::set<std::uint32_t>(receivers.begin(), receivers.end()).size(), count);
        EXPECT_LT(*std::max_element(receivers.begin(), receivers.end()), n);
        EXPECT_EQ(random_receivers(transfer, count, 7), receivers);
    }
    EXPECT_NE(random_receivers(transfer, 50, 7), random_receivers(transfer, 50, 8));
    for (const std::size_t all : {std::size_t{0}, n + 1}) {
        EXPECT_EQ(random_receivers(transfer, all, 7).size(), n);
        // Neighbours together: the transfer's own order.
        EXPECT_EQ(random_receivers(transfer, all, 7), transfer.order);
    }
}

TEST(Exact, RandomReceiversAreEvenlySpread) {
    const prt::Transfer& transfer = scenes::relit_scene().transfer;
    std::vector<int> times(transfer.num_receivers(), 0);
    constexpr int Rounds = 4000;
    for (std::uint64_t seed = 0; seed < Rounds; ++seed)
        for (const std::uint32_t receiver : random_receivers(transfer, 10, seed))
            ++times[receiver];
    const double mean = 10.0 * Rounds / static_cast<double>(times.size());
    // Binomial: six standard deviations, one in 10^9 for each of some 300 receivers.
    for (const int t : times)
        EXPECT_NEAR(t, mean, 6.0 * std::sqrt(mean));
}

TEST(Exact, CompareOnValuesWorkedByHand) {
    const std::vector<std::uint32_t> receivers = {2, 0};
    const std::vector<glm::dvec3> exact = {{1.0, 2.0, 3.0}, {0.0, 4.0, 2.0}};
    const std::vector<glm::vec3> relit = {
        {0.0f, 4.0f, 5.0f}, {99.0f, 99.0f, 99.0f}, {1.0f, 2.0f, 4.0f}};
    const ErrorReport report = compare(receivers, exact, relit);
    EXPECT_DOUBLE_EQ(report.relative_l2, std::sqrt((1.0 + 9.0) / (14.0 + 20.0)));
    EXPECT_DOUBLE_EQ(report.mean_radiance, 2.0);
    EXPECT_DOUBLE_EQ(report.mean_abs, (1.0 + 3.0) / 6.0 / 2.0);
    EXPECT_DOUBLE_EQ(report.max_abs, 3.0 / 2.0);
    EXPECT_EQ(report.worst_receiver, 0u);
}

TEST(Exact, CompareOfWhatIsEqualOrBlack) {
    const std::vector<std::uint32_t> receivers = {0};
    const std::vector<glm::dvec3> two = {glm::dvec3(2.0)};
    const std::vector<glm::dvec3> black = {glm::dvec3(0.0)};
    const ErrorReport equal = compare(receivers, two, std::vector<glm::vec3>{glm::vec3(2.0f)});
    EXPECT_EQ(equal.relative_l2, 0.0);
    EXPECT_EQ(equal.mean_abs, 0.0);
    EXPECT_EQ(equal.max_abs, 0.0);
    EXPECT_EQ(equal.mean_radiance, 2.0);
    const ErrorReport both_black =
        compare(receivers, black, std::vector<glm::vec3>{glm::vec3(0.0f)});
    EXPECT_EQ(both_black.relative_l2, 0.0);
    EXPECT_EQ(both_black.mean_radiance, 0.0);
    EXPECT_EQ(compare({}, {}, {}).relative_l2, 0.0);
    EXPECT_TRUE(
        std::isinf(compare(receivers, black, std::vector<glm::vec3>{glm::vec3(1.0f)}).relative_l2));
}

} // namespace
} // namespace relumine::relight
