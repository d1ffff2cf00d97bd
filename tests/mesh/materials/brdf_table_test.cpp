#include "mesh/materials/brdf_table.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/mesh/mesh_files.h"

namespace relumine::mesh {
namespace {

constexpr float Pi = std::numbers::pi_v<float>;

using Function = std::function<glm::vec3(const BrdfDirections&)>;

glm::vec3 grey(const BrdfDirections&) {
    return glm::vec3(0.5f, 0.25f, 0.75f) / Pi;
}

/// GGX of F0 1, one scattering.
float ggx(const BrdfDirections& at, float roughness) {
    const float n_w = at.to_light.z, n_v = at.to_eye.z, a2 = std::pow(roughness, 4.0f);
    const glm::vec3 h = glm::normalize(at.to_light + at.to_eye);
    const float d = h.x * h.x + h.y * h.y + h.z * h.z * a2;
    const auto mask = [a2](float c) {
        return std::sqrt(c * c * (1.0f - a2) + a2);
    };
    return a2 / (Pi * d * d) * 0.5f / (n_w * mask(n_v) + n_v * mask(n_w));
}

/// A table as a MERL file has it.
std::vector<double> file_values(const Function& function) {
    constexpr std::size_t N = 90, M = 180;
    constexpr double Scales[3] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
    std::vector<double> values(3 * N * N * M);
    for (std::size_t h = 0; h < N; ++h)
        for (std::size_t d = 0; d < N; ++d)
            for (std::size_t p = 0; p < M; ++p) {
                const double root = (static_cast<double>(h) + 0.5) / N;
                const double theta_h = root * root * Pi / 2;
                const double theta_d = (static_cast<double>(d) + 0.5) / N * Pi / 2;
                const double phi_d = (static_cast<double>(p) + 0.5) / M * Pi;
                const glm::vec3 half(std::sin(theta_h), 0.0, std::cos(theta_h));
                const glm::vec3 x(half.z, 0.0f, -half.x), y(0.0f, 1.0f, 0.0f);
                const glm::vec3 light = static_cast<float>(std::sin(theta_d)) *
                                            (static_cast<float>(std::cos(phi_d)) * x +
                                             static_cast<float>(std::sin(phi_d)) * y) +
                                        static_cast<float>(std::cos(theta_d)) * half;
                const glm::vec3 eye = 2.0f * glm::dot(light, half) * half - light;
                // Below the horizon files have numbers that mean nothing.
                const glm::vec3 value =
                    light.z > 0.0f && eye.z > 0.0f ? function({light, eye}) : glm::vec3(-1.0f);
                for (std::size_t c = 0; c < 3; ++c)
                    values[((c * N + h) * N + d) * M + p] =
                        double{value[static_cast<int>(c)]} / Scales[c];
            }
    return values;
}

std::string file_of(const std::vector<double>& values,
                    std::array<std::int32_t, 3> sides = {90, 90, 180}) {
    std::string bytes(sizeof sides + values.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), sides.data(), sizeof sides);
    std::memcpy(bytes.data() + sizeof sides, values.data(), values.size() * sizeof(double));
    return bytes;
}

TEST(BrdfTable, OfLambertIsALambertianPartAlone) {
    const auto table = brdf_of(Function(grey));
    EXPECT_NEAR(glm::distance(table->lambert(), glm::vec3(0.5f, 0.25f, 0.75f)), 0.0f, 1e-6f);
    EXPECT_EQ(table->roughness(), 1.0f);
    for (const float n_v : {0.1f, 0.5f, 1.0f})
        EXPECT_LT(glm::length(table->rest_albedo(n_v)), 1e-5f);
}

TEST(BrdfTable, IsTheFunctionBetweenItsPlaces) {
    constexpr float Roughness = 0.4f;
    const auto table = brdf_of([](const BrdfDirections& at) {
        return grey(at) * 0.5f + 0.5f * glm::vec3(ggx(at, Roughness), 0.0f, 0.0f);
    });
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto direction = [&] {
        const float z = 0.15f + 0.85f * unit(random), phi = 2.0f * Pi * unit(random);
        return glm::vec3(std::sqrt(1.0f - z * z) * std::cos(phi),
                         std::sqrt(1.0f - z * z) * std::sin(phi), z);
    };
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 w = direction(), v = direction(), h = glm::normalize(w + v);
        const glm::vec3 expected = glm::vec3(0.25f, 0.125f, 0.375f) / Pi +
                                   0.5f * glm::vec3(ggx({w, v}, Roughness), 0.0f, 0.0f);
        const glm::vec3 got = table->lambert() / Pi + table->rest(w.z, v.z, h.x * h.x + h.y * h.y);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(got[c], expected[c], 0.02f * expected[c]) << i;
    }
}

TEST(BrdfTable, KnowsItsWidthAndWhatItReflects) {
    for (const float roughness : {0.15f, 0.4f, 0.7f}) {
        const auto table = brdf_of(
            [roughness](const BrdfDirections& at) { return glm::vec3(ggx(at, roughness)); });
        EXPECT_NEAR(table->roughness(), roughness, 0.08f * roughness);
        // The table of prt/glossy/ggx_energy.h has these: 1 - E is what meets a second facet.
        const float lambert = table->lambert().r;
        EXPECT_NEAR(table->rest_albedo(1.0f).g + lambert,
                    roughness < 0.2f   ? 0.9995f
                    : roughness < 0.5f ? 0.968f
                                       : 0.710f,
                    0.02f)
            << roughness;
    }
}

TEST(BrdfTable, RefusesWhatNoSurfaceDoes) {
    const auto refuse = [](const Function& function, const std::string& part) {
        try {
            static_cast<void>(brdf_of(function));
            ADD_FAILURE() << "accepted; expected a refusal with " << part;
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(part));
            EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
        }
    };
    refuse([](const auto&) { return glm::vec3(0.1f, 2.0f / Pi, 0.1f); },
           "reflects at most what arrives, got 2.00 of green");
    refuse([](const auto& at) { return glm::vec3(0.3f * at.to_light.z); }, "reciprocal");
    refuse([](const auto& at) { return glm::vec3(0.1f * (1.0f + at.to_light.x * at.to_eye.x)); },
           "isotropic");
    refuse(
        [](const auto& at) {
            return glm::vec3(0.1f * (1.0f + 0.1f * glm::cross(at.to_light, at.to_eye).z *
                                                (at.to_light.z - at.to_eye.z)));
        },
        "mirror image");
    refuse([](const auto&) { return glm::vec3(0.1f, 0.1f, -0.1f); },
           "finite values of 0 or more, got -0.1 of blue");
    refuse([](const auto&) { return glm::vec3(NAN); }, "finite values of 0 or more, got nan");
    EXPECT_THROW(BrdfTable(std::vector<float>(5)), std::invalid_argument);
}

using BrdfFile = MeshFileTest;

TEST_F(BrdfFile, IsTheFunctionThatWroteIt) {
    const Function function = [](const BrdfDirections& at) {
        return 0.5f * grey(at) + glm::vec3(0.2f * ggx(at, 0.5f));
    };
    const auto table = load_brdf(write("one.binary", file_of(file_values(function))));
    const auto expected = brdf_of(function);
    EXPECT_NEAR(glm::distance(table->lambert(), expected->lambert()), 0.0f, 1e-4f);
    for (std::size_t i = 0; i < expected->rests().size(); i += 977)
        EXPECT_NEAR(table->rests()[i], expected->rests()[i], 1e-3f) << i;
}

TEST_F(BrdfFile, RefusesBadFiles) {
    const auto refuse = [&](const std::string& content, const std::string& message) {
        const std::filesystem::path path = write("bad.binary", content);
        expect_refusal([&] { return load_brdf(path); }, path.string() + ": " + message);
    };
    std::vector<double> values = file_values(grey);
    refuse(file_of(values, {90, 90, 360}),
           "expected 90 x 90 x 180 values for each colour, got 90 x 90 x 360");
    refuse(file_of({values.begin(), values.end() - 1}), "expected 34992012 bytes, got 34992004");
    refuse("MERL", "expected a table of a BRDF, got 4 bytes");
    const std::filesystem::path huge = write("huge.binary", file_of(values));
    std::filesystem::resize_file(huge, std::uintmax_t{1} << 34); // its values are not read
    expect_refusal([&] { return load_brdf(huge); },
                   huge.string() + ": expected 34992012 bytes, got 17179869184");
    values[1000] = NAN;
    refuse(file_of(values), "expected a BRDF of finite values of 0 or more, got nan of red");
    values[1000] = -1e3;
    refuse(file_of(values), "expected a BRDF of finite values of 0 or more, got -");
    EXPECT_THROW(static_cast<void>(load_brdf(folder_ / "none.binary")), std::runtime_error);
}

} // namespace
} // namespace relumine::mesh
