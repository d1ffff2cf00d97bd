// `relumine fit`: light that is found again, and what cannot be fitted.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class Fit : public AppTest {
protected:
    Fit() {
        write("lamps.json", R"({"version": 1, "lights": [
            {"direction": [0.48, 0.64, 0.6], "irradiance": [3.0, 2.4, 1.5]},
            {"direction": [-0.8, 0.36, 0.48], "irradiance": [0.4, 0.8, 1.6]}]})");
        succeed({"generate", "colonnade", "--vertices", "4000", "-o", ".", "-q"});
        succeed({"precompute", "colonnade.ply", "-o", "c.prt", "--tolerance", "0.06", "--no-refine",
                 "--bounces", "0", "-q"});
        succeed({"relight", "c.prt", "--lights", "lamps.json", "-o", "lit.npy", "-q"});
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
    succeed({"fit", "c.prt", "lit.npy", "--lights", "2", "-o", "found.json", "-q"});
    expect_lamps("found.json", 2.0, 0.02);
    succeed({"relight", "c.prt", "--lights", "lamps.json", "-o", "lit.exr", "--camera", "24,20",
             "--albedo", "0.5", "--size", "256x192", "-q"});
    succeed({"fit", "c.prt", "lit.exr", "--lights", "2", "--camera", "24,20", "--albedo", "0.5",
             "-o", "seen.json", "-q"});
    expect_lamps("seen.json", 5.0, 0.05);
}

TEST_F(Fit, FindsGainsAndAnEnvironment) {
    succeed({"fit", "c.prt", "lit.npy", "--gains", "lamps.json", "-o", "gains.json", "-q"});
    expect_lamps("gains.json", 0.01, 1e-4);
    // A smooth environment of its own kind comes back nearly whole.
    write("white.hdr", white_hdr());
    succeed({"relight", "c.prt", "white.hdr", "--clusters-only", "-o", "white.npy", "-q"});
    const auto report =
        succeed({"fit", "c.prt", "white.npy", "-o", "env.exr", "--face-resolution", "4", "--json"})
            .json();
    EXPECT_LT(report["relative_l2"], 0.01);
}

TEST_F(Fit, RefusesWhatCannotBeFitted) {
    write("empty.npy", "no numbers");
    fail({"fit", "c.prt", "empty.npy", "-o", "env.exr"}, {"empty.npy"});
    succeed(
        {"relight", "c.prt", "--lights", "lamps.json", "-o", "lit.exr", "--size", "64x48", "-q"});
    misuse({"fit", "c.prt", "lit.exr", "-o", "env.exr"}, "the camera of the picture");
    write("mesh.obj", octahedron_obj());
    fail({"fit", "c.prt", "mesh.obj", "-o", "env.exr"}, {"mesh.obj", "vertex colours"});
    misuse({"fit", "c.prt", "lit.npy", "--gains", "lamps.json", "--lights", "2", "-o", "x.json"},
           "--gains");
    misuse({"fit", "c.prt", "lit.npy", "--lights", "2", "-o", "x.exr"}, ".json");
}

} // namespace
} // namespace relumine::app
