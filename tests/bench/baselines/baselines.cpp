// Relumine beside the other ways to relight with precomputed transport, at the same bytes: error
// against exact integration, size, time. See `./dev bench baselines --help`; `./dev bench report`
// draws it.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data_gen/scenes.h"
#include "files/compression.h"
#include "lights/place_lights.h"
#include "relight/reference/exact.h"
#include "relight/sharp/shadow_rays.h"
#include "relumine/relumine.h"
#include "tests/bench/baselines/cpca.h"
#include "tests/bench/baselines/cycles.h"
#include "tests/bench/baselines/dense_transport.h"
#include "tests/bench/baselines/features.h"
#include "tests/bench/baselines/sparse_columns.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

struct Settings {
    fs::path json = "baselines.json";
    /// Folder of pictures; empty: none.
    fs::path pictures = {};
    bool quick = false;
    std::vector<std::string> scenes = {"bunny", "dragon", "colonnade", "room"};
    std::size_t num_samples = 1000;
    /// Of the dense transport that others compress.
    std::uint32_t resolution = 64;
    /// Of environments, and of what is integrated exactly.
    std::uint32_t map_resolution = 256;
    std::vector<float> tolerances = {0.06f, 0.03f, 0.02f, 0.0135f, 0.008f};
    /// Of the paper's way to store clusters, which takes gigabytes below it.
    float finest_of_paper = 0.02f;
    std::vector<std::uint32_t> orders = {3, 4, 5, 6, 8, 10, 12};
    std::vector<std::uint32_t> dense_resolutions = {4, 8, 16, 32, 64};
    std::vector<std::size_t> wavelet_megabytes = {1, 2, 4, 8, 16, 32};
    struct Cpca {
        std::size_t clusters, components;
    };
    std::vector<Cpca> cpca = {{24, 8}, {48, 16}, {96, 16}, {96, 32}};
    /// Cycles takes 16 samples a vertex, then four times as many each time up to these. 0: it is
    /// left out.
    std::uint32_t most_cycles_samples = 1024;
};

/// Of zstd, as in scene files.
constexpr int Level = 3;

/// A scene, what light it has exactly, and the rows of its table.
class Comparison {
public:
    Comparison(std::string name, const Mesh& mesh, const Settings& settings,
               const std::vector<bench::NamedMap>& maps, nlohmann::json& rows)
        : name_(std::move(name)), mesh_(mesh), settings_(settings), maps_(maps), rows_(rows),
          lit_(unclustered_scene(mesh)) {
        const Scene& scene = lit_.scene();
        for (std::uint32_t i = 0; i < scene.receivers.size(); ++i)
            chosen_.push_back(i);
        std::shuffle(chosen_.begin(), chosen_.end(), std::mt19937(1));
        chosen_.resize(std::min(chosen_.size(), settings.num_samples));
        std::ranges::sort(chosen_);
        for (const bench::NamedMap& map : maps)
            exact_.push_back(relight::exact_radiance(
                scene.receivers, chosen_, lit_.rays().of_mesh(), map.map, {.bias = bias()}));
    }

    [[nodiscard]] const Mesh& mesh() const { return mesh_; }
    [[nodiscard]] const LitScene& lit() const { return lit_; }
    [[nodiscard]] float bias() const { return lit_.scene().settings.bias; }
    [[nodiscard]] const Settings& settings() const { return settings_; }

    struct Row {
        std::string method, setting;
        std::size_t bytes = 0, stored_bytes = 0;
        double seconds_precompute = 0.0;
    };
    /// What a method makes of an environment: [num_receivers] in the mesh's order, and how long
    /// that took without what is done to the environment before.
    struct Relit {
        std::vector<glm::vec3> radiance;
        double seconds = 0.0;
    };
    /// Adds a row, and a picture under the map of pictures.
    void add(const Row& row, const std::function<Relit(const cubemap::CubeMap&)>& relight) {
        nlohmann::json errors;
        double sum = 0.0, seconds = 0.0;
        for (std::size_t i = 0; i < maps_.size(); ++i) {
            const Relit relit = relight(maps_[i].map);
            const double error = relight::compare(chosen_, exact_[i], relit.radiance).relative_l2;
            errors[maps_[i].name] = error;
            sum += error;
            seconds += relit.seconds / static_cast<double>(maps_.size());
            if (i == PictureMap)
                draw(fmt::format("{} {} {}", name_, row.method, row.setting), relit.radiance);
        }
        const double milliseconds = 1e3 * seconds;
        rows_.push_back({{"scene", name_},
                         {"receivers", lit_.scene().receivers.size()},
                         {"method", row.method},
                         {"setting", row.setting},
                         {"bytes", row.bytes},
                         {"stored_bytes", row.stored_bytes},
                         {"seconds_precompute", row.seconds_precompute},
                         {"milliseconds_relight", milliseconds},
                         {"relative_l2", errors}});
        fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.4f} |\n", name_,
                   row.method, row.setting, 1e-6 * static_cast<double>(row.bytes),
                   1e-6 * static_cast<double>(row.stored_bytes), row.seconds_precompute,
                   milliseconds, sum / static_cast<double>(maps_.size()));
        std::fflush(stdout);
    }

    /// A method that is a matrix by place of `order` times features of the environment.
    void add_linear(
        const Row& row, const std::vector<std::uint32_t>& order, const bench::Features& features,
        const std::function<void(std::span<const glm::vec3>, std::vector<glm::vec3>&)>& multiply) {
        std::vector<glm::vec3> by_place;
        add(row, [&](const cubemap::CubeMap& map) {
            const std::vector<glm::vec3> light = features.project(map);
            Relit relit{.radiance = std::vector<glm::vec3>(order.size()),
                        .seconds = bench::median_seconds([&] { multiply(light, by_place); })};
            for (std::size_t place = 0; place < order.size(); ++place)
                relit.radiance[order[place]] = by_place[place];
            return relit;
        });
    }

    /// The scene under the map of pictures as it is, for pictures to be held to.
    void draw_exact() {
        if (settings_.pictures.empty())
            return;
        const Scene& scene = lit_.scene();
        std::vector<std::uint32_t> all(scene.receivers.size());
        std::iota(all.begin(), all.end(), 0u);
        const std::vector<glm::dvec3> exact =
            relight::exact_radiance(scene.receivers, all, lit_.rays().of_mesh(),
                                    cubemap::halved(maps_[PictureMap].map), {.bias = bias()});
        draw(name_ + " exact", std::vector<glm::vec3>(exact.begin(), exact.end()));
    }

private:
    /// St. Peter's: small windows, a bright sky behind them.
    static constexpr std::size_t PictureMap = 1;

    void draw(const std::string& title, std::span<const glm::vec3> radiance) {
        if (settings_.pictures.empty())
            return;
        std::string file = title;
        std::ranges::replace_if(
            file, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '_');
        if (!painter_)
            painter_ = std::make_unique<Painter>(
                lit_, OutputOptions{.floor = FloorLook::Grey, .width = 480, .height = 360});
        painter_->save(settings_.pictures / (file + ".png"),
                       {.radiance = radiance, .environment = &maps_[PictureMap].map});
    }

    std::string name_;
    const Mesh& mesh_;
    const Settings& settings_;
    const std::vector<bench::NamedMap>& maps_;
    nlohmann::json& rows_;
    LitScene lit_;
    std::vector<std::uint32_t> chosen_;
    /// [maps][chosen]
    std::vector<std::vector<glm::dvec3>> exact_;
    /// One camera and one exposure for all pictures; the first one chooses it.
    std::unique_ptr<Painter> painter_;
};

std::size_t packed_size(std::span<const std::byte> bytes) {
    return files::compressed(bytes, Level).size();
}

template<typename Integer>
void add_packed(Comparison& comparison, const std::string& method, const std::string& setting,
                const std::vector<std::uint32_t>& order, const bench::Features& features,
                double seconds_before) {
    bench::PackedMatrix<Integer> matrix;
    const double seconds =
        bench::seconds_of([&] { matrix = bench::packed<Integer>(features.rows); });
    comparison.add_linear({.method = method,
                           .setting = setting,
                           .bytes = matrix.bytes(),
                           .stored_bytes = packed_size(std::as_bytes(std::span(matrix.values))),
                           .seconds_precompute = seconds_before + seconds},
                          order, features,
                          [&](std::span<const glm::vec3> light, std::vector<glm::vec3>& radiance) {
                              bench::multiply(matrix, light, radiance);
                          });
}

/// Ours, with the shadow rays of small lights or without.
void add_relumine(Comparison& comparison, const std::shared_ptr<const Scene>& scene,
                  Comparison::Row row, bool clusters_only) {
    row.method = clusters_only ? "relumine, clusters alone" : "relumine";
    LitScene lit(scene, {.clusters_only = clusters_only});
    comparison.add(row, [&](const cubemap::CubeMap& map) {
        std::vector<double> seconds;
        for (int i = 0; i < 5; ++i) {
            const UpdateReport times = lit.light(cubemap::CubeMap(map));
            seconds.push_back(times.seconds_trace + times.seconds_relight);
        }
        return Comparison::Relit{.radiance = {lit.radiance().begin(), lit.radiance().end()},
                                 .seconds = bench::median(seconds)};
    });
}

/// Ours and the paper's, which store the same clusters in different ways.
void add_clusters(Comparison& comparison) {
    const fs::path file = fs::temp_directory_path() / "relumine_bench_baselines.prt";
    const Settings& settings = comparison.settings();
    for (const float tolerance : settings.tolerances) {
        PrecomputeReport report;
        const auto scene = std::make_shared<const Scene>(precompute(
            comparison.mesh(),
            {.tolerance = tolerance, .no_refine = true, .bounce_tolerance = 0.0f}, {}, &report));
        const std::uint64_t stored = save_scene(file, *scene);
        fs::remove(file);
        const prt::VisibleCounts& counts = scene->transfer.counts;
        const Comparison::Row row{.method = {},
                                  .setting = fmt::format("tolerance {}", tolerance),
                                  .bytes = counts.counts.size() + 8 * counts.visible.size() +
                                           8 * counts.mixed.size() + 8 * counts.mixed_before.size(),
                                  .stored_bytes = stored,
                                  .seconds_precompute = report.clusters.seconds};
        add_relumine(comparison, scene, row, false);
        add_relumine(comparison, scene, row, true);
        if (tolerance >= settings.finest_of_paper)
            add_packed<std::int8_t>(comparison, "clusters in bytes",
                                    fmt::format("{} clusters", scene->transfer.num_clusters()),
                                    scene->transfer.order, bench::cluster_features(scene->transfer),
                                    report.clusters.seconds);
    }
}

void add_wavelets(Comparison& comparison, const bench::DenseTransport& dense,
                  double seconds_before) {
    const bench::Features features = bench::wavelet_features(dense);
    constexpr std::size_t BytesOfEntry = 3;
    for (const std::size_t megabytes : comparison.settings().wavelet_megabytes) {
        const bench::Stopwatch watch;
        const bench::SparseColumns matrix(features.rows, megabytes * 1'000'000 / BytesOfEntry);
        const double seconds = seconds_before + watch.seconds();
        const std::size_t stored = packed_size(matrix.content());
        // All columns, and as few as Ng et al. light with.
        for (const std::size_t num_columns : {std::size_t{0}, std::size_t{200}})
            comparison.add_linear(
                {.method = num_columns == 0 ? "wavelets" : "wavelets, 200 of the light",
                 .setting = fmt::format("{} MB", megabytes),
                 .bytes = matrix.bytes(),
                 .stored_bytes = stored,
                 .seconds_precompute = seconds},
                dense.scene().transfer.order, features,
                [&](std::span<const glm::vec3> light, std::vector<glm::vec3>& radiance) {
                    matrix.multiply(light, num_columns, radiance);
                });
    }
}

void add_cpca(Comparison& comparison, const bench::DenseTransport& dense,
              const bench::Features& features, const std::string& method, double seconds_before) {
    for (const auto& [clusters, components] : comparison.settings().cpca) {
        const bench::Stopwatch watch;
        const bench::ClusteredComponents matrix(features.rows, clusters, components);
        comparison.add_linear(
            {.method = method,
             .setting = fmt::format("{} clusters, {} vectors", clusters, components),
             .bytes = matrix.bytes(),
             .stored_bytes = packed_size(matrix.content()),
             .seconds_precompute = seconds_before + watch.seconds()},
            dense.scene().transfer.order, features,
            [&](std::span<const glm::vec3> light, std::vector<glm::vec3>& radiance) {
                matrix.multiply(light, radiance);
            });
    }
}

/// 64 lights of Debevec's median cut with shadow rays; nothing is stored.
void add_lights(Comparison& comparison) {
    const Scene& scene = comparison.lit().scene();
    const relight::ShadowRays rays{.blockers = &comparison.lit().rays().for_moving_lights(),
                                   .positions = scene.receivers.positions,
                                   .bias = comparison.bias()};
    for (const std::size_t count : {std::size_t{64}, std::size_t{256}}) {
        comparison.add({.method = "median cut, traced", .setting = fmt::format("{} lights", count)},
                       [&](const cubemap::CubeMap& map) {
                           const std::vector<lights::DistantLight> placed =
                               lights::place_lights(lights::Method::MedianCut, map, count);
                           Comparison::Relit relit;
                           relit.seconds = bench::seconds_of([&] {
                               relit.radiance =
                                   relight::radiance_under(placed, scene.receivers.normals, rays);
                           });
                           return relit;
                       });
    }
}

/// Cycles starts anew for each environment. Its time is that of the bake alone.
void add_cycles(Comparison& comparison) {
    const std::uint32_t most = comparison.settings().most_cycles_samples;
    if (most == 0 || !bench::Cycles::is_there())
        return;
    const bench::Cycles cycles(comparison.lit().scene().mesh);
    for (std::uint32_t samples = 16; samples <= most; samples *= 4)
        comparison.add({.method = "Cycles", .setting = fmt::format("{} samples", samples)},
                       [&](const cubemap::CubeMap& map) {
                           bench::Cycles::Baked baked = cycles.bake(map, samples);
                           return Comparison::Relit{.radiance = std::move(baked.radiance),
                                                    .seconds = baked.seconds};
                       });
}

void compare_all(Comparison& comparison) {
    const Settings& settings = comparison.settings();
    comparison.draw_exact();
    add_clusters(comparison);
    add_lights(comparison);
    add_cycles(comparison);
    const bench::Stopwatch watch;
    const bench::DenseTransport dense(comparison.mesh(), settings.resolution);
    const double seconds_dense = watch.seconds();
    const std::vector<std::uint32_t>& order = dense.scene().transfer.order;
    for (const std::uint32_t resolution : settings.dense_resolutions)
        add_packed<std::int8_t>(comparison, "dense bytes", fmt::format("R = {}", resolution), order,
                                bench::texel_features(dense, resolution), seconds_dense);
    add_wavelets(comparison, dense, seconds_dense);
    const bench::Stopwatch projection;
    const bench::HarmonicTransport harmonics(dense, settings.orders.back());
    const double seconds = seconds_dense + projection.seconds();
    for (const std::uint32_t sh_order : settings.orders) {
        add_packed<std::int16_t>(comparison, "harmonics", fmt::format("order {}", sh_order), order,
                                 harmonics.features(sh_order, bench::Window::None), seconds);
        add_packed<std::int16_t>(comparison, "harmonics, windowed",
                                 fmt::format("order {}", sh_order), order,
                                 harmonics.features(sh_order, bench::Window::Hann), seconds);
    }
    add_cpca(comparison, dense, harmonics.features(settings.orders.back(), bench::Window::None),
             fmt::format("CPCA of harmonics, order {}", settings.orders.back()), seconds);
    const std::uint32_t coarse = settings.resolution / 4;
    add_cpca(comparison, dense, bench::texel_features(dense, coarse),
             fmt::format("CPCA of texels, R = {}", coarse), seconds_dense);
}

Mesh scene_mesh(const std::string& name, bool quick, const bench::Inputs& inputs) {
    const std::size_t num_generated = quick ? 20'000 : 100'000;
    const std::uint32_t floor = quick ? 97 : 193;
    if (name == "bunny")
        return inputs.mesh(quick ? "bun_zipper_res2.ply" : "bun_zipper.ply", floor);
    if (name == "dragon")
        return inputs.mesh(quick ? "dragon_vrip_res4.ply" : "dragon_vrip_res2.ply", floor);
    if (inputs.is_tiny())
        return inputs.mesh("");
    return Mesh(name == "room" ? data_gen::room(num_generated)
                               : data_gen::colonnade(num_generated));
}

/// What fits into some minutes: every second size of each method.
void make_quick(Settings& settings) {
    settings.num_samples = 500;
    settings.resolution = 32;
    settings.tolerances = {0.06f, 0.03f, 0.02f, 0.0135f};
    settings.orders = {3, 5, 8, 12};
    settings.dense_resolutions = {8, 16, 32};
    settings.wavelet_megabytes = {1, 4, 16};
    settings.cpca = {{24, 8}, {96, 16}};
    settings.most_cycles_samples = 64;
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_baselines",
                           "error, bytes and time of Relumine beside other ways to relight; "
                           "Markdown on stdout, JSON in a file");
    bench::Inputs inputs(program);
    program.add("--json", settings.json, "JSON file to write");
    program.add("--scenes", settings.scenes, "scenes");
    program.add("--pictures", settings.pictures, "folder for a picture of each row");
    program.add_flag("--quick", settings.quick, "smaller meshes and fewer rows");
    program.add("--cycles", settings.most_cycles_samples,
                "most samples of Cycles; 64 with --quick, 0: leave it out");
    program.add("--samples", settings.num_samples, "receivers that are integrated exactly");
    program.add("--resolution", settings.resolution, "R of the transport that others compress");
    return program.run(argc, argv, [&] {
        if (program.is_tiny())
            settings = {.json = settings.json,
                        .scenes = {"room"},
                        .num_samples = 30,
                        .resolution = 16,
                        .map_resolution = 16,
                        .tolerances = {0.2f},
                        .orders = {3, 4},
                        .dense_resolutions = {4, 16},
                        .wavelet_megabytes = {1},
                        .cpca = {{4, 3}},
                        .most_cycles_samples = 0};
        if (settings.quick)
            make_quick(settings);
        std::vector<bench::NamedMap> maps = inputs.probes_and_sky(settings.map_resolution);
        maps.push_back({"studio", inputs.studio(settings.map_resolution)});
        if (!settings.pictures.empty())
            fs::create_directories(settings.pictures);
        nlohmann::json rows = nlohmann::json::array();
        fmt::print("| scene | method | setting | MB | MB stored | precompute, s | relight, ms | "
                   "relative L2, mean |\n|---|---|---|---|---|---|---|---|\n");
        for (const std::string& name : settings.scenes) {
            const Mesh mesh = scene_mesh(name, settings.quick, inputs);
            Comparison comparison(name, mesh, settings, maps, rows);
            compare_all(comparison);
            std::ofstream(settings.json) << rows.dump(1) << '\n';
        }
    });
}
