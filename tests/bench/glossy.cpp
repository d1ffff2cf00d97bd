// Glossy surfaces seen from one side: size, speed and error against exact integration for several
// roughnesses and environments.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/kernels/glossy_kernels.h"
#include "relight/light_pyramid.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/memory_bandwidth.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

struct Settings {
    std::string mesh = "dragon_vrip_res2.ply";
    std::uint32_t floor = 193;
    std::vector<float> roughness = {0.1f, 0.3f, 0.6f};
    float tolerance = prt::PrecomputeOptions{}.tolerance;
    float glossy_tolerance = prt::GlossyOptions{}.tolerance;
    std::uint32_t resolution = 256;
    std::size_t num_samples = 500;
    /// Of a view of 512 x 512, in place of vertices
    bool pixels = false;
};

struct Environment {
    std::string name;
    cubemap::CubeMap map;
};

/// Black but for a disc of two degrees.
cubemap::CubeMap small_light(std::uint32_t resolution) {
    cubemap::CubeMap map(resolution);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(0.4, 0.6, 0.7));
    const double min_cosine = std::cos(std::numbers::pi / 180.0);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                if (glm::dot(cubemap::texel_direction(face, x, y, resolution), axis) >= min_cosine)
                    map.at(face, x, y) = glm::vec3(1000.0f, 900.0f, 700.0f);
    return map;
}

std::vector<Environment> environments(const Settings& settings, const bench::Inputs& inputs) {
    std::vector<Environment> result;
    for (const auto& [name, file] :
         {std::pair("grace", "grace_cross.hdr"), std::pair("uffizi", "uffizi_latlong_1200.hdr")})
        result.push_back({name, inputs.environment(file, settings.resolution)});
    result.push_back({"small light", small_light(settings.resolution)});
    return result;
}

/// Seconds that the lobes' sums alone take, and the bytes of transfer they read: all of them, in a
/// relighting as in an edit.
std::pair<double, double> lobes_alone(const prt::Transfer& transfer, const cubemap::CubeMap& map) {
    relight::LightPyramid pyramid(transfer.glossy->deepest_level());
    pyramid.set(map, relight::LightBinning(map.resolution), {});
    std::vector<relight::GlossyLight> light(transfer.counts.num_blocks());
    const double seconds = bench::median_seconds([&] {
        files::parallel_for(std::size_t{0}, light.size(), [&](std::size_t block) {
            for (std::size_t lobe = 0; lobe < prt::NumGlossyLobes; ++lobe)
                relight::light_block(transfer.glossy->lobes[lobe], block, pyramid.light(),
                                     light[block][lobe]);
        });
    });
    constexpr std::size_t BytesPerEntry = prt::BlockSize + sizeof(std::uint32_t) + sizeof(float);
    std::size_t num_entries = 0;
    for (const prt::LobeCuts& cuts : transfer.glossy->lobes)
        num_entries += cuts.num_entries();
    return {seconds, static_cast<double>(num_entries * BytesPerEntry)};
}

Scene shiny_scene(const Mesh& mesh, const Settings& settings, float roughness,
                  PrecomputeReport& report) {
    PrecomputeOptions options{.tolerance = settings.tolerance,
                              .face_resolution = settings.resolution,
                              .view = View{relight::framed(mesh.geometry, {.aspect = 1.0f})},
                              .surface = everywhere({.albedo = glm::vec3(0.3f),
                                                     .specular = glm::vec3(0.5f),
                                                     .highlight = prt::Highlight::Ggx,
                                                     .roughness_or_exponent = roughness}),
                              .glossy_tolerance = settings.glossy_tolerance};
    if (settings.pixels)
        options.receivers = Pixels{.width = 512, .height = 512};
    return precompute(mesh, options, {}, &report);
}

void print_row(float roughness, const Settings& settings, const Mesh& mesh,
               const std::vector<Environment>& maps, double bandwidth) {
    PrecomputeReport report;
    LitScene lit(shiny_scene(mesh, settings, roughness, report));
    const prt::Transfer& transfer = lit.scene().transfer;
    std::vector<double> seconds;
    // All of a frame: binning, tracing of sharp lights, relighting.
    std::vector<double> seconds_frame;
    std::string errors;
    for (const Environment& environment : maps) {
        for (int i = 0; i < 3; ++i) {
            const UpdateReport times = lit.light(environment.map);
            seconds.push_back(times.seconds_relight);
            if (&environment == &maps.front())
                seconds_frame.push_back(times.seconds_bin + times.seconds_trace +
                                        times.seconds_relight);
        }
        const Verification check = verify(
            lit, {.num_samples = settings.num_samples, .num_surface_points = settings.num_samples});
        errors += fmt::format(
            " {:.4f}{} |", check.error.relative_l2,
            check.surface ? fmt::format(", {:.4f}", check.surface->error.relative_l2) : "");
    }
    const auto [lobe_seconds, lobe_bytes] = lobes_alone(transfer, maps.front().map);
    const auto per_block = [&](std::size_t lobe) {
        return static_cast<double>(transfer.glossy->lobes[lobe].num_entries()) /
               static_cast<double>(transfer.counts.num_blocks());
    };
    fmt::print(
        "| {} | {} | {} | {:.1f} s, {:.1f} MB | {:.0f} + {:.0f} + {:.0f} | {:.0f} | "
        "{:.1f} s | {:.0f} M | {:.1f} ms | {:.1f} ms | {:.1f} ms, {:.1f} GB/s ({:.2f}) |{}\n",
        roughness, report.num_receivers, report.clusters.num_clusters, report.clusters.seconds,
        static_cast<double>(transfer.counts.counts.size() + 24 * transfer.counts.mixed.size()) *
            1e-6,
        per_block(0), per_block(1), per_block(2),
        static_cast<double>(transfer.glossy->num_bytes()) * 1e-6, report.highlights->seconds,
        static_cast<double>(report.highlights->num_rays) * 1e-6, 1e3 * bench::median(seconds),
        1e3 * bench::median(seconds_frame), 1e3 * lobe_seconds, 1e-9 * lobe_bytes / lobe_seconds,
        lobe_bytes / lobe_seconds / bandwidth, errors);
    std::fflush(stdout);
}

void run(const Settings& settings, const bench::Inputs& inputs) {
    const Mesh mesh = inputs.mesh(settings.mesh, settings.floor);
    const double bandwidth = bench::memory_bandwidth(inputs.is_tiny());
    fmt::print("{}. Memory is read at {:.1f} GB/s.{}\n\n", settings.mesh, 1e-9 * bandwidth,
               settings.pixels ? "" : " Errors: at vertices, of diffuse light between them.");
    const std::vector<Environment> maps = environments(settings, inputs);
    fmt::print("| roughness | receivers | clusters | diffuse part | cells per block | MB | "
               "highlights | rays | relight | frame under grace | lobes alone |");
    for (const Environment& environment : maps)
        fmt::print(" {} |", environment.name);
    fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const float roughness : settings.roughness)
        print_row(roughness, settings, mesh, maps, bandwidth);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_glossy",
                           "glossy relighting of a mesh seen by the automatic camera: cells and "
                           "bytes, seconds, relative L2 error");
    bench::Inputs inputs(program);
    program.add("--mesh", settings.mesh, "file of meshes/stanford");
    program.add("--floor", settings.floor, "N x N vertices, 0 for none");
    program.add("--roughness", settings.roughness, "glTF's");
    program.add("--tolerance", settings.tolerance, "of the diffuse part");
    program.add("--glossy-tolerance", settings.glossy_tolerance, "of the lobes");
    program.add("--resolution", settings.resolution, "R of the environments");
    program.add_flag("--pixels", settings.pixels,
                     "512 x 512 pixels of the automatic view, in place of vertices");
    program.add("--samples", settings.num_samples, "receivers to verify");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny()) {
            settings.roughness = {0.6f};
            settings.tolerance = 0.1f;
            settings.glossy_tolerance = 0.3f;
            settings.resolution = 32;
            settings.num_samples = 10;
        }
        run(settings, inputs);
    });
}
