// What refinement gains: the error between the vertices of meshes that are refined evenly, by
// light, and for a sun, at equal numbers of vertices. See docs/meshes.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/resample/resample.h"
#include "cubemap/split_mix64.h"
#include "data_gen/daylight.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "mesh/floor.h"
#include "mesh/normals.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/ray_scene.h"
#include "relight/reference/exact.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/process_usage.h"

using namespace relumine;

namespace {

struct Settings {
    std::size_t num_points = 3000;
    /// Empty: all
    std::string only;
    bool growth = false, cost = false;
    /// Of the meshes that show the growth.
    std::size_t largest = 500'000;
};

/// Maps whose light adds up.
struct Light {
    const char* name;
    std::vector<cubemap::CubeMap> maps;
};

const data_gen::DaylightOptions Day{.ground_albedo = {0.24, 0.20, 0.15}, .scale = 1.0 / 20.0};

/// The sky in few texels and the sun in many: a ray for each texel that is not black.
Light sun_and_sky(std::uint32_t sun_resolution) {
    const data_gen::Daylight daylight(Day);
    constexpr std::uint32_t SkyResolution = 16;
    cubemap::CubeMap sky(SkyResolution);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < SkyResolution; ++y)
            for (std::uint32_t x = 0; x < SkyResolution; ++x) {
                const glm::dvec3 w = cubemap::texel_direction(face, x, y, SkyResolution);
                sky.at(face, x, y) =
                    glm::vec3(w.y >= 0.0 ? daylight.sky(w) : glm::dvec3(daylight.ground()));
            }
    return {"sun and sky",
            {std::move(sky), data_gen::disc_light(sun_resolution, daylight.sun_direction(),
                                                  data_gen::Daylight::SunRadiusDegrees,
                                                  glm::vec3(daylight.sun()))}};
}

std::vector<glm::dvec3> radiance(const prt::Receivers& receivers, const prt::Blockers& blockers,
                                 const Light& light, float bias) {
    std::vector<std::uint32_t> all(receivers.size());
    std::iota(all.begin(), all.end(), 0u);
    std::vector<glm::dvec3> sum(all.size(), glm::dvec3(0.0));
    for (const cubemap::CubeMap& map : light.maps) {
        const auto part = relight::exact_radiance(receivers, all, blockers, map, {.bias = bias});
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += part[i];
    }
    return sum;
}

/// Points of a surface, each with its part of the area.
struct WeighedPoints {
    std::vector<prt::MeshPoint> points;
    std::vector<double> weights;
};

/// Most points lie where the vertices of a triangle differ: there the error is. Their weights make
/// up for it.
WeighedPoints weighed_points(const mesh::TriangleMesh& mesh, std::size_t count,
                             std::span<const std::vector<glm::dvec3>> at_vertices) {
    constexpr double Even = 0.1;
    std::vector<double> areas, masses;
    for (const auto& [a, b, c] : mesh.triangles) {
        const glm::dvec3 origin(mesh.positions[a]);
        areas.push_back(glm::length(glm::cross(glm::dvec3(mesh.positions[b]) - origin,
                                               glm::dvec3(mesh.positions[c]) - origin)));
    }
    masses.assign(areas.size(), Even);
    for (const std::vector<glm::dvec3>& values : at_vertices) {
        double mean = 0.0;
        for (const glm::dvec3& value : values)
            mean += value.y / static_cast<double>(values.size());
        for (std::size_t i = 0; i < areas.size(); ++i) {
            const auto& [a, b, c] = mesh.triangles[i];
            const auto [low, high] = std::minmax({values[a].y, values[b].y, values[c].y});
            masses[i] += (high - low) / mean;
        }
    }
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    double mass = 0.0;
    for (std::size_t i = 0; i < areas.size(); ++i)
        mass += masses[i] *= areas[i];
    WeighedPoints result;
    cubemap::SplitMix64 random(1);
    const auto uniform = [&random] {
        return cubemap::unit_interval(random.next());
    };
    const double step = mass / static_cast<double>(count);
    double end = 0.0, next = 0.5 * step;
    for (std::size_t i = 0; i < areas.size(); ++i) {
        end += masses[i];
        for (; next < end; next += step) {
            const double root = std::sqrt(uniform()), part = uniform();
            result.points.push_back(
                {static_cast<std::uint32_t>(i),
                 {static_cast<float>(root * (1.0 - part)), static_cast<float>(root * part)}});
            result.weights.push_back(areas[i] / area * step / masses[i]);
        }
    }
    return result;
}

/// Relative L2 of interpolated against exact light over the surface, for each light.
std::vector<double> errors(const Mesh& mesh, std::span<const Light> lights,
                           std::size_t num_points) {
    const mesh::TriangleMesh& surface = mesh.geometry;
    const mesh::TriangleMesh& blockers = mesh.blockers ? *mesh.blockers : surface;
    const prt::RayScene rays(blockers);
    const float bias = prt::automatic_bias(blockers);
    const prt::Receivers vertices = prt::vertex_receivers(surface);
    std::vector<std::vector<glm::dvec3>> at_vertices;
    for (const Light& light : lights)
        at_vertices.push_back(radiance(vertices, rays, light, bias));
    const WeighedPoints found = weighed_points(surface, num_points, at_vertices);
    prt::Receivers receivers;
    for (const prt::MeshPoint& point : found.points) {
        receivers.positions.push_back(prt::smooth_position(surface, point));
        receivers.normals.push_back(prt::shading_normal(surface, point));
    }
    std::vector<double> result;
    for (std::size_t k = 0; k < lights.size(); ++k) {
        const std::vector<glm::dvec3> exact = radiance(receivers, rays, lights[k], bias);
        const std::vector<glm::vec3> values(at_vertices[k].begin(), at_vertices[k].end());
        double squares = 0.0, all = 0.0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            const glm::dvec3 error =
                glm::dvec3(prt::value_at(surface, values, found.points[i])) - exact[i];
            squares += found.weights[i] * glm::dot(error, error);
            all += found.weights[i] * glm::dot(exact[i], exact[i]);
        }
        result.push_back(std::sqrt(squares / all));
    }
    return result;
}

/// A box of 2 x 2 x 2 on a floor of two triangles.
Mesh box_on_floor() {
    mesh::TriangleMesh box;
    box.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1},
                     {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
    box.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 7, 6}, {4, 6, 5}, {0, 4, 5}, {0, 5, 1},
                     {1, 5, 6}, {1, 6, 2}, {2, 6, 7}, {2, 7, 3}, {3, 7, 4}, {3, 4, 0}};
    constexpr float Crease = 40.0f;
    box = mesh::with_creases(box, Crease);
    mesh::append_floor(box, 2);
    Mesh result(std::move(box));
    result.floor_vertices = 2;
    return result;
}

struct Row {
    const char* name;
    /// Of meshes/stanford, on two triangles. Empty: generated
    const char* file;
    std::size_t num_vertices;
};
constexpr std::array<Row, 6> Rows = {{{"box", "", 2000},
                                      {"colonnade, coarse", "", 5000},
                                      {"colonnade", "", 10000},
                                      {"bunny, res3", "bun_zipper_res3.ply", 6000},
                                      {"dragon, res4", "dragon_vrip_res4.ply", 12000},
                                      {"buddha, res4", "happy_vrip_res4.ply", 15000}}};

Mesh mesh_of(const Row& row, const bench::Inputs& inputs) {
    if (row.file[0] != '\0')
        return inputs.mesh(row.file, 2);
    if (row.name == Rows[0].name)
        return box_on_floor();
    constexpr std::size_t Coarse = 1000, Fine = 5000;
    return data_gen::colonnade(row.name == Rows[1].name ? Coarse : Fine);
}

std::size_t limit(const Row& row, const bench::Inputs& inputs) {
    return inputs.is_tiny() ? 200 : row.num_vertices;
}

enum class Way { Before, Even, Refined, ForSun };

Mesh made(Mesh mesh, Way way, std::size_t num_vertices) {
    RefineOptions options{.error = 0.0f, .max_vertices = num_vertices};
    if (way == Way::Before)
        return mesh;
    if (way == Way::Even) {
        options.error.reset();
        options.max_edge = 1e-6f;
    }
    if (way == Way::ForSun)
        options.light = data_gen::sun_and_sky(256, Day);
    return refined(std::move(mesh), options);
}

void print_errors(const Settings& settings, const bench::Inputs& inputs) {
    const std::vector<Light> lights = {
        sun_and_sky(inputs.is_tiny() ? 128 : 1024),
        {"grace", {cubemap::resample(inputs.environment("grace_cross.hdr", 0), 24)}},
        {"soft boxes", {data_gen::two_soft_boxes(20)}}};
    fmt::print("| scene | vertices |");
    for (const Light& light : lights)
        fmt::print(" {} |", light.name);
    fmt::print("\n|---|---|---|---|---|\n");
    for (const Row& row : Rows) {
        if (!settings.only.empty() && settings.only != row.name)
            continue;
        std::vector<double> even;
        for (const auto& [way, name] : {std::pair(Way::Before, "before"),
                                        {Way::Even, "uniform"},
                                        {Way::Refined, "refined"},
                                        {Way::ForSun, "refined for the sun"}}) {
            const Mesh mesh = made(mesh_of(row, inputs), way, limit(row, inputs));
            const std::vector<double> found = errors(mesh, lights, settings.num_points);
            if (way == Way::Even)
                even = found;
            fmt::print("| {}, {} | {} |", row.name, name, mesh.geometry.num_vertices());
            for (std::size_t i = 0; i < found.size(); ++i)
                fmt::print(" {:.4f}{} |", found[i],
                           way == Way::Refined || way == Way::ForSun
                               ? fmt::format(" ({:.2f})", found[i] / even[i])
                               : "");
            fmt::print("\n");
            std::fflush(stdout);
        }
        if (inputs.is_tiny())
            break;
    }
}

/// The refined precompute against a precompute of its final mesh.
void print_cost(const bench::Inputs& inputs) {
    fmt::print("| scene | vertices | refinement | precompute after it | of the final mesh alone | "
               "ratio |\n|---|---|---|---|---|---|\n");
    for (const Row& row : Rows) {
        double start = bench::cpu_seconds();
        Mesh mesh = made(mesh_of(row, inputs), Way::Refined, limit(row, inputs));
        const double refinement = bench::cpu_seconds() - start;
        Mesh alone = mesh;
        alone.blockers.reset();
        const std::size_t num_vertices = mesh.geometry.num_vertices();
        const auto seconds = [&](Mesh of) {
            start = bench::cpu_seconds();
            static_cast<void>(
                precompute(std::move(of), {.tolerance = inputs.is_tiny() ? 0.1f : 0.0135f}));
            return bench::cpu_seconds() - start;
        };
        const double after = seconds(std::move(mesh)), of_final = seconds(std::move(alone));
        fmt::print("| {} | {} | {:.1f} s | {:.1f} s | {:.1f} s | {:.2f} |\n", row.name,
                   num_vertices, refinement, after, of_final, (refinement + after) / of_final);
        std::fflush(stdout);
        if (inputs.is_tiny())
            break;
    }
}

/// To twice the vertices, at several sizes.
void print_growth(const Settings& settings, const bench::Inputs& inputs) {
    fmt::print("| vertices | refined to | traced points | processor time | per n log n |\n"
               "|---|---|---|---|---|\n");
    constexpr std::size_t Smallest = 62'500;
    for (std::size_t size = Smallest; size <= settings.largest; size *= 2) {
        const std::size_t n = inputs.is_tiny() ? 1000 : size;
        Mesh mesh(data_gen::knot(n));
        RefineReport report;
        const double start = bench::cpu_seconds();
        const std::size_t most = 2 * mesh.geometry.num_vertices();
        const std::size_t before = mesh.geometry.num_vertices();
        mesh = refined(std::move(mesh), {.error = 0.0f, .min_edge = 0.0f, .max_vertices = most}, {},
                       &report);
        const double seconds = bench::cpu_seconds() - start;
        const auto after = static_cast<double>(mesh.geometry.num_vertices());
        fmt::print("| {} | {} | {} | {:.1f} s | {:.2f} us |\n", before,
                   mesh.geometry.num_vertices(), report.num_points, seconds,
                   1e6 * seconds / (after * std::log2(after)));
        std::fflush(stdout);
        if (inputs.is_tiny())
            break;
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_refinement",
                           "errors between the vertices: uniform against refined meshes");
    bench::Inputs inputs(program);
    program.add("--points", settings.num_points,
                "of the surface, most of them where light changes");
    program.add("--only", settings.only, "one scene");
    program.add_flag("--cost", settings.cost,
                     "processor time against a precompute of the final mesh instead");
    program.add_flag(
        "--growth", settings.growth,
        "processor time of refining a knot to twice its vertices, at several sizes, instead");
    program.add("--largest", settings.largest, "vertices of the largest knot of --growth");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny())
            settings.num_points = 100;
        if (settings.cost || inputs.is_tiny())
            print_cost(inputs);
        if (settings.growth || inputs.is_tiny())
            print_growth(settings, inputs);
        if (!settings.cost && !settings.growth)
            print_errors(settings, inputs);
    });
}
