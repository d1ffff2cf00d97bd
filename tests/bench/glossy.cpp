// Glossy surfaces seen from one side: size, speed and error against exact integration for several
// roughnesses and environments.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/resample/resample.h"
#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/exact.h"
#include "relight/glossy_kernels.h"
#include "relight/light_pyramid.h"
#include "relight/pictures/picture.h"
#include "relight/relighter.h"
#include "tests/bench/median.h"
#include "tests/bench/memory_bandwidth.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

struct Settings {
    fs::path data = RELUMINE_DATA_DIR;
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

std::vector<Environment> environments(const Settings& settings) {
    std::vector<Environment> result;
    for (const auto& [name, file] :
         {std::pair("grace", "grace_cross.hdr"), std::pair("uffizi", "uffizi_latlong_1200.hdr")})
        result.push_back({name, cubemap::resample(cubemap::load_environment(settings.data /
                                                                            "envs/debevec" / file),
                                                  settings.resolution)});
    result.push_back({"small light", small_light(settings.resolution)});
    return result;
}

prt::Receivers seen_receivers(const Settings& settings, const mesh::TriangleMesh& mesh,
                              const prt::RayScene& rays) {
    const relight::Camera camera = relight::automatic_camera(mesh, {.width = 512, .height = 512});
    if (settings.pixels)
        return prt::pixel_receivers(mesh, rays, {.camera = camera, .width = 512, .height = 512})
            .receivers;
    prt::Receivers receivers = prt::vertex_receivers(mesh);
    prt::look_from(receivers, camera.eye);
    return receivers;
}

/// Seconds that the lobes' sums alone take, and the bytes of transfer they read: all of them, in a
/// relighting as in an edit.
std::pair<double, double> lobes_alone(const prt::Transfer& transfer, const cubemap::CubeMap& map) {
    relight::LightPyramid pyramid(transfer.glossy->deepest_level());
    pyramid.set(map, relight::LightBinning(map.resolution), {});
    std::vector<relight::GlossyLight> light(transfer.counts.num_blocks());
    const double seconds = bench::median_seconds([&] {
        tbb::parallel_for(std::size_t{0}, light.size(), [&](std::size_t block) {
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

void run(const Settings& settings) {
    mesh::TriangleMesh mesh = mesh::load(settings.data / "meshes/stanford" / settings.mesh);
    if (settings.floor != 0)
        mesh::append_floor(mesh, settings.floor);
    const prt::RayScene rays(mesh);
    const prt::BeamScene beams(mesh, rays);
    const float bias = prt::automatic_bias(mesh);
    prt::Receivers receivers = seen_receivers(settings, mesh, rays);

    prt::PrecomputeStatistics diffuse;
    prt::Transfer transfer = prt::precompute(
        receivers, beams,
        {.tolerance = settings.tolerance, .face_resolution = settings.resolution, .bias = bias},
        &diffuse);
    fmt::print(
        "{}: {} receivers, {} clusters in {:.1f} s, {:.1f} MB of counts\n\n", settings.mesh,
        receivers.size(), diffuse.num_clusters, diffuse.seconds,
        static_cast<double>(transfer.counts.counts.size() + 24 * transfer.counts.mixed.size()) *
            1e-6);

    const double bandwidth = bench::memory_bandwidth();
    fmt::print("Memory is read at {:.1f} GB/s.\n\n", 1e-9 * bandwidth);
    const std::vector<Environment> maps = environments(settings);
    const std::vector<std::uint32_t> sample =
        relight::random_receivers(transfer, settings.num_samples, 1);
    fmt::print("| roughness | cells per block | MB | precompute | rays | relight | frame under "
               "grace | lobes "
               "alone |");
    for (const Environment& environment : maps)
        fmt::print(" {} |", environment.name);
    fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const float roughness : settings.roughness) {
        receivers.surfaces.assign(receivers.size(), {.albedo = glm::vec3(0.3f),
                                                     .specular = glm::vec3(0.5f),
                                                     .highlight = prt::Highlight::Ggx,
                                                     .shape = roughness});
        prt::GlossyStatistics statistics;
        transfer.glossy = prt::precompute_glossy(receivers, rays, transfer,
                                                 {.tolerance = settings.glossy_tolerance,
                                                  .face_resolution = settings.resolution,
                                                  .bias = bias},
                                                 &statistics);
        prt::set_surfaces(transfer, receivers);
        relight::Relighter relighter(transfer, {.blockers = &rays,
                                                .positions = receivers.positions,
                                                .bias = bias,
                                                .tolerance = settings.tolerance});
        std::vector<double> seconds;
        std::vector<double>
            seconds_frame; // all of it: binning, tracing of sharp lights, relighting
        std::string errors;
        for (const Environment& environment : maps) {
            for (int i = 0; i < 3; ++i) {
                const relight::RelightTimes times = relighter.set_environment(environment.map);
                seconds.push_back(times.seconds_relight);
                if (&environment == &maps.front())
                    seconds_frame.push_back(times.seconds_bin + times.seconds_trace +
                                            times.seconds_relight);
            }
            const std::vector<glm::dvec3> exact =
                relight::exact_radiance(receivers, sample, rays, environment.map, {.bias = bias});
            errors += fmt::format(
                " {:.4f} |", relight::compare(sample, exact, relighter.radiance()).relative_l2);
        }
        const auto [lobe_seconds, lobe_bytes] = lobes_alone(transfer, maps.front().map);
        fmt::print("| {} | {:.0f} + {:.0f} + {:.0f} | {:.0f} | {:.1f} s | {:.0f} M | {:.1f} ms | "
                   "{:.1f} ms | "
                   "{:.1f} ms, {:.1f} GB/s ({:.2f}) |{}\n",
                   roughness,
                   static_cast<double>(transfer.glossy->lobes[0].num_entries()) /
                       static_cast<double>(transfer.counts.num_blocks()),
                   static_cast<double>(transfer.glossy->lobes[1].num_entries()) /
                       static_cast<double>(transfer.counts.num_blocks()),
                   static_cast<double>(transfer.glossy->lobes[2].num_entries()) /
                       static_cast<double>(transfer.counts.num_blocks()),
                   static_cast<double>(transfer.glossy->num_bytes()) * 1e-6, statistics.seconds,
                   static_cast<double>(statistics.num_rays) * 1e-6, 1e3 * bench::median(seconds),
                   1e3 * bench::median(seconds_frame), 1e3 * lobe_seconds,
                   1e-9 * lobe_bytes / lobe_seconds, lobe_bytes / lobe_seconds / bandwidth, errors);
        std::fflush(stdout);
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App program{"Measures glossy relighting of a mesh seen by the automatic camera: cells and "
                     "bytes, seconds, relative L2 error"};
    program.add_option("--data", settings.data, "folder with meshes/stanford and envs/debevec")
        ->capture_default_str();
    program.add_option("--mesh", settings.mesh, "file of meshes/stanford")->capture_default_str();
    program.add_option("--floor", settings.floor, "N x N vertices, 0 for none")
        ->capture_default_str();
    program.add_option("--roughness", settings.roughness, "glTF's")->capture_default_str();
    program.add_option("--tolerance", settings.tolerance, "of the diffuse part")
        ->capture_default_str();
    program.add_option("--glossy-tolerance", settings.glossy_tolerance, "of the lobes")
        ->capture_default_str();
    program.add_option("--resolution", settings.resolution, "R of the environments")
        ->capture_default_str();
    program.add_flag("--pixels", settings.pixels,
                     "512 x 512 pixels of the automatic view, in place of vertices");
    program.add_option("--samples", settings.num_samples, "receivers to verify")
        ->capture_default_str();
    CLI11_PARSE(program, argc, argv);
    try {
        run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_glossy: {}\n", error.what());
        return 1;
    }
    return 0;
}
