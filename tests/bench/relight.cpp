// How fast a precomputed scene is relit and edited, beside the plain ways: a dense table of bytes,
// and a full relighting for every edit. All in one run, so that the ratios hold on a busy machine.
// See `./dev bench relight --help`.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/resample/resample.h"
#include "prt/visibility/ray_scene.h"
#include "relight/exact.h"
#include "relight/light_editor.h"
#include "tests/bench/bunny.h"
#include "tests/bench/dense_table.h"
#include "tests/bench/median.h"
#include "tests/bench/memory_bandwidth.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

struct Settings {
    fs::path data = RELUMINE_DATA_DIR;
    /// A bunny.prt that is there already
    fs::path scene;
    fs::path json = "relight.json";
    std::uint32_t resolution = 1024;
    /// Receivers to verify
    std::size_t num_samples = 2000;
};

class Report {
public:
    void add(const std::string& key, const std::string& text, double milliseconds,
             const std::string& remark) {
        fmt::print("| {} | {:.3f} ms | {} |\n", text, milliseconds, remark);
        json_[key] = milliseconds;
    }
    void add_value(const std::string& key, double value) { json_[key] = value; }
    void save(const fs::path& path) const { std::ofstream(path) << json_.dump(2) << '\n'; }

private:
    nlohmann::json json_;
};

/// Median time of an edit that changes a disc's brightness.
double edit_seconds(relight::LightEditor& editor, double part_of_face) {
    const glm::dvec3 direction(0.15, 0.35, 1.0);
    editor.set_layers({bench::disc(direction, part_of_face, 0.0)});
    constexpr int NumEdits = 200;
    std::vector<double> seconds;
    for (int i = 1; i <= NumEdits; ++i)
        seconds.push_back(bench::seconds_of(
            [&] { editor.set_layer(0, bench::disc(direction, part_of_face, 0.05 * i)); }));
    return bench::median(seconds);
}

void measure_relighting(const Settings& settings, const prt::Scene& scene,
                        const relight::ShadowRays& shadow_rays, Report& report) {
    const double bandwidth = bench::memory_bandwidth();
    report.add_value("memory_bandwidth", bandwidth);
    const cubemap::CubeMap beach =
        cubemap::resample(cubemap::load_environment(settings.data / "envs/debevec/beach_cross.hdr"),
                          settings.resolution);
    relight::LightEditor editor(scene.transfer, shadow_rays);
    editor.set_base(beach);

    // A Relighter without sharp lights: what is compared is the sum over clusters.
    relight::Relighter relighter(scene.transfer);
    relighter.set_environment(beach);
    const double full = bench::median_seconds([&] { relighter.resum(); });
    const prt::VisibleCounts& counts = scene.transfer.counts;
    const double bytes = static_cast<double>(counts.counts.size() + 16 * counts.mixed.size());

    const bench::DenseTable table = bench::dense_table(scene.transfer);
    std::vector<glm::vec3> light;
    for (const relight::VectorIrradiance& sum :
         relight::LightBinning(beach.resolution).sums(beach, scene.transfer.quadtree.leaves()))
        light.emplace_back(glm::length(sum.red), glm::length(sum.green), glm::length(sum.blue));
    std::vector<glm::vec3> dense_radiance;
    const double dense =
        bench::median_seconds([&] { bench::relight(table, light, dense_radiance); });
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
        settings.resolution);
    fmt::print("| step | median | remark |\n|---|---|---|\n");
    report.add("full_relight", "full relight of a binned map", 1e3 * full,
               fmt::format("{:.0f} MB, {:.1f} times as fast as the dense table", 1e-6 * bytes,
                           dense / full));
    report.add("dense_relight", "the same with a dense table of bytes", 1e3 * dense,
               fmt::format("{:.0f} MB at {:.1f} GB/s; radiance differs by {:.4f} (relative L2)",
                           1e-6 * static_cast<double>(table.values.size()),
                           1e-9 * static_cast<double>(table.values.size()) / dense,
                           std::sqrt(difference / norm)));

    const relight::LightBinning binning(beach.resolution);
    const double map_bytes = static_cast<double>(beach.texels.size() * sizeof(glm::vec3));
    const double bin = bench::median_seconds(
        [&] { static_cast<void>(binning.sums(beach, scene.transfer.quadtree.leaves())); });
    report.add("bin", "binning", 1e3 * bin,
               fmt::format("{:.0f} MB at {:.1f} GB/s, {:.2f} of what memory gives",
                           1e-6 * map_bytes, 1e-9 * map_bytes / bin, map_bytes / bin / bandwidth));
    for (const double part : {0.05, 0.10}) {
        const double edit = edit_seconds(editor, part);
        report.add(fmt::format("edit_{:.0f}", 100 * part),
                   fmt::format("an edit, disc of {:.0f} % of the map's width", 100 * part),
                   1e3 * edit, fmt::format("{:.0f} times as fast as a full relight", full / edit));
    }
}

void measure_files(const prt::Scene& scene, Report& report) {
    const fs::path path = fs::temp_directory_path() / "relumine_bench_relight.prt";
    prt::save_scene(path, scene);
    const double load = bench::median_seconds([&] { static_cast<void>(prt::load_scene(path)); });
    report.add("load", "loading the .prt", 1e3 * load,
               fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(fs::file_size(path))));
    report.add_value("prt_bytes", static_cast<double>(fs::file_size(path)));
    fs::remove(path);
}

void measure_errors(const Settings& settings, const prt::Scene& scene,
                    const relight::ShadowRays& shadow_rays, Report& report) {
    constexpr std::uint32_t Resolution = 256;
    const std::vector<std::uint32_t> sample =
        relight::random_receivers(scene.transfer, settings.num_samples, 1);
    std::vector<double> seconds;
    std::string errors;
    for (const std::string name : {"grace", "stpeters", "galileo", "kitchen", "beach"}) {
        const cubemap::CubeMap map = cubemap::resample(
            cubemap::load_environment(settings.data / "envs/debevec" / (name + "_cross.hdr")),
            Resolution);
        const std::vector<glm::vec3> relit = relight::relight(scene.transfer, map, shadow_rays);
        std::vector<glm::dvec3> exact;
        seconds.push_back(bench::seconds_of([&] {
            exact = relight::exact_radiance(scene.receivers, sample, *shadow_rays.blockers, map,
                                            {.bias = scene.settings.bias});
        }));
        const double error = relight::compare(sample, exact, relit).relative_l2;
        errors += fmt::format(" {} {:.5f}", name, error);
        report.add_value("error_" + name, error);
    }
    report.add("verify",
               fmt::format("exact radiance of {} receivers, R = {}", sample.size(), Resolution),
               1e3 * bench::median(seconds), "relative L2 of relighting:" + errors);
}

void run(const Settings& settings) {
    const prt::Scene scene = bench::bunny(settings.scene, settings.data);
    const prt::RayScene rays(scene.mesh);
    const relight::ShadowRays shadow_rays{.blockers = &rays,
                                          .positions = scene.mesh.positions,
                                          .bias = scene.settings.bias,
                                          .tolerance = scene.settings.tolerance};
    Report report;
    measure_relighting(settings, scene, shadow_rays, report);
    measure_files(scene, report);
    measure_errors(settings, scene, shadow_rays, report);
    report.save(settings.json);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App program{
        "Measures relighting and editing of the bunny against the plain ways; Markdown on "
        "stdout, JSON in a file"};
    program.add_option("--data", settings.data, "folder with meshes/stanford and envs/debevec")
        ->capture_default_str();
    program.add_option("--scene", settings.scene, "the bunny's .prt, where it is there");
    program.add_option("--json", settings.json, "JSON file to write")->capture_default_str();
    program.add_option("--face-resolution", settings.resolution, "R")->capture_default_str();
    program.add_option("--samples", settings.num_samples, "receivers to verify")
        ->capture_default_str();
    CLI11_PARSE(program, argc, argv);
    try {
        run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_relight: {}\n", error.what());
        return 1;
    }
    return 0;
}
