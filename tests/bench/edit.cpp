// The editing experiment of Johan and Nishita, "Efficient Relighting by Clustering Environment
// Lights", Section 6: the bunny under the beach, two discs of 5 % and 10 % of the map's width in
// front of it and at its side grow brighter over 60 steps, then move over 60.
#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

constexpr int NumSteps = 60;
constexpr double PaperSeconds = 0.06; // average, Pentium 4

struct Settings {
    std::uint32_t resolution = 1024;
};

struct Figures {
    double average = 0.0, worst = 0.0, clusters = 0.0;
};

template<class LayersAt>
Figures steps(LitScene& lit, const LayersAt& layers_at) {
    Figures figures;
    for (int step = 1; step <= NumSteps; ++step) {
        const auto layers = layers_at(static_cast<double>(step) / NumSteps);
        for (std::size_t i = 0; i < layers.size();
             ++i) { // one disc is one edit, as an artist would drag it
            relight::UpdateReport report;
            const double seconds =
                bench::seconds_of([&] { report = set_layer(lit, i, layers[i]); });
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

void run(const Settings& settings, const bench::Inputs& inputs) {
    const cubemap::CubeMap base = inputs.environment("beach_cross.hdr", settings.resolution);
    LitScene lit(inputs.bunny());
    std::vector<double> full;
    for (int i = 0; i < 7; ++i) {
        const UpdateReport times = lit.light(base);
        full.push_back(times.seconds_bin + times.seconds_trace + times.seconds_relight);
    }
    const glm::dvec3 front(0.15, 0.35, 1.0);
    const glm::dvec3 side(1.0, 0.35, 0.15);
    set_layers(lit, {bench::disc(front, 0.05, 0.0), bench::disc(side, 0.10, 0.0)});
    const Figures rising = steps(lit, [&](double t) {
        return std::vector{bench::disc(front, 0.05, 10.0 * t), bench::disc(side, 0.10, 5.0 * t)};
    });
    const Figures moving = steps(lit, [&](double t) {
        const glm::dvec3 shift(0.0, 0.8 * t, -0.5 * t);
        return std::vector{bench::disc(front + shift, 0.05, 10.0),
                           bench::disc(side + shift, 0.10, 5.0)};
    });
    const double full_seconds = bench::median(full);
    fmt::print("Bunny, {} vertices, {} clusters, beach at R = {}; a full relight of the binned map "
               "and its binning: {:.1f} ms\n\n",
               lit.scene().mesh.num_vertices(), lit.scene().transfer.num_clusters(),
               base.resolution, 1e3 * full_seconds);
    fmt::print("| edit | average | worst | clusters | faster than full |\n|---|---|---|---|---|\n");
    fmt::print("| paper, average | {:.0f} ms | - | - | about 100 x |\n", 1e3 * PaperSeconds);
    print_row("60 steps of rising intensity", rising, full_seconds);
    print_row("60 steps of moving", moving, full_seconds);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_edit",
                           "Johan and Nishita's editing experiment; Markdown on stdout");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--face-resolution", settings.resolution, "R");
    return program.run(argc, argv, [&] { run(settings, inputs); });
}
