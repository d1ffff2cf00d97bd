// `relumine fit`: light that is found again, and what cannot be fitted.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/resample/save_environment.h"
#include "relight/pictures/array_file.h"
#include "relumine/ask/fit.h"
#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Fit : public AppTest {
protected:
    Fit() {
        write("lamps.json", R"({"version": 1, "lights": [
            {"direction": [0.48, 0.64, 0.6], "irradiance": [3.0, 2.4, 1.5]},
            {"direction": [-0.8, 0.36, 0.48], "irradiance": [0.4, 0.8, 1.6]}]})");
        succeed("generate colonnade --vertices 4000 -o . -q");
        succeed("precompute colonnade.ply -o c.prt --tolerance 0.06 --refine off --bounces 0 -q");
        succeed("relight c.prt --lights lamps.json -o lit.npy -q");
    }

    /// Both lamps are there, each within so many degrees and with so much of its energy.
    void expect_lamps(const std::string& name, double degrees, double part) {
        const auto found = nlohmann::json::parse(read(name))["lights"];
        const auto wanted = nlohmann::json::parse(read("lamps.json"))["lights"];
        const auto vector_of = [](const nlohmann::json& v) {
            return glm::dvec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
        };
        ASSERT_EQ(found.size(), 2u);
        for (const nlohmann::json& lamp : wanted) {
            const glm::dvec3 direction = glm::normalize(vector_of(lamp["direction"]));
            double nearest = 180.0, energy = 0.0;
            for (const nlohmann::json& light : found) {
                const double cosine =
                    glm::dot(glm::normalize(vector_of(light["direction"])), direction);
                const double angle = std::acos(std::min(1.0, cosine)) * 57.29578;
                if (angle < nearest) {
                    nearest = angle;
                    const glm::dvec3 e = vector_of(light["irradiance"]);
                    energy = e.r + e.g + e.b;
                }
            }
            const glm::dvec3 e = vector_of(lamp["irradiance"]);
            EXPECT_LT(nearest, degrees) << name;
            EXPECT_NEAR(energy, e.r + e.g + e.b, part * (e.r + e.g + e.b)) << name;
        }
    }
};

TEST_F(Fit, FindsTwoLampsAgainFromNumbersAndFromAPicture) {
    succeed("fit c.prt lit.npy --lights 2 -o found.json -q");
    expect_lamps("found.json", 2.0, 0.02);
    succeed("relight c.prt --lights lamps.json -o lit.exr --camera 24,20 --albedo 0.5 --size "
            "256x192 -q");
    succeed("fit c.prt lit.exr --lights 2 --camera 24,20 --albedo 0.5 -o seen.json -q");
    expect_lamps("seen.json", 5.0, 0.05);
}

TEST_F(Fit, AColourWithoutBlueTellsNothingOfBlueLight) {
    succeed("precompute colonnade.ply -o gold.prt --tolerance 0.06 --refine off --bounces 0 "
            "--material ggx:roughness=0.5,albedo=0.7,0.4,0,f0=0.04 -q");
    succeed("relight gold.prt --lights lamps.json -o gold.npy -q");
    // What is not the scene's own light: a hundredth of the mean.
    std::string bytes = read("gold.npy");
    const std::size_t first = bytes.find('\n') + 1;
    for (std::size_t at = first; at + 4 <= bytes.size(); at += 4) {
        float value = 0.0f;
        std::memcpy(&value, &bytes[at], 4);
        value += 0.01f;
        std::memcpy(&bytes[at], &value, 4);
    }
    write("gold.npy", bytes);
    succeed("fit gold.prt gold.npy --lights 2 -o found.json -q");
    for (const auto& light : nlohmann::json::parse(read("found.json"))["lights"])
        EXPECT_LT(light["irradiance"][2].get<double>(),
                  2.0 * light["irradiance"][0].get<double>() + 1.0);
}

TEST_F(Fit, FindsGainsAndAnEnvironment) {
    succeed("fit c.prt lit.npy --lights lamps.json -o gains.json -q");
    expect_lamps("gains.json", 0.01, 1e-4);
    // A smooth environment of its own kind comes back nearly whole.
    write("white.hdr", white_hdr());
    succeed("relight c.prt white.hdr --clusters-only -o white.npy -q");
    const auto report = succeed("fit c.prt white.npy -o env.exr --face-resolution 4 --json").json();
    EXPECT_LT(report["relative_l2"], 0.01);
}

/// An environment that was fitted, and how.
struct FittedEnvironment {
    double distance = 0.0;
    /// Mean over the sphere, and the mean squared difference of neighbours in rows over its square.
    double mean = 0.0, roughness = 0.0;
    /// The part of the sphere that has more than a hundredth of the brightest light.
    double lit_part = 0.0;
    double brightest = 0.0;
};

class FitEnvironment : public Fit {
protected:
    FittedEnvironment fit(double smooth, double sparse) {
        LitScene scene(load_scene(folder() / "c.prt"), {.clusters_only = true});
        const relight::VectorArray target = relight::load_npy(folder() / "lit.npy");
        const std::vector<glm::vec3> white(target.values.size(), glm::vec3(1.0f));
        const FitTarget wanted = target_of_values(scene.scene(), target.values, white);
        cubemap::save_environment(folder() / "env.exr", fit_environment(scene, wanted,
                                                                        {.face_resolution = 4,
                                                                         .smoothness = smooth,
                                                                         .sparsity = sparse,
                                                                         .max_iterations = 2000},
                                                                        {}));
        FittedEnvironment result{.distance = distance_to(wanted, scene)};
        const std::vector<float> green = exr_channels(folder() / "env.exr").at("G");
        const Size size = exr_size(read("env.exr"));
        result.brightest = *std::max_element(green.begin(), green.end());
        double sum = 0.0, lit = 0.0, squares = 0.0;
        for (std::size_t i = 0; i < green.size(); ++i) {
            const std::size_t row = i / size.width;
            const double part =
                std::sin(3.14159265 * (static_cast<double>(row) + 0.5) / size.height);
            const std::size_t next = row * size.width + (i + 1) % size.width;
            const double difference =
                static_cast<double>(green[i]) - static_cast<double>(green[next]);
            sum += part;
            result.mean += part * static_cast<double>(green[i]);
            squares += part * difference * difference;
            lit += static_cast<double>(green[i]) > 0.01 * result.brightest ? part : 0.0;
        }
        result.mean /= sum;
        result.lit_part = lit / sum;
        result.roughness = squares / sum / (result.mean * result.mean);
        return result;
    }
};

/// The more it weighs, the more alike neighbours are, and the farther the light is from the target.
TEST_F(FitEnvironment, SmoothMakesNeighboursAlike) {
    const FittedEnvironment rough = fit(0, 0), some = fit(0.1, 0), much = fit(1000, 0);
    EXPECT_LT(some.roughness, 0.5 * rough.roughness);
    EXPECT_LT(much.roughness, 1e-3 * some.roughness);
    EXPECT_GT(some.distance, rough.distance);
    EXPECT_GT(much.distance, some.distance);
    // Nearly one radiance from everywhere, as bright as suits the target.
    EXPECT_NEAR(much.brightest, much.mean, 0.02 * much.mean);
}

/// The more it weighs, the less light there is, from fewer directions.
TEST_F(FitEnvironment, SparseLeavesLittleLight) {
    const FittedEnvironment full = fit(0, 0), some = fit(0, 0.3), few = fit(0, 1),
                            none = fit(0, 1e6);
    EXPECT_LT(some.mean, 0.7 * full.mean);
    EXPECT_LT(few.mean, 0.7 * some.mean);
    EXPECT_LT(some.lit_part, 0.8 * full.lit_part);
    EXPECT_LT(few.lit_part, 0.8 * some.lit_part);
    EXPECT_GT(few.lit_part, 0.0);
    EXPECT_GT(some.distance, full.distance);
    EXPECT_GT(few.distance, some.distance);
    // No texel lowers the distance by as much as it costs.
    EXPECT_EQ(none.brightest, 0.0);
    EXPECT_NEAR(none.distance, 1.0, 1e-6);
}

TEST_F(Fit, RefusesWhatCannotBeFitted) {
    write("empty.npy", "no numbers");
    fail("fit c.prt empty.npy -o env.exr", {"empty.npy"});
    succeed("relight c.prt --lights lamps.json -o lit.exr --size 64x48 -q");
    misuse("fit c.prt lit.exr -o env.exr", "the camera of the picture");
    write("mesh.obj", octahedron_obj());
    fail("fit c.prt mesh.obj -o env.exr", {"mesh.obj", "vertex colours"});
    for (const char* lights : {"0", "129", "-1", "1.5"})
        misuse({"fit", "c.prt", "lit.npy", "--lights", lights, "-o", "x.json"},
               "--lights: expected 1 to 128 lights, or a file of lights");
    fail("fit c.prt lit.npy --lights none.json -o x.json", {"none.json"});
    misuse("fit c.prt lit.npy --lights 2 -o x.exr", ".json");
}

} // namespace
} // namespace relumine::app
