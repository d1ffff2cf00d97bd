// Table 1 of Johan and Nishita, "Efficient Relighting by Clustering Environment Lights", measured
// here beside the paper's row: the diffuse scenes at the paper's own epsilon and resolution, with
// the error against exact integration that the paper shows as a picture.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/resample/resample.h"
#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/exact.h"
#include "relight/pictures/picture.h"
#include "relight/relighter.h"
#include "tests/bench/median.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

constexpr float Epsilon = 5e-5f; // the paper's threshold, Section 6
constexpr std::array<const char*, 5> Crosses = {"grace", "stpeters", "galileo", "kitchen", "beach"};

/// A row of the paper's table (Pentium 4, 3.4 GHz).
struct PaperRow {
    const char* name;
    const char* mesh;
    int vertices, clusters, megabytes;
    double precompute_minutes, relight_seconds;
};
constexpr std::array<PaperRow, 2> Paper = {
    {{"Bunny", "bun_zipper.ply", 73196, 9831, 405, 50.0, 6.5},
     {"Dragon", "dragon_vrip_res2.ply", 137499, 5337, 326, 35.0, 8.0}}};
/// Specular, from a fixed view. The paper does not say what its specular BRDF was: ours is
/// Roughness below.
constexpr PaperRow PaperBuddha = {"Buddha", "happy_vrip_res3.ply", 69577, 4701, 623, 8.0, 3.5};
constexpr float Roughness = 0.3f;

struct Settings {
    fs::path data = RELUMINE_DATA_DIR;
    fs::path json = "table1.json";
    std::size_t num_samples = 1000;
    bool with_4096 = true;
    /// Empty: all rows
    std::string only;
};

prt::Scene precomputed(const fs::path& mesh, std::uint32_t face_resolution,
                       prt::PrecomputeStatistics& statistics) {
    prt::Scene scene;
    scene.mesh = mesh::load(mesh);
    mesh::append_floor(scene.mesh);
    const prt::RayScene exact_rays(scene.mesh);
    const prt::BeamScene rays(scene.mesh, exact_rays);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    scene.settings.epsilon = Epsilon;
    scene.transfer = prt::precompute(
        prt::vertex_receivers(scene.mesh), rays,
        {.epsilon = Epsilon, .face_resolution = face_resolution, .bias = scene.settings.bias},
        &statistics);
    return scene;
}

/// The experiment of Section 6: a disc added to the beach map, its intensity rising over 60 steps.
/// `radius` is a part of the map's width.
double seconds_per_edit(relight::Relighter& relighter, const glm::dvec3& axis, double radius) {
    const std::uint32_t r = relighter.environment().resolution;
    const double min_cosine =
        std::cos(radius * std::numbers::pi / 2.0); // a face is a right angle wide
    const cubemap::FacePoint centre = cubemap::face_point(axis);
    relight::TexelRectangle box{.face = centre.face, .x0 = r, .y0 = r};
    for (std::uint32_t y = 0; y < r; ++y)
        for (std::uint32_t x = 0; x < r; ++x)
            if (glm::dot(cubemap::texel_direction(centre.face, x, y, r), axis) >= min_cosine) {
                box.x0 = std::min(box.x0, x);
                box.x1 = std::max(box.x1, x + 1);
                box.y0 = std::min(box.y0, y);
                box.y1 = std::max(box.y1, y + 1);
            }
    std::vector<double> seconds;
    for (int step = 0; step < 60; ++step) {
        std::vector<glm::vec3> radiance;
        for (std::uint32_t y = box.y0; y < box.y1; ++y)
            for (std::uint32_t x = box.x0; x < box.x1; ++x) {
                const bool inside =
                    glm::dot(cubemap::texel_direction(box.face, x, y, r), axis) >= min_cosine;
                radiance.push_back(inside ? glm::vec3(0.2f * static_cast<float>(step + 1))
                                          : relighter.environment().at(box.face, x, y));
            }
        seconds.push_back(relighter.update_region(box, radiance).seconds);
    }
    return bench::median(seconds);
}

/// Size of the scene's file.
std::uint64_t saved_bytes(const prt::Scene& scene, const char* name) {
    const fs::path file = fs::temp_directory_path() / fmt::format("relumine_table1_{}.prt", name);
    const std::uint64_t bytes = prt::save_scene(file, scene);
    fs::remove(file);
    return bytes;
}

/// A scene under the crosses.
struct UnderCrosses {
    /// Five of each cross
    std::vector<relight::RelightTimes> times;
    /// Relative L2 against exact integration, by cross
    nlohmann::json errors;
    std::size_t num_samples = 0;
};

/// `resolution` of the environments, 0: their natural one.
UnderCrosses under_crosses(relight::Relighter& relighter, const prt::Receivers& receivers,
                           const prt::RayScene& rays, float bias, const Settings& settings,
                           std::uint32_t resolution = 0) {
    UnderCrosses result;
    const std::vector<std::uint32_t> sample =
        relight::random_receivers(relighter.transfer(), settings.num_samples, 1);
    result.num_samples = sample.size();
    for (const char* name : Crosses) {
        fmt::print(stderr, "exact integration under {}\n", name);
        const cubemap::EnvironmentImage image = cubemap::load_environment(
            settings.data / "envs/debevec" / fmt::format("{}_cross.hdr", name));
        const cubemap::CubeMap map = cubemap::resample(
            image, resolution != 0 ? resolution : cubemap::natural_resolution(image));
        for (int i = 0; i < 5; ++i)
            result.times.push_back(relighter.set_environment(map));
        const std::vector<glm::dvec3> exact =
            relight::exact_radiance(receivers, sample, rays, map, {.bias = bias});
        result.errors[name] = relight::compare(sample, exact, relighter.radiance()).relative_l2;
    }
    return result;
}

nlohmann::json measure(const PaperRow& paper, const Settings& settings) {
    prt::PrecomputeStatistics statistics;
    fmt::print(stderr, "{}: precompute at R = 1024\n", paper.name);
    const prt::Scene scene =
        precomputed(settings.data / "meshes/stanford" / paper.mesh, 1024, statistics);
    const std::uint64_t file_bytes = saved_bytes(scene, paper.name);

    const prt::RayScene rays(scene.mesh);
    const float rms = Epsilon * std::sqrt(static_cast<float>(scene.mesh.num_vertices()));
    const relight::ShadowRays shadow_rays{.blockers = &rays,
                                          .positions = scene.mesh.positions,
                                          .bias = scene.settings.bias,
                                          .tolerance = rms};
    relight::Relighter relighter(scene.transfer, shadow_rays);
    const UnderCrosses verified = under_crosses(relighter, prt::vertex_receivers(scene.mesh), rays,
                                                scene.settings.bias, settings);
    std::vector<double> relight_seconds;
    for (const relight::RelightTimes& times : verified.times)
        relight_seconds.push_back(times.seconds_trace + times.seconds_relight);

    // The light sources of the experiment stand in front of the model and at its side.
    const cubemap::EnvironmentImage beach =
        cubemap::load_environment(settings.data / "envs/debevec/beach_cross.hdr");
    relighter.set_environment(cubemap::resample(beach, 1024));
    const double edit_front =
        seconds_per_edit(relighter, glm::normalize(glm::dvec3(0.15, 0.35, 1.0)), 0.05);
    const double edit_side =
        seconds_per_edit(relighter, glm::normalize(glm::dvec3(1.0, 0.35, 0.15)), 0.10);

    nlohmann::json row = {{"scene", paper.name},
                          {"vertices", scene.mesh.num_vertices()},
                          {"clusters", statistics.num_clusters},
                          {"file_bytes", file_bytes},
                          {"seconds_precompute", statistics.seconds},
                          {"seconds_relight", bench::median(relight_seconds)},
                          {"seconds_edit_5_percent", edit_front},
                          {"seconds_edit_10_percent", edit_side},
                          {"samples_verified", verified.num_samples},
                          {"relative_l2", verified.errors}};
    if (settings.with_4096 && paper.name == std::string("Bunny")) { // as the paper has it
        fmt::print(stderr, "{}: precompute at R = 4096\n", paper.name);
        static_cast<void>(
            precomputed(settings.data / "meshes/stanford" / paper.mesh, 4096, statistics));
        row["clusters_4096"] = statistics.num_clusters;
    }
    return row;
}

/// The third row: the Buddha's vertices with highlights, R = 256.
nlohmann::json measure_buddha(const Settings& settings) {
    fmt::print(stderr, "Buddha: precompute at R = 256\n");
    prt::Scene scene;
    scene.mesh = mesh::load(settings.data / "meshes/stanford" / PaperBuddha.mesh);
    mesh::append_floor(scene.mesh);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    scene.settings.epsilon = Epsilon;
    scene.settings.view = relight::automatic_camera(scene.mesh);
    scene.receivers = prt::vertex_receivers(scene.mesh);
    prt::look_from(scene.receivers, scene.settings.view->eye);
    scene.receivers.surfaces.assign(scene.receivers.size(), {.albedo = glm::vec3(0.3f),
                                                             .specular = glm::vec3(0.5f),
                                                             .highlight = prt::Highlight::Ggx,
                                                             .shape = Roughness});
    const auto start = std::chrono::steady_clock::now();
    const prt::RayScene exact_rays(scene.mesh);
    const prt::BeamScene rays(scene.mesh, exact_rays);
    scene.transfer =
        prt::precompute(scene.receivers, rays,
                        {.epsilon = Epsilon, .face_resolution = 256, .bias = scene.settings.bias});
    prt::GlossyStatistics glossy;
    scene.transfer.glossy =
        prt::precompute_glossy(scene.receivers, rays, scene.transfer,
                               {.face_resolution = 256, .bias = scene.settings.bias}, &glossy);
    prt::set_surfaces(scene.transfer, scene.receivers);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::uint64_t file_bytes = saved_bytes(scene, PaperBuddha.name);

    const float rms = Epsilon * std::sqrt(static_cast<float>(scene.mesh.num_vertices()));
    relight::Relighter relighter(scene.transfer, {.blockers = &exact_rays,
                                                  .positions = scene.mesh.positions,
                                                  .bias = scene.settings.bias,
                                                  .tolerance = rms});
    const UnderCrosses verified =
        under_crosses(relighter, scene.receivers, exact_rays, scene.settings.bias, settings, 256);
    std::vector<double> relight_seconds;
    for (const relight::RelightTimes& times : verified.times)
        relight_seconds.push_back(times.seconds_relight);
    return {{"scene", PaperBuddha.name},
            {"vertices", scene.mesh.num_vertices()},
            {"clusters", scene.transfer.num_clusters()},
            {"cells_per_block", static_cast<double>(glossy.num_entries) /
                                    static_cast<double>(scene.transfer.counts.num_blocks())},
            {"file_bytes", file_bytes},
            {"seconds_precompute", seconds},
            {"seconds_glossy", glossy.seconds},
            {"seconds_relight", bench::median(relight_seconds)},
            {"samples_verified", verified.num_samples},
            {"relative_l2", verified.errors}};
}

void print_buddha(const nlohmann::json& row) {
    fmt::print("\n| specular | vertices | clusters | MB | precompute | relight "
               "|\n|---|---|---|---|---|---|\n"
               "| Buddha, paper | {} | {} | {} | {:.0f} min | {:.1f} s |\n",
               PaperBuddha.vertices, PaperBuddha.clusters, PaperBuddha.megabytes,
               PaperBuddha.precompute_minutes, PaperBuddha.relight_seconds);
    fmt::print(
        "| Buddha, Relumine | {} | {} + {:.0f} cells per block | {:.1f} | {:.1f} s ({:.1f} s of it "
        "highlights) | {:.1f} ms |\n",
        row["vertices"].get<int>(), row["clusters"].get<int>(),
        row["cells_per_block"].get<double>(), row["file_bytes"].get<double>() * 1e-6,
        row["seconds_precompute"].get<double>(), row["seconds_glossy"].get<double>(),
        1e3 * row["seconds_relight"].get<double>());
    fmt::print("\nrelative L2 error:");
    for (const char* name : Crosses)
        fmt::print(" {} {:.4f}", name, row["relative_l2"][name].get<double>());
    fmt::print("\n");
}

void print_markdown(const nlohmann::json& rows) {
    fmt::print("| | vertices | clusters | MB | precompute | relight | edit, disc 5 % / 10 % "
               "|\n|---|---|---|---|---|---|---|\n");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const nlohmann::json& row = rows[i];
        const PaperRow& paper = *std::find_if(
            Paper.begin(), Paper.end(), [&](const PaperRow& p) { return row["scene"] == p.name; });
        fmt::print("| {}, paper | {} | {} | {} | {:.0f} min | {:.1f} s | {} |\n", paper.name,
                   paper.vertices, paper.clusters, paper.megabytes, paper.precompute_minutes,
                   paper.relight_seconds, paper.name == std::string("Bunny") ? "0.06 s" : "-");
        fmt::print(
            "| {}, Relumine | {} | {} | {:.1f} | {:.1f} s | {:.1f} ms | {:.2f} / {:.2f} ms |\n",
            paper.name, row["vertices"].get<int>(), row["clusters"].get<int>(),
            row["file_bytes"].get<double>() * 1e-6, row["seconds_precompute"].get<double>(),
            1e3 * row["seconds_relight"].get<double>(),
            1e3 * row["seconds_edit_5_percent"].get<double>(),
            1e3 * row["seconds_edit_10_percent"].get<double>());
    }
    fmt::print("\n| relative L2 error |");
    for (const char* name : Crosses)
        fmt::print(" {} |", name);
    fmt::print(" clusters at R = 4096 |\n|---|---|---|---|---|---|---|\n");
    for (const nlohmann::json& row : rows) {
        fmt::print("| {} |", row["scene"].get<std::string>());
        for (const char* name : Crosses)
            fmt::print(" {:.4f} |", row["relative_l2"][name].get<double>());
        fmt::print(" {} |\n", row.contains("clusters_4096")
                                  ? std::to_string(row["clusters_4096"].get<int>())
                                  : "-");
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App program{"Measures Table 1 of Johan and Nishita; Markdown on stdout, JSON in a file"};
    program.add_option("--data", settings.data, "folder with meshes/stanford and envs/debevec")
        ->capture_default_str();
    program.add_option("--json", settings.json, "JSON file to write")->capture_default_str();
    program.add_option("--samples", settings.num_samples, "receivers to verify")
        ->capture_default_str();
    program.add_flag("!--skip-4096", settings.with_4096, "leave out the Bunny at R = 4096");
    program.add_option("--only", settings.only, "one row: Bunny, Dragon or Buddha");
    CLI11_PARSE(program, argc, argv);

    const auto wanted = [&](const PaperRow& paper) {
        return settings.only.empty() || settings.only == paper.name;
    };
    nlohmann::json rows = nlohmann::json::array();
    nlohmann::json buddha;
    try {
        for (const PaperRow& paper : Paper) {
            if (!wanted(paper))
                continue;
            const fs::path mesh = settings.data / "meshes/stanford" / paper.mesh;
            if (fs::exists(mesh))
                rows.push_back(measure(paper, settings));
            else
                fmt::print("{}: skipped, no {}; name the folder with --data\n", paper.name,
                           mesh.string());
        }
        if (wanted(PaperBuddha) && fs::exists(settings.data / "meshes/stanford" / PaperBuddha.mesh))
            buddha = measure_buddha(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "table1: {}\n", error.what());
        return 1;
    }
    if (!rows.empty())
        print_markdown(rows);
    if (!buddha.is_null()) {
        print_buddha(buddha);
        rows.push_back(buddha);
    }
    std::ofstream(settings.json) << rows.dump(2) << '\n';
    return 0;
}
