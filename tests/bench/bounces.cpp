// Bounces of light: cost of the precompute, of the products with the matrix, and the error against
// a path tracer.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "prt/bounces/bounce_precompute.h"
#include "relight/bounces/bounce_light.h"
#include "relight/probe_lights.h"
#include "relight/reference/exact.h"
#include "relight/reference/path_tracer.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"
#include "tests/prt/all_bounces.h"

using namespace relumine;

namespace {

struct Settings {
    float tolerance = prt::BounceOptions{}.tolerance;
    float albedo = 0.8f;
    std::uint32_t paths = 1024;
    std::size_t samples = 500;
    std::uint32_t resolution = 128;
    std::vector<std::string> probes = {"beach_cross.hdr", "galileo_cross.hdr", "grace_cross.hdr",
                                       "stpeters_cross.hdr", "kitchen_cross.hdr"};
};

void run(const Settings& settings, const bench::Inputs& inputs) {
    LitScene lit(inputs.bunny());
    const Scene& scene = lit.scene();
    std::vector<prt::ProbeRadiance> probes;
    const double seconds_probes =
        bench::seconds_of([&] { probes = relight::probe_radiance(scene.transfer); });
    prt::BounceStatistics found;
    const prt::BounceMatrix matrix = prt::precompute_bounces(
        scene.mesh, scene.receivers, scene.transfer, probes, lit.rays().of_mesh(),
        {.tolerance = settings.tolerance, .bias = scene.settings.bias}, {}, &found);
    fmt::print(
        "{} vertices: probe lights {:.2f} s, bounces {:.2f} s, {:.2f} M rays, {:.2f} M hits, "
        "{:.2f} M emitters ({:.1f} a vertex, shared by {:.1f}), closure {:.3f}, standard error "
        "{:.4f}, spectral "
        "radius {:.3f}\n",
        scene.receivers.size(), seconds_probes, found.seconds,
        1e-6 * static_cast<double>(found.num_rays), 1e-6 * static_cast<double>(found.num_hits),
        1e-6 * static_cast<double>(found.num_emitters),
        static_cast<double>(found.num_emitters) / static_cast<double>(matrix.num_rows()),
        found.mean_averaged, found.mean_closure, found.rms_error, matrix.spectral_radius);

    relight::BounceLight bounces(matrix, scene.transfer);
    const std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(settings.albedo));
    bounces.set_albedo(albedo);
    const std::vector<std::uint32_t> sample =
        relight::random_receivers(scene.transfer, settings.samples, 1);
    for (const std::string& name : settings.probes) {
        const cubemap::CubeMap map = inputs.environment(name, settings.resolution);
        lit.light(map);
        const auto direct = lit.relighter().diffuse_radiance();
        relight::BounceReport report;
        std::vector<double> all, one;
        for (int i = 0; i < 7; ++i)
            all.push_back(bench::seconds_of([&] { report = bounces.solve(direct); }));
        const std::vector<glm::vec3> indirect(bounces.indirect().begin(), bounces.indirect().end());
        for (int i = 0; i < 7; ++i)
            one.push_back(bench::seconds_of([&] { bounces.step(direct); }));

        const auto exact =
            relight::exact_radiance(scene.receivers, sample, lit.rays().of_mesh(),
                                    environment_of(lit), {.bias = scene.settings.bias});
        const auto traced = relight::trace_bounces(
            scene.mesh, albedo, scene.receivers, sample, lit.rays().of_mesh(), environment_of(lit),
            {.num_paths = settings.paths, .bias = scene.settings.bias});
        double squares = 0.0, noise = 0.0, error = 0.0, direct_error = 0.0, indirect_error = 0.0;
        double mean = 0.0, mean_relit = 0.0, missing = 0.0;
        for (std::size_t i = 0; i < sample.size(); ++i) {
            const glm::dvec3 truth = exact[i] + traced[i].radiance;
            const glm::dvec3 d = glm::dvec3(direct[sample[i]]) - exact[i];
            const glm::dvec3 b = glm::dvec3(indirect[sample[i]]) - traced[i].radiance;
            for (int c = 0; c < 3; ++c) {
                squares += truth[c] * truth[c];
                noise += traced[i].standard_error[c] * traced[i].standard_error[c];
                error += (d[c] + b[c]) * (d[c] + b[c]);
                direct_error += d[c] * d[c];
                indirect_error += b[c] * b[c];
                mean += truth[c];
                mean_relit += truth[c] + d[c] + b[c];
                missing += traced[i].radiance[c] * traced[i].radiance[c];
            }
        }
        const auto relative = [&](double value) {
            return std::sqrt(std::max(value, 0.0) / squares);
        };
        fmt::print(
            "{}: all bounces {:.1f} ms ({}), one more {:.1f} ms; relative L2 {:.4f} (noise of "
            "the paths {:.4f}, without it {:.4f}; direct {:.4f}, bounces {:.4f}; without "
            "bounces {:.3f}), mean {:+.4f}\n",
            name, 1e3 * bench::median(all), report.num_bounces, 1e3 * bench::median(one),
            relative(error), relative(noise), relative(error - noise), relative(direct_error),
            relative(indirect_error - noise), relative(missing), mean_relit / mean - 1.0);
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_bounces", "Bounces of light: cost, and error against paths");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--tolerance", settings.tolerance);
    program.add("--albedo", settings.albedo);
    program.add("--paths", settings.paths);
    program.add("--samples", settings.samples, "receivers that are traced");
    program.add("--face-resolution", settings.resolution, "R");
    program.add("--environments", settings.probes);
    return program.run(argc, argv, [&] {
        if (program.is_tiny()) {
            settings.paths = 64;
            settings.samples = 10;
            settings.probes.resize(1);
        }
        run(settings, inputs);
    });
}
