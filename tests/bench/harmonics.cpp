// Points in space and spherical harmonics: how right they are, and what they take.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/scenes.h"
#include "prt/receivers/point_receivers.h"
#include "relight/harmonics/harmonics.h"
#include "relight/reference/exact.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"
#include "tests/relight/harmonics/exact_harmonics.h"

using namespace relumine;

namespace {

struct Settings {
    std::uint32_t num_points = 2000;
    std::uint32_t resolution = 256;
    Grid grid{16, 8, 16};
    /// Of exact integration.
    std::uint32_t exact_resolution = 128;
    int passes = 9;
    /// Of points.
    std::vector<float> tolerances = {ToleranceOfPoints};
    std::vector<std::string> parts = {"grid", "relight", "normals", "points"};
};

double relative_l2(std::span<const glm::dvec3> values, std::span<const glm::dvec3> exact) {
    double error = 0.0, all = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        error += glm::dot(values[i] - exact[i], values[i] - exact[i]);
        all += glm::dot(exact[i], exact[i]);
    }
    return std::sqrt(error / all);
}

/// Points anywhere in the mesh's box that are not inside of anything.
std::vector<glm::vec3> random_points(const mesh::TriangleMesh& mesh, std::size_t count) {
    const mesh::Bounds box = mesh::bounds(mesh);
    const prt::RayScene rays(mesh);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> part(0.02f, 0.98f);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& point : points)
        point = box.min + box.size() * glm::vec3(part(random), part(random), part(random));
    const prt::Receivers receivers = prt::point_receivers(points, mesh, rays);
    return receivers.positions;
}

/// How right the coefficients of points are, by tolerance.
void measure_points(const Settings& settings, const bench::Inputs& inputs,
                    const mesh::TriangleMesh& colonnade) {
    const std::vector<glm::vec3> points = random_points(colonnade, settings.num_points);
    const prt::RayScene rays(colonnade);
    const prt::Receivers receivers = prt::point_receivers(points, colonnade, rays);
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    std::vector<bench::NamedMap> maps = inputs.probes_and_sky(settings.exact_resolution);
    std::vector<std::vector<glm::dvec3>> exact;
    for (const bench::NamedMap& map : maps)
        exact.push_back(relight::exact_harmonics(receivers, all, rays, map.map, 3, 0.0f));
    fmt::print("\n{} points in the colonnade, coefficients against exact integration, relative "
               "L2\n\n| tolerance | clusters | precompute, s |",
               points.size());
    for (const bench::NamedMap& map : maps)
        fmt::print(" {} |", map.name);
    fmt::print("\n|{}\n", fmt::join(std::vector<std::string>(maps.size() + 3, "---|"), ""));
    for (const float tolerance : settings.tolerances) {
        PrecomputeReport report;
        LitScene lit(precompute(Mesh(colonnade),
                                {.tolerance = tolerance, .receivers = Points{.positions = points}},
                                {}, &report),
                     {.harmonics = 3});
        fmt::print("| {} | {} | {:.2f} |", lit.scene().settings.tolerance,
                   report.clusters.num_clusters, report.clusters.seconds);
        for (std::size_t i = 0; i < maps.size(); ++i) {
            lit.light(Light(cubemap::CubeMap(maps[i].map)));
            const std::vector<glm::vec3> light = lit.harmonics();
            fmt::print(" {:.5f} |",
                       relative_l2(std::vector<glm::dvec3>(light.begin(), light.end()), exact[i]));
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
}

/// Irradiance of normals that are turned by 30 degrees, and of the surfaces' own.
void measure_normals(const Settings& settings, const bench::Inputs& inputs, const Scene& bunny) {
    LitScene lit(bunny, {.harmonics = 3});
    std::vector<std::uint32_t> chosen =
        relight::random_receivers(bunny.transfer, settings.num_points, 5);
    constexpr float Angle = std::numbers::pi_v<float> / 6.0f;
    // Vertices of no triangle have no normal that could be turned.
    std::erase_if(chosen,
                  [&](std::uint32_t i) { return bunny.receivers.normals[i] == glm::vec3(0.0f); });
    std::vector<glm::vec3> normals;
    std::mt19937 random(2);
    std::uniform_real_distribution<float> around(0.0f, 2.0f * std::numbers::pi_v<float>);
    for (const std::uint32_t i : chosen) {
        const glm::vec3& n = bunny.receivers.normals[i];
        const glm::vec3 u = glm::normalize(
            glm::cross(n, std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
        const float angle = around(random);
        const glm::vec3 side = std::cos(angle) * u + std::sin(angle) * glm::cross(n, u);
        normals.push_back(std::cos(Angle) * n + std::sin(Angle) * side);
    }
    fmt::print("\n| light | irradiance of normals 30 degrees off, bunny, relative L2 | of nine "
               "exact coefficients | largest error at the own normal |\n|---|---|---|---|\n");
    std::vector<double> errors;
    for (bench::NamedMap& environment : inputs.probes_and_sky(settings.exact_resolution)) {
        const std::vector<glm::dvec3> exact =
            relight::exact_irradiance(bunny.receivers, chosen, normals, lit.rays().of_mesh(),
                                      environment.map, bunny.settings.bias);
        const std::vector<glm::dvec3> nine = relight::exact_harmonics(
            bunny.receivers, chosen, lit.rays().of_mesh(), environment.map, 3, bunny.settings.bias);
        const std::vector<glm::vec3> exact_light(nine.begin(), nine.end());
        lit.light(std::move(environment.map));
        const std::vector<glm::vec3> light = lit.harmonics();
        std::vector<glm::dvec3> turned, turned_exact;
        double largest = 0.0;
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            const auto own = std::span(light).subspan(std::size_t{9} * chosen[i], 9);
            turned.push_back(relight::irradiance(own, normals[i]));
            turned_exact.push_back(relight::irradiance(
                std::span(exact_light).subspan(std::size_t{9} * i, 9), normals[i]));
            const glm::dvec3 at_normal =
                relight::irradiance(own, bunny.receivers.normals[chosen[i]]) / std::numbers::pi;
            const glm::dvec3 radiance(lit.radiance()[chosen[i]]);
            for (int channel = 0; channel < 3; ++channel)
                largest = std::max(largest, std::abs(at_normal[channel] - radiance[channel]) /
                                                std::max(radiance[channel], 1e-3));
        }
        errors.push_back(relative_l2(turned, exact));
        fmt::print("| {} | {:.4f} | {:.4f} | {:.1e} |\n", environment.name, errors.back(),
                   relative_l2(turned_exact, exact), largest);
        std::fflush(stdout);
    }
    fmt::print("median {:.4f}\n", bench::median(errors));
}

/// What nine coefficients cost beside radiance.
void measure_relight(const Settings& settings, const bench::Inputs& inputs, const Scene& bunny) {
    const cubemap::CubeMap map = inputs.environment("grace_cross.hdr", settings.resolution);
    std::vector<double> alone, with, alone_sums, with_sums;
    relight::Relighter radiance(bunny.transfer), both(bunny.transfer, {}, 3);
    for (int pass = 0; pass < settings.passes; ++pass) {
        const relight::UpdateReport a = radiance.set_environment(map),
                                    b = both.set_environment(map);
        alone.push_back(1e3 * a.seconds);
        with.push_back(1e3 * b.seconds);
        alone_sums.push_back(1e3 * a.seconds_relight);
        with_sums.push_back(1e3 * b.seconds_relight);
    }
    fmt::print("\nbunny, R = {}: radiance alone {:.1f} ms (sums {:.1f}), with 9 coefficients "
               "{:.1f} (sums {:.1f}): {:.2f} times (sums {:.2f})\n",
               settings.resolution, bench::median(alone), bench::median(alone_sums),
               bench::median(with), bench::median(with_sums),
               bench::median(with) / bench::median(alone),
               bench::median(with_sums) / bench::median(alone_sums));
}

/// A grid of probes: what the precompute, a relight and an edit take.
void measure_grid(const Settings& settings, const bench::Inputs& inputs,
                  const mesh::TriangleMesh& colonnade) {
    PrecomputeReport report;
    const bench::Stopwatch watch;
    Scene scene = precompute(Mesh(colonnade), {.receivers = settings.grid}, {}, &report);
    const double seconds = watch.seconds();
    LitScene lit(std::move(scene), {.harmonics = 3});
    const cubemap::CubeMap map = inputs.environment("grace_cross.hdr", settings.resolution);
    std::vector<double> relight, sums, edit;
    for (int pass = 0; pass < settings.passes; ++pass) {
        const UpdateReport times = lit.light(Light(cubemap::CubeMap(map)));
        relight.push_back(1e3 * times.seconds);
        sums.push_back(1e3 * times.seconds_relight);
    }
    lit.environment().edit(lit.environment().state());
    for (int pass = 0; pass < settings.passes; ++pass) {
        const UpdateReport times =
            set_layers(lit, {bench::disc({1.0, 1.0 + 0.01 * pass, 0.3}, 0.05, 2.0 + 0.1 * pass)});
        edit.push_back(1e3 * times.seconds);
    }
    fmt::print("\ngrid {} x {} x {} in the colonnade: precompute {:.2f} s ({} clusters, {:.0f} M "
               "rays), {} points inside\nR = {}: relight {:.2f} ms (sums {:.2f}), edit of a disc "
               "{:.3f} ms\n",
               settings.grid.nx, settings.grid.ny, settings.grid.nz, seconds,
               report.clusters.num_clusters, 1e-6 * static_cast<double>(report.clusters.num_rays),
               prt::num_inside(lit.scene().receivers), settings.resolution, bench::median(relight),
               bench::median(sums), bench::median(edit));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("harmonics", "points in space and spherical harmonics");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--points", settings.num_points, "points that are integrated exactly");
    program.add("--resolution", settings.resolution, "R of what is timed");
    program.add("--exact-resolution", settings.exact_resolution, "R of what is integrated exactly");
    program.add("--passes", settings.passes);
    program.add("--tolerances", settings.tolerances, "of points");
    program.add("--parts", settings.parts);
    return program.run(argc, argv, [&] {
        if (program.is_tiny())
            settings = {.num_points = 20,
                        .resolution = 16,
                        .grid = {2, 2, 2},
                        .exact_resolution = 16,
                        .passes = 2,
                        .tolerances = {0.1f}};
        const auto is_asked = [&](const char* part) {
            return std::find(settings.parts.begin(), settings.parts.end(), part) !=
                   settings.parts.end();
        };
        const mesh::TriangleMesh colonnade =
            data_gen::colonnade(program.is_tiny() ? 2000 : 100'000);
        if (is_asked("grid"))
            measure_grid(settings, inputs, colonnade);
        if (is_asked("relight") || is_asked("normals")) {
            const Scene bunny = inputs.bunny();
            if (is_asked("relight"))
                measure_relight(settings, inputs, bunny);
            if (is_asked("normals"))
                measure_normals(settings, inputs, bunny);
        }
        if (is_asked("points"))
            measure_points(settings, inputs, colonnade);
    });
}
