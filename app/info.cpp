#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environment_options.h"
#include "cubemap/environment.h"
#include "cubemap/statistics.h"
#include "mesh/load.h"
#include "prt/scene_file.h"

namespace relumine::app {

namespace {

struct Options {
    std::string path;
    std::string layout;
};

nlohmann::json array(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

void describe_environment(const Options& options, const Session& session) {
    cubemap::LoadOptions load_options{.refuse_bad_pixels = false};
    if (!options.layout.empty())
        load_options.layout = parse_layout(options.layout);
    const cubemap::EnvironmentImage image = cubemap::load_environment(options.path, load_options);
    const cubemap::EnvironmentStatistics s = cubemap::statistics(image);
    const cubemap::BadPixels& bad = image.bad_pixels;

    session.say(fmt::format("layout              {} {} x {}", cubemap::name(image.layout), image.width,
                            image.height));
    session.say(fmt::format("assumed             {}", image.assumptions));
    session.say(fmt::format("samples             {}", image.sampling == cubemap::Sampling::Borders
                                                          ? "on the borders"
                                                          : "at texel centres"));
    session.say(fmt::format("as a cube map       6 x {0} x {0}", cubemap::natural_resolution(image)));
    session.say(fmt::format("mean radiance       {:.5g} {:.5g} {:.5g}, luminance {:.5g}", s.mean_radiance.r,
                            s.mean_radiance.g, s.mean_radiance.b, s.mean_luminance));
    session.say(fmt::format("luminance range     {:.4g} to {:.4g}, {:.1f} EV", s.min_positive_luminance,
                            s.max_luminance, s.dynamic_range_ev));
    session.say(fmt::format("brightest towards   {:.4f} {:.4f} {:.4f}", s.brightest_direction.x,
                            s.brightest_direction.y, s.brightest_direction.z));
    session.say(fmt::format("bad pixels          {} NaN, {} infinite, {} negative{}", bad.num_nan,
                            bad.num_infinite, bad.num_negative,
                            bad.count() == 0 ? ""
                                             : fmt::format("; first at ({}, {}); light with --fix-env",
                                                           bad.first_x, bad.first_y)));
    session.report({{"kind", "environment"},
                    {"layout", cubemap::name(image.layout)},
                    {"assumptions", image.assumptions},
                    {"samples_on_borders", image.sampling == cubemap::Sampling::Borders},
                    {"width", image.width},
                    {"height", image.height},
                    {"face_resolution", cubemap::natural_resolution(image)},
                    {"mean_radiance", array(s.mean_radiance)},
                    {"mean_luminance", s.mean_luminance},
                    {"max_luminance", s.max_luminance},
                    {"min_positive_luminance", s.min_positive_luminance},
                    {"dynamic_range_ev", s.dynamic_range_ev},
                    {"brightest_direction", array(s.brightest_direction)},
                    {"num_nan", bad.num_nan},
                    {"num_infinite", bad.num_infinite},
                    {"num_negative", bad.num_negative}});
}

void describe_scene(const Options& options, const Session& session) {
    const prt::Scene scene = prt::load_scene(options.path);
    const prt::SceneSettings& settings = scene.settings;
    const prt::VisibleCounts& counts = scene.transfer.counts;
    const auto file_bytes = std::filesystem::file_size(options.path);
    session.say(fmt::format("scene               {} vertices, {} triangles from {} (xxHash64 {:016x})",
                            scene.mesh.num_vertices(), scene.mesh.num_triangles(), settings.source,
                            settings.source_hash));
    session.say(fmt::format("clusters            {}", scene.transfer.num_clusters()));
    session.say(settings.epsilon ? fmt::format("epsilon             {}", *settings.epsilon)
                                 : fmt::format("tolerance           {} 1/sr", settings.tolerance));
    session.say(fmt::format("depth, resolution   at least {}, up to R = {}", settings.min_level,
                            settings.face_resolution));
    session.say(fmt::format(
        "bias, floor         {}, {}", settings.bias,
        settings.floor_vertices == 0 ? "none" : fmt::format("{0} x {0}", settings.floor_vertices)));
    session.say(fmt::format("partly seen         {} of {} (block, cluster) pairs", counts.num_mixed(),
                            counts.num_blocks() * counts.num_leaves));
    session.say(fmt::format("file                {:.1f} MB", static_cast<double>(file_bytes) * 1e-6));
    nlohmann::json result = {{"kind", "scene"},
                             {"vertices", scene.mesh.num_vertices()},
                             {"triangles", scene.mesh.num_triangles()},
                             {"clusters", scene.transfer.num_clusters()},
                             {"source", settings.source},
                             {"source_hash", fmt::format("{:016x}", settings.source_hash)},
                             {"min_depth", settings.min_level},
                             {"face_resolution", settings.face_resolution},
                             {"bias", settings.bias},
                             {"floor", settings.floor_vertices},
                             {"file_bytes", file_bytes}};
    if (settings.epsilon)
        result["epsilon"] = *settings.epsilon;
    else
        result["tolerance"] = settings.tolerance;
    session.report(result);
}

void describe_mesh(const Options& options, const Session& session) {
    const mesh::TriangleMesh mesh = mesh::load(options.path);
    const mesh::Bounds box = mesh::bounds(mesh);
    const auto num_loose = std::count(mesh.normals.begin(), mesh.normals.end(), glm::vec3(0.0f));
    session.say(fmt::format("mesh                {} vertices, {} triangles", mesh.num_vertices(),
                            mesh.num_triangles()));
    session.say(fmt::format("box                 ({}, {}, {}) to ({}, {}, {})", box.min.x, box.min.y,
                            box.min.z, box.max.x, box.max.y, box.max.z));
    session.say(fmt::format("without a face      {} vertices", num_loose));
    session.say(fmt::format("colours, uvs        {}, {}", mesh.colors.empty() ? "no" : "yes",
                            mesh.uvs.empty() ? "no" : "yes"));
    session.report({{"kind", "mesh"},
                    {"vertices", mesh.num_vertices()},
                    {"triangles", mesh.num_triangles()},
                    {"min", array(box.min)},
                    {"max", array(box.max)},
                    {"vertices_without_face", num_loose},
                    {"colors", !mesh.colors.empty()},
                    {"uvs", !mesh.uvs.empty()}});
}

void run(const Options& options, const Session& session) {
    std::string extension = std::filesystem::path(options.path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".prt")
        describe_scene(options, session);
    else if (extension == ".exr" || extension == ".hdr")
        describe_environment(options, session);
    else
        describe_mesh(options, session);
}

} // namespace

void add_info(CLI::App& program, Session& session) {
    CLI::App& command = *program.add_subcommand("info", "what a file is: a scene, an environment or a mesh");
    auto options = std::make_shared<Options>();
    command.add_option("FILE", options->path, ".prt, .exr, .hdr, .obj, .ply, .off or .stl")->required();
    command.add_option("--layout", options->layout, "layout of an environment, where the file does not tell")
        ->check(CLI::IsMember(layout_names()));
    session.add_common_options(command);
    command.callback([options, &session] { run(*options, session); });
}

} // namespace relumine::app
