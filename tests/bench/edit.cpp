// The editing experiment of Johan and Nishita, "Efficient Relighting by Clustering Environment
// Lights", Section 6: the bunny under the beach, two discs of 5 % and 10 % of the map's width in
// front of it and at its side grow brighter over 60 steps, then move over 60.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/resample/resample.h"
#include "prt/visibility/ray_scene.h"
#include "relight/light_editor.h"
#include "tests/bench/bunny.h"
#include "tests/bench/median.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

constexpr int NumSteps = 60;
constexpr double PaperSeconds = 0.06; // average, Pentium 4

struct Settings {
    fs::path data = RELUMINE_DATA_DIR;
    /// A bunny.prt that is there already
    fs::path scene;
    fs::path json = "edit.json";
    std::uint32_t resolution = 1024;
};

struct Figures {
    double average = 0.0, worst = 0.0, clusters = 0.0;
};

template<class LayersAt>
Figures steps(relight::LightEditor& editor, const LayersAt& layers_at) {
    Figures figures;
    for (int step = 1; step <= NumSteps; ++step) {
        const auto layers = layers_at(static_cast<double>(step) / NumSteps);
        for (std::size_t i = 0; i < layers.size();
             ++i) { // one disc is one edit, as an artist would drag it
            relight::UpdateReport report;
            const double seconds =
                bench::seconds_of([&] { report = editor.set_layer(i, layers[i]); });
            figures.average += seconds / (2 * NumSteps);
            figures.worst = std::max(figures.worst, seconds);
            figures.clusters += static_cast<double>(report.num_clusters) / (2 * NumSteps);
        }
    }
    return figures;
}

void print_row(const char* name, const Figures& figures, double full) {
    fmt::print("| {} | {:.3f} ms | {:.3f} ms | {:.0f} | {:.0f} x |\n", name, 1e3 * figures.average,
               1e3 * figures.worst, figures.clusters, full / figures.average);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App program{
        "Measures Johan and Nishita's editing experiment; Markdown on stdout, JSON in a file"};
    program.add_option("--data", settings.data, "folder with meshes/stanford and envs/debevec")
        ->capture_default_str();
    program.add_option("--scene", settings.scene, "the bunny's .prt, where it is there");
    program.add_option("--json", settings.json, "JSON file to write")->capture_default_str();
    program.add_option("--face-resolution", settings.resolution, "R")->capture_default_str();
    CLI11_PARSE(program, argc, argv);
    const fs::path beach = settings.data / "envs/debevec/beach_cross.hdr";
    if (!fs::exists(beach)) {
        fmt::print("skipped, no {}; name the folder with --data\n", beach.string());
        return 0;
    }
    try {
        const prt::Scene scene = bench::bunny(settings.scene, settings.data);
        const prt::RayScene rays(scene.mesh);
        relight::LightEditor editor(scene.transfer, {.blockers = &rays,
                                                     .positions = scene.mesh.positions,
                                                     .bias = scene.settings.bias,
                                                     .tolerance = scene.settings.tolerance});
        const cubemap::CubeMap base =
            cubemap::resample(cubemap::load_environment(beach), settings.resolution);
        std::vector<double> full;
        for (int i = 0; i < 7; ++i) {
            const relight::RelightTimes times = editor.set_base(base);
            full.push_back(times.seconds_bin + times.seconds_trace + times.seconds_relight);
        }
        const glm::dvec3 front(0.15, 0.35, 1.0);
        const glm::dvec3 side(1.0, 0.35, 0.15);
        editor.set_layers({bench::disc(front, 0.05, 0.0), bench::disc(side, 0.10, 0.0)});
        const Figures rising = steps(editor, [&](double t) {
            return std::vector{bench::disc(front, 0.05, 10.0 * t),
                               bench::disc(side, 0.10, 5.0 * t)};
        });
        const Figures moving = steps(editor, [&](double t) {
            const glm::dvec3 shift(0.0, 0.8 * t, -0.5 * t);
            return std::vector{bench::disc(front + shift, 0.05, 10.0),
                               bench::disc(side + shift, 0.10, 5.0)};
        });
        const double full_seconds = bench::median(full);
        fmt::print("Bunny, {} vertices, {} clusters, beach at R = {}; a full relight of the binned "
                   "map and "
                   "its binning: {:.1f} ms\n\n",
                   scene.mesh.num_vertices(), scene.transfer.num_clusters(), settings.resolution,
                   1e3 * full_seconds);
        fmt::print(
            "| edit | average | worst | clusters | faster than full |\n|---|---|---|---|---|\n");
        fmt::print("| paper, average | {:.0f} ms | - | - | about 100 x |\n", 1e3 * PaperSeconds);
        print_row("60 steps of rising intensity", rising, full_seconds);
        print_row("60 steps of moving", moving, full_seconds);
        const nlohmann::json result = {
            {"clusters", scene.transfer.num_clusters()},
            {"seconds_full", full_seconds},
            {"rising",
             {{"average", rising.average}, {"worst", rising.worst}, {"clusters", rising.clusters}}},
            {"moving",
             {{"average", moving.average},
              {"worst", moving.worst},
              {"clusters", moving.clusters}}}};
        std::ofstream(settings.json) << result.dump(2) << '\n';
    } catch (const std::exception& error) {
        fmt::print(stderr, "edit: {}\n", error.what());
        return 1;
    }
    return 0;
}
