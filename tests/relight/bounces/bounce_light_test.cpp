#include "relight/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/parallel.h"

namespace relumine::relight {
namespace {

/// A transfer of n receivers whose places are in reversed order; only the order counts here.
prt::Transfer transfer_of(std::size_t n) {
    prt::Transfer transfer;
    transfer.order.resize(n);
    std::iota(transfer.order.rbegin(), transfer.order.rend(), 0u);
    return transfer;
}

/// Random emitters from place `first` on; each receiver keeps `closure` of the light, and some
/// share their samples.
prt::BounceMatrix random_matrix(std::size_t n, double closure, std::size_t first = 0) {
    std::mt19937 random(7);
    prt::BounceMatrix matrix;
    const auto random_places = [&](std::size_t size, std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> places(size);
        for (std::uint32_t& place : places)
            place = static_cast<std::uint32_t>(begin + random() % (end - begin));
        return places;
    };
    for (std::size_t row = 0; row < n; ++row) {
        std::vector<std::uint32_t> emitters = random_places(1 + random() % 40, first, n);
        std::sort(emitters.begin(), emitters.end());
        matrix.emitters.append(emitters);
        std::vector<std::uint32_t> averaged = row < first ? random_places(random() % 5, 0, first)
                                                          : random_places(random() % 5, first, n);
        averaged.push_back(static_cast<std::uint32_t>(row));
        std::sort(averaged.begin(), averaged.end());
        matrix.averaged.append(averaged);
    }
    for (std::size_t row = 0; row < n; ++row) {
        std::size_t num_emitters = 0;
        for (const std::uint32_t other : matrix.averaged[row])
            num_emitters += matrix.emitters[other].size();
        matrix.weights.push_back(static_cast<float>(closure / static_cast<double>(num_emitters)));
    }
    matrix.spectral_radius = prt::spectral_radius(matrix);
    return matrix;
}

std::vector<glm::vec3> random_colors(std::size_t n, float largest) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(0.0f, largest);
    std::vector<glm::vec3> colors(n);
    for (glm::vec3& color : colors)
        color = {value(random), value(random), value(random)};
    return colors;
}

/// The plain version: b bounces in double, by receiver.
std::vector<glm::dvec3> plain_bounces(const prt::BounceMatrix& matrix,
                                      const prt::Transfer& transfer,
                                      const std::vector<glm::vec3>& albedo,
                                      const std::vector<glm::vec3>& direct, int num_bounces) {
    const std::size_t n = matrix.num_rows();
    std::vector<glm::dvec3> indirect(n, glm::dvec3(0.0));
    for (int bounce = 0; bounce < num_bounces; ++bounce) {
        std::vector<glm::dvec3> next(n, glm::dvec3(0.0));
        for (std::size_t place = 0; place < n; ++place) {
            glm::dvec3 sum(0.0);
            for (const std::uint32_t other : matrix.averaged[place])
                for (const std::uint32_t emitter_place : matrix.emitters[other]) {
                    const std::uint32_t emitter = transfer.order[emitter_place];
                    sum += glm::dvec3(albedo[emitter]) *
                           (glm::dvec3(direct[emitter]) + indirect[emitter]);
                }
            next[transfer.order[place]] = static_cast<double>(matrix.weights[place]) * sum;
        }
        indirect = next;
    }
    return indirect;
}

double relative_difference(std::span<const glm::vec3> a, const std::vector<glm::dvec3>& b) {
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(a[i]) - b[i];
        difference += glm::dot(d, d);
        all += glm::dot(b[i], b[i]);
    }
    return std::sqrt(difference / all);
}

constexpr std::size_t Size = 1500;

TEST(BounceLight, GivesSoManyBouncesAsAreAsked) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.9);
    const auto albedo = random_colors(Size, 1.0f), direct = random_colors(Size, 5.0f);
    BounceLight light(matrix, transfer);
    light.set_albedo(albedo);
    for (const int num_bounces : {1, 2, 5}) {
        const BounceReport report =
            light.solve(direct, {.num_bounces = static_cast<std::uint32_t>(num_bounces)});
        EXPECT_EQ(report.num_bounces, num_bounces);
        EXPECT_LT(relative_difference(light.indirect(),
                                      plain_bounces(matrix, transfer, albedo, direct, num_bounces)),
                  1e-5);
    }
}

TEST(BounceLight, ConvergesToTheSumOfAllBouncesWithinTheTolerance) {
    const prt::Transfer transfer = transfer_of(Size);
    for (const double closure : {0.3, 0.9, 0.99}) {
        const prt::BounceMatrix matrix = random_matrix(Size, closure);
        const auto albedo = random_colors(Size, 1.0f), direct = random_colors(Size, 5.0f);
        BounceLight light(matrix, transfer);
        light.set_albedo(albedo);
        for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
            const BounceReport report = light.solve(direct, {.tolerance = tolerance});
            EXPECT_LE(report.error, tolerance);
            EXPECT_LT(relative_difference(light.indirect(),
                                          plain_bounces(matrix, transfer, albedo, direct, 400)),
                      3.0 * tolerance)
                << "closure " << closure;
        }
    }
}

TEST(BounceLight, FewerProductsThanBouncesWhereLightStaysLong) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.95);
    BounceLight light(matrix, transfer);
    light.set_albedo(std::vector(Size, glm::vec3(0.95f)));
    const auto direct = random_colors(Size, 1.0f);
    // 0.9^n < 1e-3 takes n = 66 bounces, and < 1e-5 takes 109.
    EXPECT_LE(light.solve(direct).num_bounces, 3u);
    EXPECT_LE(light.solve(direct, {.tolerance = 1e-5}).num_bounces, 5u);
}

// White boxes whose walls see each other, and the room but for a crack. The places of a box and of
// the room alternate, as on both sides of a thin wall.
TEST(BounceLight, BoxesOfAWhiteRoomNeedFewProducts) {
    constexpr std::size_t NumBoxes = 12, NumSamples = 200;
    const prt::Transfer transfer = transfer_of(Size);
    prt::BounceMatrix matrix;
    std::mt19937 random(3);
    std::vector<std::vector<std::uint32_t>> boxes(1 + NumBoxes);
    const auto box_of = [](std::size_t place) {
        return place % 2 == 0 ? std::size_t{0} : 1 + place * NumBoxes / Size;
    };
    for (std::uint32_t place = 0; place < Size; ++place)
        boxes[box_of(place)].push_back(place);
    for (std::uint32_t place = 0; place < Size; ++place) {
        std::vector<std::uint32_t> emitters;
        for (std::size_t i = 0; i < NumSamples; ++i) {
            const std::vector<std::uint32_t>& box =
                boxes[random() % 50 == 0 ? random() % boxes.size() : box_of(place)];
            emitters.push_back(box[random() % box.size()]);
        }
        std::sort(emitters.begin(), emitters.end());
        matrix.emitters.append(emitters);
        matrix.averaged.append(std::array{place});
        matrix.weights.push_back(0.995f / NumSamples);
    }
    matrix.spectral_radius = prt::spectral_radius(matrix);
    const std::vector albedo(Size, glm::vec3(1.0f));
    std::vector<glm::vec3> direct(Size, glm::vec3(0.0f));
    for (std::uint32_t place = 0; place < Size; place += 2)
        direct[transfer.order[place]] = glm::vec3(1.0f + 0.5f * std::sin(0.01f * float(place)));
    BounceLight light(matrix, transfer);
    light.set_albedo(albedo);
    EXPECT_LE(light.solve(direct).num_bounces, 8u);
    EXPECT_LT(relative_difference(light.indirect(),
                                  plain_bounces(matrix, transfer, albedo, direct, 4000)),
              2e-3);
}

// X = 1 + 0.5 X has the solution 2: a closed room of albedo 0.5 whose walls send on 1 by
// themselves.
TEST(BounceLight, AClosedRoomGlowsTwiceAsBright) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 1.0);
    BounceLight light(matrix, transfer);
    light.set_albedo(std::vector(Size, glm::vec3(0.5f)));
    const std::vector direct(Size, glm::vec3(2.0f));
    light.solve(direct);
    for (std::size_t i = 0; i < Size; ++i)
        EXPECT_NEAR(0.5f * (direct[i].g + light.indirect()[i].g), 2.0f, 1e-3f);
}

// Pixels and texels stand before the vertices that light bounces between.
TEST(BounceLight, ReceiversThatSendNothingGetTheSameLight) {
    constexpr std::size_t First = 700;
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.9, First);
    EXPECT_EQ(prt::first_emitter(matrix), First);
    EXPECT_EQ(prt::first_emitter(random_matrix(Size, 0.9)), 0u);
    EXPECT_NEAR(matrix.spectral_radius, 0.9f, 1e-3f);
    auto albedo = random_colors(Size, 1.0f);
    // Nothing grows of what is not sent.
    albedo[transfer.order[0]] = glm::vec3(5.0f);
    const auto direct = random_colors(Size, 5.0f);
    BounceLight light(matrix, transfer);
    light.set_albedo(albedo);
    for (const int num_bounces : {0, 1, 2, 5}) {
        light.solve(direct, {.num_bounces = static_cast<std::uint32_t>(num_bounces)});
        const auto plain = plain_bounces(matrix, transfer, albedo, direct, num_bounces);
        for (std::size_t i = 0; i < Size; ++i)
            ASSERT_NEAR(light.indirect()[i].g, plain[i].g, 1e-4 * plain[i].g) << num_bounces;
    }
    light.solve(direct, {.tolerance = 1e-5});
    const auto plain = plain_bounces(matrix, transfer, albedo, direct, 400);
    EXPECT_LT(relative_difference(light.indirect(), plain), 3e-5);
    EXPECT_NEAR(light.indirect()[transfer.order[3]].g, plain[transfer.order[3]].g,
                1e-4 * plain[transfer.order[3]].g);
    for (int i = 0; i < 30; ++i)
        light.step(direct);
    EXPECT_LT(relative_difference(light.indirect(), plain), 1e-4);
}

TEST(BounceLight, BlackSurfacesBounceNothing) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.9);
    BounceLight light(matrix, transfer);
    light.solve(random_colors(Size, 1.0f));
    EXPECT_THAT(light.indirect(), testing::Each(glm::vec3(0.0f)));
    light.set_albedo(std::vector(Size, glm::vec3(0.5f)));
    light.solve(random_colors(Size, 1.0f));
    EXPECT_GT(light.indirect()[0].r, 0.0f);
    light.set_albedo(std::vector(Size, glm::vec3(0.0f)));
    light.solve(random_colors(Size, 1.0f));
    EXPECT_THAT(light.indirect(), testing::Each(glm::vec3(0.0f)));
}

TEST(BounceLight, StepsApproachTheSolution) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.5);
    const auto albedo = random_colors(Size, 1.0f);
    BounceLight light(matrix, transfer);
    light.set_albedo(albedo);
    light.solve(random_colors(Size, 1.0f));
    const auto direct = random_colors(Size, 5.0f);
    double error = 1.0;
    for (int i = 0; i < 20; ++i)
        error = light.step(direct).error;
    EXPECT_LT(error, 1e-5);
    EXPECT_LT(
        relative_difference(light.indirect(), plain_bounces(matrix, transfer, albedo, direct, 60)),
        1e-4);
}

TEST(BounceLight, EqualLightGivesEqualBitsWhateverCameBeforeOnAnyNumberOfThreads) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.9);
    const auto albedo = random_colors(Size, 1.0f), direct = random_colors(Size, 5.0f);
    std::vector<std::vector<glm::vec3>> results;
    for (const std::size_t num_threads : {1u, 2u, 5u}) {
        const files::ThreadLimit limit(num_threads);
        BounceLight light(matrix, transfer);
        light.set_albedo(albedo);
        if (num_threads == 2)
            light.solve(random_colors(Size, 0.1f));
        light.solve(direct);
        results.emplace_back(light.indirect().begin(), light.indirect().end());
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

TEST(BounceLight, RefusesAlbedoUnderWhichLightGrowsForEver) {
    const prt::Transfer transfer = transfer_of(Size);
    const prt::BounceMatrix matrix = random_matrix(Size, 0.8);
    BounceLight light(matrix, transfer);
    light.set_albedo(std::vector(Size, glm::vec3(1.2f)));
    try {
        light.set_albedo(std::vector(Size, glm::vec3(1.3f)));
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("expected an albedo up to 1.249"));
    }
    EXPECT_THROW(light.set_albedo(std::vector(Size - 1, glm::vec3(0.5f))), std::invalid_argument);
    std::vector wrong(Size, glm::vec3(0.5f));
    for (const float value :
         {-0.1f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        wrong[17].g = value;
        EXPECT_THROW(light.set_albedo(wrong), std::invalid_argument) << value;
    }
    EXPECT_THROW(light.solve(std::vector(Size + 1, glm::vec3(0.5f))), std::invalid_argument);
    EXPECT_THROW(BounceLight(matrix, transfer_of(Size + 1)), std::invalid_argument);
}

TEST(BounceMatrix, SpectralRadiusOfRowsThatKeepAThird) {
    EXPECT_NEAR(random_matrix(500, 1.0 / 3.0).spectral_radius, 1.0 / 3.0, 1e-4);
    EXPECT_EQ(
        prt::spectral_radius(
            {.weights = {0.0f}, .emitters = {.begin = {0, 0}}, .averaged = {.begin = {0, 0}}}),
        0.0f);
}

TEST(BounceMatrix, RefusesArraysThatContradictEachOther) {
    const prt::BounceMatrix good = random_matrix(100, 0.9);
    prt::require_bounces(good, 100);
    EXPECT_THROW(prt::require_bounces(good, 99), std::invalid_argument);
    const auto refuses = [&](const auto& damage) {
        prt::BounceMatrix matrix = good;
        damage(matrix);
        EXPECT_THROW(prt::require_bounces(matrix, 100), std::invalid_argument);
    };
    for (const auto lists : {&prt::BounceMatrix::emitters, &prt::BounceMatrix::averaged}) {
        refuses([&](auto& matrix) { (matrix.*lists).places[5] = 100; });
        refuses([&](auto& matrix) { (matrix.*lists).begin[5] = (matrix.*lists).begin[6] + 1; });
        refuses([&](auto& matrix) { (matrix.*lists).begin.back() += 1; });
        refuses([&](auto& matrix) { (matrix.*lists).begin.pop_back(); });
    }
    refuses([](auto& matrix) { matrix.weights[5] = -0.1f; });
    refuses([](auto& matrix) { matrix.weights[5] = 2.0f; });
    refuses([](auto& matrix) { matrix.weights[5] = std::nanf(""); });
    refuses([](auto& matrix) { matrix.spectral_radius = 1.5f; });
}

} // namespace
} // namespace relumine::relight
