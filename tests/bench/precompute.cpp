// How fast the preprocessor is: beams and rays with Embree against the plain way, threads, memory,
// cancelling. See `./dev bench precompute --help`.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <numbers>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/scenes.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "prt/precompute.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/bench/inputs.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/times.h"

namespace {

using namespace relumine;

/// The paper's algorithm as one would write it down: cell by cell, each of the nine samples a
/// vector of floats, every ray on its own, nothing shared between cells. Returns the number of
/// clusters.
class PlainClustering {
public:
    PlainClustering(const prt::Receivers& receivers, const prt::RayScene& rays,
                    const prt::PrecomputeOptions& options)
        : receivers_(receivers), rays_(rays), options_(options) {}

    std::size_t run() {
        for (const cubemap::Face face : cubemap::AllFaces)
            visit({.face = face});
        return num_clusters_;
    }

private:
    void visit(const prt::Cell& cell) {
        if (cell.level >= options_.min_level && is_cluster(cell)) {
            ++num_clusters_;
            return;
        }
        for (std::uint32_t i = 0; i < 4; ++i)
            visit(cell.child(i));
    }
    [[nodiscard]] bool is_cluster(const prt::Cell& cell) const {
        const std::size_t n = receivers_.size();
        std::array<std::vector<float>, prt::SamplesPerCell> transfer;
        std::array<glm::vec3, prt::SamplesPerCell> directions;
        const auto points = prt::lattice_points(cell);
        for (std::size_t l = 0; l < prt::SamplesPerCell; ++l) {
            transfer[l].resize(n);
            directions[l] = prt::direction(points[l]);
        }
        files::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
            const glm::vec3& normal = receivers_.normals[i];
            const glm::vec3 origin =
                prt::ray_origin(receivers_.positions[i], normal, options_.bias);
            for (std::size_t l = 0; l < prt::SamplesPerCell; ++l) {
                const float cosine = glm::dot(normal, directions[l]);
                transfer[l][i] =
                    cosine > 0.0f && !rays_.occluded(origin, directions[l]) ? cosine : 0.0f;
            }
        });
        std::array<double, prt::SamplesPerCell> distances{};
        for (std::size_t i = 0; i < n; ++i) {
            float mean = 0.0f;
            for (std::size_t l = 0; l < prt::SamplesPerCell; ++l)
                mean += static_cast<float>(prt::SampleWeights[l]) / prt::FullCount * transfer[l][i];
            for (std::size_t l = 0; l < prt::SamplesPerCell; ++l)
                distances[l] +=
                    static_cast<double>((transfer[l][i] - mean) * (transfer[l][i] - mean));
        }
        const double allowed = static_cast<double>(options_.tolerance) *
                               std::sqrt(static_cast<double>(n)) * std::numbers::pi;
        return std::all_of(distances.begin(), distances.end(),
                           [&](double d) { return d < allowed * allowed; });
    }

    const prt::Receivers& receivers_;
    const prt::RayScene& rays_;
    const prt::PrecomputeOptions& options_;
    std::size_t num_clusters_ = 0;
};

/// The longest time between two calls.
class LongestGap {
public:
    void call() {
        const std::scoped_lock lock(mutex_);
        longest_ = std::max(longest_, since_last_.seconds());
        since_last_.restart();
    }
    [[nodiscard]] double seconds() const { return longest_; }

private:
    std::mutex mutex_;
    bench::Stopwatch since_last_;
    double longest_ = 0.0;
};

void print(const std::string& name, double seconds, double cpu, std::size_t num_clusters) {
    fmt::print("{:<22} {:8.2f} s  {:8.2f} s of processors  {:6} clusters", name, seconds, cpu,
               num_clusters);
}

void measure(const std::string& name, const prt::Receivers& receivers,
             const prt::Blockers& blockers, const prt::PrecomputeOptions& options) {
    LongestGap gap;
    prt::PrecomputeStatistics statistics;
    const double before = bench::cpu_seconds();
    const prt::Transfer transfer = prt::precompute(receivers, blockers, options,
                                                   {.on_progress =
                                                        [&](double) {
                                                            gap.call();
                                                        }},
                                                   &statistics);
    print(name, statistics.seconds, bench::cpu_seconds() - before, transfer.num_clusters());
    fmt::print("  {:.0f} M rays  longest without progress {:.0f} ms  peak {:.0f} MB\n",
               static_cast<double>(statistics.num_rays) * 1e-6, gap.seconds() * 1e3,
               bench::peak_megabytes());
}

/// Time from the wish to stop to the end of the work, at moments spread over it.
void measure_cancel(const prt::Receivers& receivers, const prt::Blockers& blockers,
                    const prt::PrecomputeOptions& options, std::chrono::milliseconds step) {
    double longest = 0.0;
    for (int i = 1; i <= 8; ++i) {
        std::stop_source stop;
        bench::Stopwatch since_asked;
        const std::jthread canceller([&, i] {
            std::this_thread::sleep_for(i * step);
            since_asked.restart();
            stop.request_stop();
        });
        try {
            static_cast<void>(
                prt::precompute(receivers, blockers, options, {.stop = stop.get_token()}));
        } catch (const prt::Cancelled&) {
            longest = std::max(longest, since_asked.seconds());
        }
    }
    fmt::print("cancelled after at most {:.0f} ms\n", longest * 1e3);
}

struct Settings {
    std::string mesh = "bun_zipper.ply";
    std::uint32_t floor_vertices = 193;
    float tolerance = 0.03f;
    bool plain = false;
    bool threads = false;
    bool cancel = false;
};

/// A path, a name of meshes/stanford, or 'colonnade'.
mesh::TriangleMesh load(const Settings& settings, const bench::Inputs& inputs) {
    if (settings.mesh == "colonnade")
        return data_gen::colonnade();
    if (!inputs.is_tiny() && std::filesystem::exists(settings.mesh))
        return load_mesh(settings.mesh,
                         {.floor_vertices = settings.floor_vertices != 0
                                                ? std::optional(settings.floor_vertices)
                                                : std::nullopt})
            .geometry;
    return inputs.mesh(settings.mesh, settings.floor_vertices).geometry;
}

/// The parts of relumine::precompute() one by one, as their times are wanted.
void run(const Settings& settings, const bench::Inputs& inputs) {
    const mesh::TriangleMesh mesh = load(settings, inputs);
    const prt::Receivers receivers = prt::vertex_receivers(mesh);
    const prt::PrecomputeOptions options{.tolerance = settings.tolerance,
                                         .bias = prt::automatic_bias(mesh)};
    fmt::print("{} vertices, {} triangles, tolerance {}\n", mesh.num_vertices(),
               mesh.num_triangles(), settings.tolerance);

    const prt::RayScene rays(mesh);
    const bench::Stopwatch tree;
    const prt::BeamScene beams(mesh, rays);
    fmt::print("tree for the beams     {:8.2f} s\n", tree.seconds());
    if (settings.threads) {
        const files::ThreadLimit one(1);
        measure("beams, one thread", receivers, beams, options);
    }
    measure("beams", receivers, beams, options);
    measure("Embree, packets", receivers, rays, options);
    if (settings.plain) {
        const bench::Stopwatch watch;
        const double before = bench::cpu_seconds();
        const std::size_t num_clusters = PlainClustering(receivers, rays, options).run();
        print("plain", watch.seconds(), bench::cpu_seconds() - before, num_clusters);
        fmt::print("\n");
    }
    if (settings.cancel)
        measure_cancel(receivers, beams, options,
                       std::chrono::milliseconds(inputs.is_tiny() ? 2 : 170));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_precompute", "how fast relumine precompute is");
    const bench::Inputs inputs(program);
    program.add("--mesh", settings.mesh,
                "a mesh file, a name of meshes/stanford, or 'colonnade' for the generated one");
    program.add("--floor", settings.floor_vertices, "floor of N x N vertices, 0 for none");
    program.add("--tolerance", settings.tolerance, "RMS, 1/sr");
    program.add_flag("--plain", settings.plain,
                     "also one ray at a time, cell by cell: minutes at the default tolerance");
    program.add_flag("--threads", settings.threads, "also on one thread");
    program.add_flag("--cancel", settings.cancel, "also how fast it stops");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny()) {
            settings.tolerance = 0.1f;
            settings.plain = settings.threads = settings.cancel = true;
        }
        run(settings, inputs);
    });
}
