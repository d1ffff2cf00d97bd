// Frames of a sequence, binned already: how long relighting takes from one to the next, and from
// how many changed clusters on summing all of them is less work than updating.
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "data_gen/sequences.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

struct Settings {
    std::string probe = "grace_cross.hdr";
    std::uint32_t resolution = 256;
    std::size_t num_frames = 16;
    int passes = 5;
};

void measure_sequence(const data_gen::Sequence& sequence, const Settings& settings,
                      const bench::Inputs& inputs, const LitScene& lit) {
    data_gen::SequenceOptions options{.num_frames = settings.num_frames,
                                      .face_resolution = settings.resolution};
    if (sequence.needs_probe)
        options.probe = inputs.environment(settings.probe, settings.resolution);
    const data_gen::FrameMaker make = sequence.make(options);
    relight::EnvironmentBinner binner(lit.scene().transfer,
                                      lit.relighter().shadow_rays().tolerance);
    std::vector<relight::BinnedEnvironment> frames;
    std::vector<double> bin;
    for (std::size_t i = 0; i < settings.num_frames; ++i) {
        cubemap::CubeMap map = make(i);
        const bench::Stopwatch watch;
        frames.push_back(binner.bin(std::move(map)));
        bin.push_back(1e3 * watch.seconds());
    }
    relight::Relighter relighter(lit.scene().transfer, lit.relighter().shadow_rays());
    relighter.set_frame(frames.back());
    std::vector<double> relight;
    std::vector<double> trace;
    std::size_t num_clusters = 0;
    std::size_t num_resummed = 0;
    std::size_t num_traced = 0, num_lights = 0;
    for (int pass = 0; pass < settings.passes; ++pass)
        for (const relight::BinnedEnvironment& frame : frames) {
            relight::BinnedEnvironment copy = frame; // not the Relighter's work
            const bench::Stopwatch watch;
            const relight::UpdateReport report = relighter.set_frame(std::move(copy));
            relight.push_back(1e3 * watch.seconds());
            trace.push_back(1e3 * report.seconds_trace);
            num_clusters += report.num_clusters;
            num_resummed += static_cast<std::size_t>(report.resummed);
            num_traced += report.num_sharp_lights;
            num_lights += frame.sharp_lights.size();
        }
    const auto count = static_cast<double>(relight.size());
    const double least = *std::min_element(relight.begin(), relight.end());
    fmt::print("| {} | {:.0f} | {:.0f} % | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} of {:.1f} | "
               "{:.0f} |\n",
               sequence.name, static_cast<double>(num_clusters) / count,
               100.0 * static_cast<double>(num_resummed) / count, bench::median(bin), least,
               bench::median(relight), bench::median(trace),
               static_cast<double>(num_traced) / count, static_cast<double>(num_lights) / count,
               1e3 / bench::median(relight));
    std::fflush(stdout);
}

/// Updates of a random part of the clusters, and the sum of all.
void measure_shares(const Settings& settings, const Scene& scene) {
    relight::EnvironmentBinner binner(scene.transfer, 0.0f);
    const relight::BinnedEnvironment base =
        binner.bin(cubemap::CubeMap(settings.resolution, glm::vec3(1.0f)));
    relight::Relighter relighter(scene.transfer);
    relighter.set_frame(base);
    std::vector<double> all;
    for (int i = 0; i < settings.passes; ++i) {
        const bench::Stopwatch watch;
        relighter.resum();
        all.push_back(1e3 * watch.seconds());
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
            const bench::Stopwatch watch;
            resummed = relighter.set_frame(std::move(frame)).resummed;
            update.push_back(1e3 * watch.seconds());
        }
        fmt::print("{:.0f} % of the clusters: {:.1f} ms (least {:.1f}){}\n", 100.0 * share,
                   bench::median(update), *std::min_element(update.begin(), update.end()),
                   resummed ? ", all summed" : "");
    }
}

void run(const Settings& settings, const bench::Inputs& inputs) {
    const LitScene lit(inputs.bunny());
    const Scene& scene = lit.scene();
    fmt::print("{} receivers, {} clusters, R = {}, milliseconds\n\n| sequence | clusters changed | "
               "all summed | bin | relight, least | median | of it shadow rays | lights traced | "
               "frames/s |\n|---|---|---|---|---|---|---|---|---|\n",
               scene.transfer.num_receivers(), scene.transfer.num_clusters(), settings.resolution);
    for (const data_gen::Sequence& sequence : data_gen::sequences())
        try {
            measure_sequence(sequence, settings, inputs, lit);
        } catch (const bench::Absent& absent) {
            fmt::print("{}: skipped, {}\n", sequence.name, absent.what());
        }
    measure_shares(settings, scene);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_frames",
                           "times of relighting the frames of sequences that are binned already");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--env", settings.probe, "file of envs/debevec for the sequence `turn`");
    program.add("--face-resolution", settings.resolution, "R");
    program.add("--num-frames", settings.num_frames, "of a sequence");
    program.add("--passes", settings.passes, "over the frames");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny())
            settings = {.resolution = 16, .num_frames = 3, .passes = 1};
        run(settings, inputs);
    });
}
