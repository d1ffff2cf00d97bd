// Frames of a sequence, binned already: how long relighting takes from one to the next, and from
// how many changed clusters on summing all of them is less work than updating.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cubemap/image/environment.h"
#include "cubemap/resample/resample.h"
#include "data_gen/sequences.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "relight/relighter.h"
#include "tests/bench/median.h"

using namespace relumine;

namespace {

struct Settings {
    std::string scene;
    std::string probe;
    std::uint32_t resolution = 256;
    std::size_t num_frames = 16;
    int passes = 5;
};

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void measure_sequence(const data_gen::Sequence& sequence, const Settings& settings,
                      const prt::Scene& scene, const relight::ShadowRays& rays) {
    data_gen::SequenceOptions options{.num_frames = settings.num_frames,
                                      .face_resolution = settings.resolution};
    if (sequence.needs_probe) {
        if (settings.probe.empty())
            return;
        options.probe =
            cubemap::resample(cubemap::load_environment(settings.probe), settings.resolution);
    }
    const data_gen::FrameMaker make = sequence.make(options);
    relight::EnvironmentBinner binner(scene.transfer, rays.tolerance);
    std::vector<relight::BinnedEnvironment> frames;
    std::vector<double> bin;
    for (std::size_t i = 0; i < settings.num_frames; ++i) {
        cubemap::CubeMap map = make(i);
        const auto start = Clock::now();
        frames.push_back(binner.bin(std::move(map)));
        bin.push_back(milliseconds_since(start));
    }
    relight::Relighter relighter(scene.transfer, rays);
    relighter.set_frame(frames.back());
    std::vector<double> relight;
    std::vector<double> trace;
    std::size_t num_clusters = 0;
    std::size_t num_resummed = 0;
    for (int pass = 0; pass < settings.passes; ++pass)
        for (const relight::BinnedEnvironment& frame : frames) {
            relight::BinnedEnvironment copy = frame; // not the Relighter's work
            const auto start = Clock::now();
            const relight::UpdateReport report = relighter.set_frame(std::move(copy));
            relight.push_back(milliseconds_since(start));
            trace.push_back(1e3 * report.seconds_trace);
            num_clusters += report.num_clusters;
            num_resummed += static_cast<std::size_t>(report.resummed);
        }
    const auto count = static_cast<double>(relight.size());
    const double least = *std::min_element(relight.begin(), relight.end());
    fmt::print("| {} | {:.0f} | {:.0f} % | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} |\n",
               sequence.name, static_cast<double>(num_clusters) / count,
               100.0 * static_cast<double>(num_resummed) / count, bench::median(bin), least,
               bench::median(relight), bench::median(trace), 1e3 / bench::median(relight));
    std::fflush(stdout);
}

/// Updates of a random part of the clusters, and the sum of all.
void measure_shares(const Settings& settings, const prt::Scene& scene) {
    relight::EnvironmentBinner binner(scene.transfer, 0.0f);
    const relight::BinnedEnvironment base =
        binner.bin(cubemap::CubeMap(settings.resolution, glm::vec3(1.0f)));
    relight::Relighter relighter(scene.transfer);
    relighter.set_frame(base);
    std::vector<double> all;
    for (int i = 0; i < settings.passes; ++i) {
        const auto start = Clock::now();
        relighter.resum();
        all.push_back(milliseconds_since(start));
    }
    fmt::print("\nsum of all clusters: {:.1f} ms (least {:.1f})\n", bench::median(all),
               *std::min_element(all.begin(), all.end()));
    std::mt19937 random(1);
    for (const double share : {0.01, 0.05, 0.1, 0.2, 0.29, 0.4, 0.5}) {
        std::vector<double> update;
        bool resummed = false;
        for (int i = 0; i < settings.passes; ++i) {
            relight::BinnedEnvironment frame = base;
            for (relight::VectorIrradiance& sum : frame.sums)
                if (std::uniform_real_distribution<double>()(random) < share)
                    sum.red *= 1.0 + 0.1 * (i + 1);
            relighter.set_frame(base);
            const auto start = Clock::now();
            resummed = relighter.set_frame(std::move(frame)).resummed;
            update.push_back(milliseconds_since(start));
        }
        fmt::print("{:.0f} % of the clusters: {:.1f} ms (least {:.1f}){}\n", 100.0 * share,
                   bench::median(update), *std::min_element(update.begin(), update.end()),
                   resummed ? ", all summed" : "");
    }
}

} // namespace

int main(int argc, char** argv) {
    CLI::App program{"Times of relighting the frames of sequences that are binned already."};
    Settings settings;
    program.add_option("SCENE", settings.scene, "scene file from `relumine precompute`")
        ->required();
    program.add_option("--env", settings.probe, "environment for the sequence `turn`");
    program.add_option("--face-resolution", settings.resolution)->capture_default_str();
    program.add_option("--num-frames", settings.num_frames)->capture_default_str();
    program.add_option("--passes", settings.passes)->capture_default_str();
    CLI11_PARSE(program, argc, argv);
    const prt::Scene scene = prt::load_scene(settings.scene);
    const prt::RayScene blockers(scene.mesh);
    const relight::ShadowRays rays{.blockers = &blockers,
                                   .positions = scene.mesh.positions,
                                   .bias = scene.settings.bias,
                                   .tolerance = scene.settings.tolerance};
    fmt::print("{} receivers, {} clusters, R = {}, milliseconds\n\n| sequence | clusters changed | "
               "all summed | bin "
               "| relight, least | median | of it shadow rays | frames/s "
               "|\n|---|---|---|---|---|---|---|---|\n",
               scene.transfer.num_receivers(), scene.transfer.num_clusters(), settings.resolution);
    for (const data_gen::Sequence& sequence : data_gen::sequences())
        measure_sequence(sequence, settings, scene, rays);
    measure_shares(settings, scene);
}
