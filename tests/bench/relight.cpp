// How fast a precomputed scene is relit and edited, beside the plain ways: a dense table of bytes,
// and a full relighting for every edit. All in one run, so that the ratios hold on a busy machine.
// See `./dev bench relight --help`.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "relight/kernels/band_sums.h"
#include "relumine/relumine.h"
#include "tests/bench/baselines/features.h"
#include "tests/bench/baselines/packed_matrix.h"
#include "tests/bench/inputs.h"
#include "tests/bench/memory_bandwidth.h"
#include "tests/bench/times.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

struct Settings {
    std::uint32_t resolution = 1024;
    /// Receivers to verify
    std::size_t num_samples = 2000;
};

void print_row(const std::string& text, double milliseconds, const std::string& remark) {
    fmt::print("| {} | {:.3f} ms | {} |\n", text, milliseconds, remark);
}

/// Median time of an edit that changes a disc's brightness.
double edit_seconds(LitScene& lit, double part_of_face) {
    const glm::dvec3 direction(0.15, 0.35, 1.0);
    set_layers(lit, {bench::disc(direction, part_of_face, 0.0)});
    constexpr int NumEdits = 200;
    std::vector<double> seconds;
    for (int i = 1; i <= NumEdits; ++i)
        seconds.push_back(bench::seconds_of(
            [&] { set_layer(lit, 0, bench::disc(direction, part_of_face, 0.05 * i)); }));
    return bench::median(seconds);
}

void measure_relighting(const Settings& settings, const bench::Inputs& inputs, LitScene& lit) {
    const Scene& scene = lit.scene();
    const double bandwidth = bench::memory_bandwidth(inputs.is_tiny());
    const cubemap::CubeMap beach = inputs.environment("beach_cross.hdr", settings.resolution);
    lit.light(beach);

    // A Relighter without sharp lights: what is compared is the sum over clusters.
    relight::Relighter relighter(scene.transfer);
    relighter.set_environment(beach);
    const double full = bench::median_seconds([&] { relighter.resum(); });
    const prt::VisibleCounts& counts = scene.transfer.counts;
    const double bytes = static_cast<double>(counts.counts.size() + 16 * counts.mixed.size());

    const bench::Features clusters = bench::cluster_features(scene.transfer);
    const auto table = bench::packed<std::uint8_t>(clusters.rows);
    const std::vector<glm::vec3> light = clusters.project(beach);
    std::vector<glm::vec3> dense_radiance;
    const double dense =
        bench::median_seconds([&] { bench::multiply(table, light, dense_radiance); });
    double difference = 0.0, norm = 0.0;
    for (std::size_t place = 0; place < scene.transfer.num_receivers(); ++place) {
        const glm::dvec3 ours(relighter.radiance()[scene.transfer.order[place]]);
        const glm::dvec3 theirs(dense_radiance[place]);
        difference += glm::dot(ours - theirs, ours - theirs);
        norm += glm::dot(ours, ours);
    }

    fmt::print(
        "Memory is read at {:.1f} GB/s. Bunny, {} vertices, {} clusters; beach at R = {}.\n\n",
        1e-9 * bandwidth, scene.mesh.num_vertices(), scene.transfer.num_clusters(),
        beach.resolution);
    fmt::print("| step | median | remark |\n|---|---|---|\n");
    print_row("full relight of a binned map", 1e3 * full,
              fmt::format("{:.0f} MB, {:.1f} times as fast as the dense table", 1e-6 * bytes,
                          dense / full));
    print_row("the same with a dense table of bytes", 1e3 * dense,
              fmt::format("{:.0f} MB at {:.1f} GB/s; radiance differs by {:.4f} (relative L2)",
                          1e-6 * static_cast<double>(table.values.size()),
                          1e-9 * static_cast<double>(table.values.size()) / dense,
                          std::sqrt(difference / norm)));

    const relight::LightBinning binning(beach.resolution);
    const relight::BandSums bands(beach.resolution, scene.transfer.quadtree.leaves());
    const double map_bytes = static_cast<double>(beach.texels.size() * sizeof(glm::vec3));
    const double bin =
        bench::median_seconds([&] { static_cast<void>(binning.sums(beach, bands)); });
    print_row("binning", 1e3 * bin,
              fmt::format("{:.0f} MB at {:.1f} GB/s, {:.2f} of what memory gives", 1e-6 * map_bytes,
                          1e-9 * map_bytes / bin, map_bytes / bin / bandwidth));
    for (const double part : {0.05, 0.10}) {
        const double edit = edit_seconds(lit, part);
        print_row(fmt::format("an edit, disc of {:.0f} % of the map's width", 100 * part),
                  1e3 * edit, fmt::format("{:.0f} times as fast as a full relight", full / edit));
    }
}

void measure_files(const Scene& scene) {
    const fs::path path = fs::temp_directory_path() / "relumine_bench_relight.prt";
    save_scene(path, scene);
    const double load = bench::median_seconds([&] { static_cast<void>(load_scene(path)); });
    print_row("loading the .prt", 1e3 * load,
              fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(fs::file_size(path))));
    fs::remove(path);
}

void measure_errors(const Settings& settings, const bench::Inputs& inputs, LitScene& lit) {
    constexpr std::uint32_t Resolution = 256;
    set_layers(lit, {});
    std::size_t num_samples = 0;
    std::vector<double> seconds;
    std::string errors, errors_between;
    for (const std::string name : {"grace", "stpeters", "galileo", "kitchen", "beach"}) {
        lit.light(inputs.environment(name + "_cross.hdr", Resolution));
        Verification check;
        seconds.push_back(bench::seconds_of([&] {
            check = verify(lit, {.num_samples = settings.num_samples, .num_surface_points = 0});
        }));
        num_samples = check.receivers.size();
        errors += fmt::format(" {} {:.5f}", name, check.error.relative_l2);
        const Verification between =
            verify(lit, {.num_samples = 1, .num_surface_points = settings.num_samples});
        errors_between += fmt::format(" {} {:.5f}", name, between.surface->error.relative_l2);
    }
    print_row(fmt::format("exact radiance of {} receivers, R = {}", num_samples,
                          environment_of(lit).resolution),
              1e3 * bench::median(seconds),
              "relative L2 of relighting:" + errors + "; between the vertices:" + errors_between);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_relight", "relighting and editing of the bunny against the plain "
                                            "ways; Markdown on stdout");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--face-resolution", settings.resolution, "R");
    program.add("--samples", settings.num_samples, "receivers to verify");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny())
            settings.num_samples = 50;
        LitScene lit(inputs.bunny());
        measure_relighting(settings, inputs, lit);
        measure_files(lit.scene());
        measure_errors(settings, inputs, lit);
    });
}
