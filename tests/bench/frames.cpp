// Frames of a sequence, binned already: how long relighting takes from one to the next, and from
// how many changed clusters on summing all of them is less work than updating.
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/cube_map.h"
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

/// Returns the clusters nearest to a direction, `share` of all.
std::vector<bool> disc(const prt::Quadtree& quadtree, double share) {
    const glm::dvec3 middle = glm::normalize(glm::dvec3(0.3, 0.8, 0.4));
    std::vector<std::pair<double, std::size_t>> distances;
    for (std::size_t i = 0; i < quadtree.num_leaves(); ++i) {
        const prt::Cell& cell = quadtree.leaves()[i];
        const glm::dvec3 direction = cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                                        (cell.y + 0.5) * cell.size());
        distances.emplace_back(-glm::dot(direction, middle), i);
    }
    std::sort(distances.begin(), distances.end());
    distances.resize(static_cast<std::size_t>(share * static_cast<double>(distances.size())));
    std::vector<bool> result(quadtree.num_leaves());
    for (const auto& [distance, cluster] : distances)
        result[cluster] = true;
    return result;
}

/// Updates of a part of the clusters, spread at random or in a disc, and the sum of all.
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
    const auto measure = [&](const std::string& what, const auto& choose) {
        std::vector<double> update;
        bool resummed = false;
        for (int i = 0; i < settings.passes; ++i) {
            relight::BinnedEnvironment frame = base;
            const std::vector<bool> changed = choose();
            for (std::size_t c = 0; c < changed.size(); ++c)
                if (changed[c]) {
                    // Its colour and its direction change.
                    frame.sums[c].red *= 1.0 + 0.1 * (i + 1);
                    frame.sums[c].blue += 1e-3 * (i + 1) * glm::length(frame.sums[c].blue);
                }
            relighter.set_frame(base);
            const bench::Stopwatch watch;
            resummed = relighter.set_frame(std::move(frame)).resummed;
            update.push_back(1e3 * watch.seconds());
        }
        fmt::print("{}: {:.1f} ms (least {:.1f}), {:.2f} of the sum{}\n", what,
                   bench::median(update), *std::min_element(update.begin(), update.end()),
                   bench::median(update) / bench::median(all), resummed ? ", all summed" : "");
    };
    std::mt19937 random(1);
    for (const double share : {0.01, 0.05, 0.1, 0.2, 0.29, 0.4, 0.5})
        measure(fmt::format("{:.0f} % of the clusters", 100.0 * share), [&] {
            std::vector<bool> changed(base.sums.size());
            std::generate(changed.begin(), changed.end(),
                          [&] { return std::uniform_real_distribution<double>()(random) < share; });
            return changed;
        });
    for (const double share : {0.01, 0.05})
        measure(fmt::format("{:.0f} % in a disc", 100.0 * share),
                [changed = disc(scene.transfer.quadtree, share)] { return changed; });
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
