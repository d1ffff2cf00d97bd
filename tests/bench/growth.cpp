// How cost grows with vertices, clusters and blockers: measured, and a power law fitted.
// See `./dev bench growth --help`.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "prt/precompute.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/relighter.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/program.h"
#include "tests/bench/times.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

struct Steps {
    /// Of about the square root of ten
    std::vector<std::size_t> vertices = {20'000, 63'000, 200'000, 630'000, 2'000'000};
    std::vector<std::size_t> triangles = {10'000, 50'000, 250'000, 1'000'000, 5'000'000};
    std::vector<std::size_t> mesh = {100'000, 500'000, 2'000'000};
    std::vector<float> tolerances = {0.1f, 0.056f, 0.032f, 0.018f, 0.01f};

    /// Where vertices or blockers grow
    float growth_tolerance = 0.05f;
    /// Where the mesh grows
    float mesh_tolerance = prt::PrecomputeOptions{}.tolerance;
    /// Where clusters grow; the floor of 142 x 142 of it are the receivers where blockers grow
    std::size_t blob_vertices = 50'000;
    std::uint32_t environment_resolution = 256;

    static Steps tiny() {
        return {.vertices = {1000, 2000},
                .triangles = {2000, 4000},
                .mesh = {1000, 2000},
                .tolerances = {0.2f, 0.1f},
                .growth_tolerance = 0.1f,
                .mesh_tolerance = 0.1f,
                .blob_vertices = 1000,
                .environment_resolution = 16};
    }
};

struct Cost {
    /// What grows
    double x = 0.0;
    std::size_t num_receivers = 0, num_triangles = 0, num_clusters = 0;
    /// Seconds to sort the blockers
    double build = 0.0;
    /// Processor seconds, all threads
    double precompute = 0.0;
    /// Seconds, the median of many
    double relight = 0.0;
    double peak_megabytes = 0.0;
};

Cost measure(const mesh::TriangleMesh& blockers, const prt::Receivers& receivers, float tolerance,
             std::uint32_t environment_resolution) {
    Cost cost{.num_receivers = receivers.size(), .num_triangles = blockers.triangles.size()};
    double before = bench::cpu_seconds();
    const prt::RayScene rays(blockers);
    const prt::BeamScene beams(blockers, rays);
    cost.build = bench::cpu_seconds() - before;
    before = bench::cpu_seconds();
    const prt::Transfer transfer = prt::precompute(
        receivers, beams, {.tolerance = tolerance, .bias = prt::automatic_bias(blockers)});
    cost.precompute = bench::cpu_seconds() - before;
    cost.num_clusters = transfer.num_clusters();
    relight::Relighter relighter(transfer);
    relighter.set_environment(data_gen::two_soft_boxes(environment_resolution));
    cost.relight = bench::median_seconds([&] { relighter.resum(); });
    cost.peak_megabytes = bench::peak_megabytes();
    return cost;
}

/// The exponent p of the power law y = a x^p that is nearest in logarithms.
double exponent(const std::vector<Cost>& costs, double Cost::* y) {
    double mean_x = 0.0, mean_y = 0.0;
    const auto n = static_cast<double>(costs.size());
    for (const Cost& cost : costs) {
        mean_x += std::log(cost.x) / n;
        mean_y += std::log(cost.*y) / n;
    }
    double xy = 0.0, xx = 0.0;
    for (const Cost& cost : costs) {
        const double dx = std::log(cost.x) - mean_x;
        xy += dx * (std::log(cost.*y) - mean_y);
        xx += dx * dx;
    }
    return xy / xx;
}

/// A table on stdout.
nlohmann::json report(const std::string& what, const std::vector<Cost>& costs) {
    fmt::print("Against {}: precompute grows with exponent {:.2f}, relighting with {:.2f}.\n\n",
               what, exponent(costs, &Cost::precompute), exponent(costs, &Cost::relight));
    fmt::print("| receivers | triangles | clusters | sorting the blockers | precompute, processor "
               "seconds | "
               "relight | peak so far |\n|---|---|---|---|---|---|---|\n");
    nlohmann::json rows = nlohmann::json::array();
    for (const Cost& cost : costs) {
        fmt::print("| {} | {} | {} | {:.2f} s | {:.2f} | {:.2f} ms | {:.0f} MB |\n",
                   cost.num_receivers, cost.num_triangles, cost.num_clusters, cost.build,
                   cost.precompute, 1e3 * cost.relight, cost.peak_megabytes);
        rows.push_back({{"receivers", cost.num_receivers},
                        {"triangles", cost.num_triangles},
                        {"clusters", cost.num_clusters},
                        {"build", cost.build},
                        {"precompute", cost.precompute},
                        {"relight", cost.relight}});
    }
    fmt::print("\n");
    std::fflush(stdout);
    return rows;
}

std::vector<Cost> against_vertices(const Steps& steps, std::size_t most) {
    std::vector<Cost> costs;
    for (const std::size_t num_vertices : steps.vertices) {
        if (num_vertices > most)
            break;
        const mesh::TriangleMesh mesh = data_gen::blob(num_vertices);
        costs.push_back(measure(mesh, prt::vertex_receivers(mesh), steps.growth_tolerance,
                                steps.environment_resolution));
        costs.back().x = static_cast<double>(mesh.num_vertices());
    }
    return costs;
}

/// The same knot in more and more vertices, as finely clustered as users ask for who ask for
/// nothing.
std::vector<Cost> against_mesh_size(const Steps& steps, std::size_t most) {
    std::vector<Cost> costs;
    for (const std::size_t num_vertices : steps.mesh) {
        if (num_vertices > most)
            break;
        const mesh::TriangleMesh mesh = data_gen::knot(num_vertices);
        costs.push_back(measure(mesh, prt::vertex_receivers(mesh), steps.mesh_tolerance,
                                steps.environment_resolution));
        costs.back().x = static_cast<double>(mesh.num_vertices());
    }
    return costs;
}

std::vector<Cost> against_clusters(const Steps& steps) {
    const mesh::TriangleMesh mesh = data_gen::blob(steps.blob_vertices);
    std::vector<Cost> costs;
    for (const float tolerance : steps.tolerances) {
        costs.push_back(
            measure(mesh, prt::vertex_receivers(mesh), tolerance, steps.environment_resolution));
        costs.back().x = static_cast<double>(costs.back().num_clusters);
    }
    return costs;
}

/// Vertices of the floor that the scenes stand on.
prt::Receivers floor_receivers(const mesh::TriangleMesh& mesh) {
    prt::Receivers floor;
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i)
        if (mesh.positions[i].y == 0.0f && mesh.normals[i] == glm::vec3(0.0f, 1.0f, 0.0f)) {
            floor.positions.push_back(mesh.positions[i]);
            floor.normals.push_back(mesh.normals[i]);
        }
    return floor;
}

/// The same points of the floor beside a boulder of more and more triangles.
std::vector<Cost> against_blockers(const Steps& steps, std::size_t most) {
    const prt::Receivers floor = floor_receivers(data_gen::blob(steps.blob_vertices));
    std::vector<Cost> costs;
    for (const std::size_t num_triangles : steps.triangles) {
        if (num_triangles > most)
            break;
        costs.push_back(measure(data_gen::blob(num_triangles / 2), floor, steps.growth_tolerance,
                                steps.environment_resolution));
        costs.back().x = static_cast<double>(costs.back().num_triangles);
    }
    return costs;
}

} // namespace

int main(int argc, char** argv) {
    fs::path folder = ".";
    std::size_t most_vertices = 2'000'000;
    std::size_t most_triangles = 5'000'000;
    std::vector<std::string> chosen = {"vertices", "mesh_size", "clusters", "triangles"};
    bench::Program program("bench_growth",
                           "how precompute and relighting grow with vertices, the size of a mesh "
                           "at the default tolerance, clusters and blockers; Markdown on stdout, "
                           "JSON in a folder");
    program.add("--folder", folder, "where growth.json goes");
    program.add("--vertices", most_vertices, "at most so many");
    program.add("--triangles", most_triangles, "at most so many");
    program.add("--only", chosen, "which, with commas between them");
    return program.run(argc, argv, [&] {
        const Steps steps = program.is_tiny() ? Steps::tiny() : Steps();
        fs::create_directories(folder);
        nlohmann::json result;
        for (const std::string& what : chosen)
            result[what] =
                report(what, what == "vertices"    ? against_vertices(steps, most_vertices)
                             : what == "mesh_size" ? against_mesh_size(steps, most_vertices)
                             : what == "clusters"  ? against_clusters(steps)
                                                   : against_blockers(steps, most_triangles));
        std::ofstream(folder / "growth.json") << result.dump(2) << '\n';
    });
}
