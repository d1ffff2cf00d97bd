// What the derivative by the environment costs beside a relight. See `./dev bench adjoint --help`.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "relight/adjoint/adjoint.h"
#include "relight/harmonics/harmonics.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

double inner(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += glm::dot(glm::dvec3(a[i]), glm::dvec3(b[i]));
    return sum;
}

void measure_adjoint(const cubemap::CubeMap& environment, const char* name, LitScene& lit) {
    const auto forward = [&] {
        lit.light(environment);
    };
    forward();
    std::vector<glm::vec3> weights(lit.radiance().size());
    for (std::size_t i = 0; i < weights.size(); ++i)
        weights[i] = glm::vec3(1.0f + 0.5f * std::sin(static_cast<float>(i)));
    cubemap::CubeMap derivative;
    const auto backward = [&] {
        derivative = adjoint(lit, weights);
    };
    const double forward_seconds = bench::median_seconds(forward);
    const double backward_seconds = bench::median_seconds(backward);
    const double left = inner(lit.radiance(), weights);
    const double right = inner(environment.texels, derivative.texels);
    fmt::print("| {} | {:.2f} ms | {:.2f} ms | {:.2f} | {:.1e} |\n", name, 1e3 * forward_seconds,
               1e3 * backward_seconds, backward_seconds / forward_seconds,
               std::abs(left - right) / std::abs(left));
}

/// The same of nine coefficients, in processor time, which other programs hardly change.
void measure_harmonics(const cubemap::CubeMap& environment, const Scene& scene) {
    LitScene lit(scene, {.clusters_only = true, .harmonics = 3});
    lit.light(environment);
    std::vector<glm::vec3> weights(lit.radiance().size() * relight::MaxHarmonics);
    for (std::size_t i = 0; i < weights.size(); ++i)
        weights[i] = glm::vec3(1.0f + 0.5f * std::sin(static_cast<float>(i)));
    std::vector<double> forward, backward;
    cubemap::CubeMap derivative;
    constexpr int Passes = 5;
    for (int pass = 0; pass < Passes; ++pass) {
        forward.push_back(bench::processor_seconds_of([&] { lit.light(environment); }));
        backward.push_back(
            bench::processor_seconds_of([&] { derivative = harmonics_adjoint(lit, weights); }));
    }
    const double left = inner(lit.harmonics(), weights);
    const double right = inner(environment.texels, derivative.texels);
    fmt::print("\nnine coefficients, processor time: relight {:.1f} ms, adjoint {:.1f} ms, ratio "
               "{:.2f}; <T e, w> against <e, T* w> {:.1e}\n",
               1e3 * bench::median(forward), 1e3 * bench::median(backward),
               bench::median(backward) / bench::median(forward),
               std::abs(left - right) / std::abs(left));
}

/// So many environments at once, against one by one.
void measure_batch(const cubemap::CubeMap& environment, std::size_t count, LitScene& lit) {
    std::vector<cubemap::CubeMap> environments(count, environment);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t texel = 0; texel < environment.texels.size(); ++texel)
            environments[i].texels[texel] =
                environment.texels[(texel + 977 * i) % environment.texels.size()];
    std::vector<glm::vec3> radiance(count * lit.scene().receivers.size());
    const double single = bench::processor_seconds_of([&] {
        for (std::size_t i = 0; i < count; ++i) {
            lit.light(environments[i]);
            std::copy(lit.radiance().begin(), lit.radiance().end(),
                      radiance.begin() + static_cast<std::ptrdiff_t>(i * lit.radiance().size()));
        }
    });
    const double batch =
        bench::processor_seconds_of([&] { relight_batch(lit, environments, radiance); });
    fmt::print(
        "\n{} environments at R = {}: {:.0f} ms of processors one by one, {:.0f} ms at once, "
        "ratio {:.2f}\n",
        count, environment.resolution, 1e3 * single, 1e3 * batch, batch / single);
}

} // namespace

int main(int argc, char** argv) {
    std::uint32_t resolution = 256;
    bench::Program program(
        "bench_adjoint",
        "the derivative by the environment, and many environments, against a relight; "
        "Markdown on stdout");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--face-resolution", resolution, "R");
    return program.run(argc, argv, [&] {
        const Scene scene = inputs.bunny();
        fmt::print("{} receivers, {} clusters, R = {}.\n\n"
                   "| light | relight | adjoint | ratio | <T e, w> against <e, T* w> |\n"
                   "|---|---|---|---|---|\n",
                   scene.receivers.size(), scene.transfer.num_clusters(), resolution);
        for (const bool clusters_only : {true, false}) {
            LitScene lit(scene, {.clusters_only = clusters_only});
            for (const char* file : {"beach", "grace", "stpeters"})
                measure_adjoint(
                    inputs.environment(fmt::format("{}_cross.hdr", file), resolution),
                    fmt::format("{}{}", file, clusters_only ? "" : ", sharp lights traced").c_str(),
                    lit);
        }
        measure_harmonics(inputs.environment("beach_cross.hdr", resolution), scene);
        LitScene lit(scene, {.clusters_only = true});
        const cubemap::CubeMap beach = inputs.environment("beach_cross.hdr", 64);
        for (int round = 0; round < 3; ++round)
            measure_batch(beach, inputs.is_tiny() ? 4 : 64, lit);
    });
}
