// A day of edits in minutes: many edits and many environments in one process. Says whether its
// memory stays flat, whether radiance drifts, and how long the slowest edits take. See `./dev bench
// drift --help`.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "relumine/relumine.h"
#include "tests/bench/program.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

struct Settings {
    std::size_t num_edits = 100'000;
    std::size_t num_environments = 10'000;
    std::size_t num_vertices = 20'000;
    std::uint32_t resolution = 256;
    /// As many vertices as that, with --tiny
    bool no_refine = false;
};

/// Memory that the process holds now, in MB.
double resident_megabytes() {
    std::ifstream file("/proc/self/statm");
    double total = 0.0, resident = 0.0;
    file >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

/// Layers as artists move them: discs, hard and soft, and brush strokes, each somewhere else and of
/// another strength, and now and then a sun.
class RandomLayers {
public:
    [[nodiscard]] cubemap::LightLayer next() {
        cubemap::LightLayer layer;
        layer.name = "edited";
        const glm::dvec3 at = direction();
        if (random_() % 50 == 0) {
            layer.region = cubemap::Disc{.direction = at, .radius_degrees = uniform(0.25, 1.0)};
            layer.effect = cubemap::Emit{.radiance = glm::vec3(1e4f)};
            return layer;
        }
        switch (random_() % 3) {
        case 0:
            layer.region = cubemap::Disc{.direction = at, .radius_degrees = uniform(1.0, 20.0)};
            break;
        case 1:
            layer.region = cubemap::Disc{.direction = at,
                                         .radius_degrees = uniform(2.0, 15.0),
                                         .softness = uniform(0.0, 1.0)};
            break;
        default:
            layer.region = cubemap::Stroke{.points = {at, glm::normalize(at + 0.3 * direction())},
                                           .radius_degrees = uniform(1.0, 5.0)};
        }
        layer.effect = cubemap::Emit{.radiance = glm::vec3(static_cast<float>(uniform(0.0, 10.0)))};
        return layer;
    }

private:
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    glm::dvec3 direction() {
        std::normal_distribution<double> normal;
        return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
    }

    std::mt19937 random_{1};
};

/// Largest difference of two pictures over the largest value of the second.
double difference(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    double most = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            most = std::max(most, std::abs(static_cast<double>(a[i][channel]) -
                                           static_cast<double>(b[i][channel])));
            largest = std::max(largest, static_cast<double>(b[i][channel]));
        }
    return most / largest;
}

struct Times {
    /// seconds
    double median = 0.0, percentile_999 = 0.0, worst = 0.0;
};

Times times_of(std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    return {.median = seconds[seconds.size() / 2],
            .percentile_999 = seconds[seconds.size() * 999 / 1000],
            .worst = seconds.back()};
}

void run(const Settings& settings) {
    LitScene lit(precompute(data_gen::blob(settings.num_vertices),
                            {.tolerance = 0.02f, .no_refine = settings.no_refine}));
    const prt::Transfer& transfer = lit.scene().transfer;
    const cubemap::CubeMap base = data_gen::two_soft_boxes(settings.resolution);
    lit.light(base);

    RandomLayers layers;
    // Without marks: each sums all anew, and a history may hold a gigabyte.
    const auto edit = [&] {
        std::vector<cubemap::LightLayer> list;
        list.push_back(layers.next());
        set_layers(lit, std::move(list));
    };
    const auto change_environment = [&](std::size_t i) {
        cubemap::CubeMap next = base;
        const auto gain = static_cast<float>(1 + i % 7);
        for (glm::vec3& texel : next.texels)
            texel *= gain;
        lit.light(std::move(next));
    };
    const auto drift_now = [&] {
        return difference(lit.radiance(), relight::relight(transfer, environment_of(lit),
                                                           lit.relighter().shadow_rays()));
    };
    // A tenth of the work first: caches and pools have their size then.
    for (std::size_t i = 0; i < settings.num_environments / 10; ++i)
        change_environment(i);
    for (std::size_t i = 0; i < settings.num_edits / 10; ++i)
        edit();
    static_cast<void>(drift_now());
    const double before = resident_megabytes();

    std::vector<double> environments(settings.num_environments);
    for (std::size_t i = 0; i < environments.size(); ++i)
        environments[i] = bench::seconds_of([&] { change_environment(i); });
    std::vector<double> edits(settings.num_edits);
    double drift = 0.0;
    for (std::size_t i = 0; i < edits.size(); ++i) {
        edits[i] = bench::seconds_of(edit);
        if (i % 1000 == 999 || i + 1 == edits.size())
            drift = std::max(drift, drift_now());
    }
    const double after = resident_megabytes();

    const Times of_edits = times_of(edits);
    const Times of_environments = times_of(environments);
    fmt::print("{} receivers, {} clusters, R = {}\n\n", transfer.num_receivers(),
               transfer.num_clusters(), settings.resolution);
    fmt::print("| | median | 99.9 % | worst |\n|---|---|---|---|\n");
    fmt::print("| {} edits | {:.3f} ms | {:.3f} ms | {:.3f} ms |\n", edits.size(),
               1e3 * of_edits.median, 1e3 * of_edits.percentile_999, 1e3 * of_edits.worst);
    fmt::print("| {} environments | {:.3f} ms | {:.3f} ms | {:.3f} ms |\n\n", environments.size(),
               1e3 * of_environments.median, 1e3 * of_environments.percentile_999,
               1e3 * of_environments.worst);
    fmt::print("Memory: {:.1f} MB after a tenth of the work, {:.1f} MB at the end ({:+.2f} %). "
               "Radiance is "
               "at most {:.1e} of its largest value off a fresh relighting.\n",
               before, after, 100.0 * (after / before - 1.0), drift);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_drift", "memory, drift and times over many edits and "
                                          "environments; Markdown on stdout");
    program.add("--edits", settings.num_edits, "1 or more");
    program.add("--environments", settings.num_environments, "1 or more");
    program.add("--vertices", settings.num_vertices, "of the generated boulder");
    program.add("--face-resolution", settings.resolution, "R");
    return program.run(argc, argv, [&] {
        if (program.is_tiny()) {
            settings.num_edits = 40;
            settings.num_environments = 10;
            settings.num_vertices = 1000;
            settings.no_refine = true;
            settings.resolution = 16;
        }
        if (settings.num_edits == 0 || settings.num_environments == 0)
            throw std::invalid_argument("expected at least one edit and one environment");
        run(settings);
    });
}
