// `relumine export web`: a scene as a page that anyone can open.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "app/web/page_parts.h"
#include "app/web/web_environments.h"
#include "app/web/web_files.h"
#include "app/web/web_lamps.h"
#include "app/web/web_look.h"
#include "files/counted.h"
#include "files/output_file.h"
#include "relumine/in/coarsen.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/bounces.h"
#include "relumine/light/light_parts.h"
#include "relumine/light/live_eye.h"
#include "relumine/out/level_camera.h"
#include "relumine/out/pictures.h"
#include "relumine/out/receiver_colors.h"
#include "relumine/version.h"

namespace relumine::app {

namespace {

struct ExportWebArguments {
    std::string scene;
    std::vector<std::string> environments;
    std::string output;
    float tolerance = 0.0275f;
    std::size_t num_samples = 500;
    std::string bounces = "auto";
    std::optional<double> max_bytes;

    [[nodiscard]] bool is_single_file() const { return extension_of(output) == ".html"; }
};

/// What the page's runtime opens.
constexpr std::string_view SceneFile = "scene.relight";

/// What a page cannot show of a scene, in words.
std::vector<std::string> left_out_of(const Scene& scene) {
    std::vector<std::string> left;
    if (scene.transfer.glossy)
        left.push_back("highlights, which are for one eye");
    else
        left = left_out_of_highlights(scene);
    if (std::any_of(scene.mesh.materials.begin(), scene.mesh.materials.end(),
                    [](const mesh::Material& material) {
                        return material.alpha_mode != mesh::AlphaMode::Opaque ||
                               material.transmission > 0.0f;
                    }))
        left.push_back("alpha and glass: surfaces are opaque, though light passes them");
    if (std::any_of(
            scene.mesh.materials.begin(), scene.mesh.materials.end(),
            [](const mesh::Material& material) { return material.diffuse_transmission > 0.0f; }))
        left.push_back("light that comes through leaves, paper and cloth");
    if (const float roll = leveled(camera_of(scene)).roll_degrees; roll != 0.0f)
        left.push_back(fmt::format("the camera's turn by {:.3g} degrees about its view", roll));
    return left;
}

/// Lets triangles begin with their lowest vertex and puts them in the order of these, which packs
/// best (prt/scene/packed_mesh.h).
void order_triangles(mesh::TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        mesh::Triangle& triangle = mesh.triangles[i];
        const auto lowest = std::min_element(triangle.begin(), triangle.end()) - triangle.begin();
        const auto turn = [&](auto& corners) {
            std::rotate(corners.begin(), corners.begin() + lowest, corners.end());
        };
        turn(triangle);
        if (!mesh.corner_uvs.empty())
            turn(mesh.corner_uvs[i]);
        if (!mesh.corner_tangents.empty())
            turn(mesh.corner_tangents[i]);
    }
    std::vector<std::uint32_t> order(mesh.num_triangles());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return mesh.triangles[a] < mesh.triangles[b];
    });
    const auto sort = [&](auto& of_triangles) {
        if (of_triangles.empty())
            return;
        auto sorted = of_triangles;
        for (std::size_t i = 0; i < order.size(); ++i)
            sorted[i] = of_triangles[order[i]];
        of_triangles = std::move(sorted);
    };
    sort(mesh.triangles);
    sort(mesh.corner_uvs);
    sort(mesh.corner_tangents);
    sort(mesh.triangle_materials);
    sort(mesh.triangle_groups);
}

std::vector<std::byte> runtime_scene(Scene scene) {
    prt::RelightingScene lean{.scene = std::move(scene)};
    if (lean.scene.bounces)
        lean.albedo = bounces_of(lean.scene, bounce_albedo(lean.scene)).albedo;
    return prt::packed_relighting_scene(std::move(lean));
}

files::Json camera_of_page(const Scene& scene) {
    // The page lets nobody farther away than 40 radii.
    constexpr float Farthest = 15.0f;
    const float radius = 0.5f * relight::subject_bounds(scene.mesh).diagonal();
    const Camera camera = brought_near(leveled(camera_of(scene)), Farthest * radius);
    return {{"eye", camera.eye}, {"target", camera.target}, {"fov", camera.fov_degrees}};
}

files::Json subject_of(const Scene& scene) {
    const mesh::Bounds bounds = relight::subject_bounds(scene.mesh);
    return {{"center", bounds.center()}, {"radius", 0.5f * bounds.diagonal()}};
}

files::Json tone_of_page() {
    files::Json::Array names;
    for (const std::string_view name : relight::ToneCurveNames)
        names.push_back(std::string(name));
    files::Json tone = {{"source", relight::on_screen_source()}};
    tone.set("names", std::move(names));
    return tone;
}

struct PageWords {
    std::string title = {};
    /// What the page leaves out of the scene
    std::vector<std::string> left_out = {};
    /// What is said of bounces with fewer samples
    std::string thinned = {};
    /// Their error, as error_of_bounces() finds it
    double thinned_error = 0.0;
};

/// The page's files but the parts that all pages have.
struct Page {
    WebFiles files = {};
    double worst = 0.0;
    std::size_t num_clusters = 0;
    float tolerance = 0.0f;
    bool has_bounces = false;
};

Page made_page(const Scene& scene, const ExportWebArguments& options, const PageWords& words,
               Session& session) {
    Page page{.num_clusters = scene.transfer.num_clusters(),
              .tolerance = rms_tolerance(scene),
              .has_bounces = scene.bounces.has_value()};
    WebEnvironments environments =
        web_environments(options.environments, scene, options.num_samples, session);
    WebLook look = web_look(scene);
    WebLamps lamps = web_lamps(scene, session);
    files::Json::Array left;
    for (const std::string& what : words.left_out)
        left.push_back(what);
    files::Json manifest = {{"version", 1},
                            {"relumine", std::string(version())},
                            {"title", words.title},
                            {"scene", std::string(SceneFile)},
                            {"clusters", page.num_clusters},
                            {"tolerance", page.tolerance},
                            {"look", look.look},
                            {"floor", look.floor},
                            {"camera", camera_of_page(scene)},
                            {"subject", subject_of(scene)},
                            {"tone", tone_of_page()},
                            {"environments", environments.list}};
    manifest.set("lamps", lamps.list);
    manifest.set("leftOut", std::move(left));
    if (page.has_bounces)
        manifest.set("bouncesError", words.thinned_error);
    page.worst = environments.worst;
    page.files.push_back({"scene.json", bytes_of(manifest.text())});
    page.files.push_back({std::string(SceneFile), runtime_scene(scene)});
    for (WebFiles* const more : {&look.files, &lamps.files, &environments.files})
        for (WebFile& file : *more)
            page.files.push_back(std::move(file));
    return page;
}

WebFile& file_named(WebFiles& files, std::string_view name) {
    return *std::find_if(files.begin(), files.end(),
                         [&](const WebFile& file) { return file.name == name; });
}

/// All that is written.
WebFiles written(const Page& page, const WebFiles& parts, const ExportWebArguments& options,
                 const PageWords& words) {
    if (options.is_single_file())
        return {{"index.html", bytes_of(single_page(parts, page.files, words.title))}};
    WebFiles all = {{"index.html", bytes_of(folder_page(parts, words.title))}};
    for (const WebFile& part : parts)
        if (part.name != PageTemplate)
            all.push_back(part);
    all.insert(all.end(), page.files.begin(), page.files.end());
    return all;
}

/// Gives up what costs most, until the page is small enough: bounces, then clusters.
Scene fitted(Scene scene, ExportWebArguments options, const WebFiles& parts, const PageWords& words,
             Session& session) {
    constexpr float Step = 1.3f, Coarsest = 0.2f;
    // What is not verified yet takes a few words more.
    const double words_of_errors = 128.0 * static_cast<double>(options.environments.size() + 2);
    options.num_samples = 0;
    std::vector<std::string> given_up;
    Page page = made_page(scene, options, words, session);
    for (;;) {
        const double size =
            static_cast<double>(size_of(written(page, parts, options, words))) + words_of_errors;
        if (size <= *options.max_bytes)
            break;
        const float next = rms_tolerance(scene) * Step;
        if (scene.bounces) {
            scene.bounces.reset();
            given_up = {"the light between surfaces is left out"};
            page = made_page(scene, options, words, session);
        } else if (next <= Coarsest) {
            scene = coarsened(std::move(scene), next, {.stop = session.stop()});
            given_up.resize(1);
            given_up.push_back(fmt::format("--tolerance becomes {:.3g}", next));
            // Nothing else depends on the clusters but some digits.
            file_named(page.files, SceneFile).bytes = runtime_scene(scene);
        } else {
            throw std::runtime_error(
                fmt::format("--max-bytes: expected at least {:.0f} for this scene, got {:.0f}",
                            size, *options.max_bytes));
        }
    }
    for (const std::string& what : given_up)
        if (!what.empty())
            session.warn("--max-bytes: " + what);
    return scene;
}

/// Returns the largest relative L2 error of the light with other bounces, under the light of each
/// single face of the environment.
double error_of_bounces(const Scene& scene, const prt::BounceMatrix& other) {
    relight::Relighter relighter(scene.transfer);
    const std::vector<glm::vec3> albedo = bounces_of(scene, bounce_albedo(scene)).albedo;
    relight::BounceLight exact(*scene.bounces, scene.transfer), few(other, scene.transfer);
    exact.set_albedo(albedo);
    few.set_albedo(albedo);
    double worst = 0.0;
    for (const cubemap::Face face : cubemap::AllFaces) {
        cubemap::CubeMap environment(1);
        environment.at(face, 0, 0) = glm::vec3(1.0f);
        relighter.set_environment(environment);
        const std::span<const glm::vec3> direct = relighter.diffuse_radiance();
        exact.solve(direct, {});
        few.solve(direct, {});
        double error = 0.0, whole = 0.0;
        for (std::size_t i = 0; i < direct.size(); ++i) {
            const glm::vec3 expected = direct[i] + exact.indirect()[i];
            const glm::vec3 difference = direct[i] + few.indirect()[i] - expected;
            error += glm::dot(difference, difference);
            whole += glm::dot(expected, expected);
        }
        if (whole > 0.0)
            worst = std::max(worst, std::sqrt(error / whole));
    }
    return worst;
}

void thin_bounces(Scene& scene, const ExportWebArguments& options, PageWords& words) {
    // That a receiver's light from surfaces has in the mean.
    constexpr std::size_t Samples = 64;
    if (!scene.bounces || options.bounces == "all")
        return;
    prt::BounceMatrix few = prt::thinned(*scene.bounces, Samples);
    if (few.emitters.places.size() == scene.bounces->emitters.places.size())
        return;
    words.thinned_error = error_of_bounces(scene, few);
    words.thinned = fmt::format(
        "{}: bounces keep {:.0f} % of their samples, the light within {:.2g} %", options.scene,
        100.0 * static_cast<double>(few.emitters.places.size()) /
            static_cast<double>(scene.bounces->emitters.places.size()),
        100.0 * words.thinned_error);
    scene.bounces = std::move(few);
}

Scene scene_of_page(const ExportWebArguments& options, PageWords& words, Session& session) {
    Scene scene = load_scene(options.scene);
    if (!prt::on_vertices(scene.layout))
        throw std::runtime_error(fmt::format(
            "{}: expected a scene of vertices, got one of {}: a page turns the scene around",
            options.scene, prt::kind_of(scene.layout).name));
    if (!has_clusters(scene))
        throw std::runtime_error(fmt::format("{}: expected a scene with clusters", options.scene));
    if (options.bounces == "0")
        scene.bounces.reset();
    words.left_out = left_out_of(scene);
    for (const std::string& what : words.left_out)
        session.warn(fmt::format("{}: left out: {}", options.scene, what));
    scene.transfer.glossy.reset();
    order_triangles(scene.mesh);
    if (rms_tolerance(scene) < options.tolerance)
        scene = coarsened(std::move(scene), options.tolerance, session.work("joining clusters"));
    session.end_progress();
    thin_bounces(scene, options, words);
    return scene;
}

void export_web(const ExportWebArguments& options, Session& session) {
    const std::filesystem::path output = options.output;
    std::vector<std::string> inputs = options.environments;
    inputs.push_back(options.scene);
    if (options.is_single_file())
        check_output(options.output, inputs);
    else
        check_folder(output);
    const WebFiles parts = find_page_parts();
    PageWords words{.title = std::filesystem::path(options.scene).stem().string()};
    Scene scene = scene_of_page(options, words, session);
    if (options.max_bytes)
        scene = fitted(std::move(scene), options, parts, words, session);
    const Page page = made_page(scene, options, words, session);
    WebFiles files = written(page, parts, options, words);
    session.poll();
    const std::uint64_t size = size_of(files);
    std::uint64_t of_environments = 0;
    for (const WebFile& file : page.files)
        of_environments += file.name.starts_with("environments/") ? file.bytes.size() : 0;
    if (options.is_single_file()) {
        files.front().name = output.filename().string();
        write_folder(output.parent_path().empty() ? "." : output.parent_path(), files);
    } else {
        write_folder(output, files);
    }
    if (page.has_bounces && !words.thinned.empty())
        session.say(words.thinned);
    session.say(fmt::format("{}: {} clusters, {:.1f} MB, of which environments {:.1f} MB{}",
                            options.output, page.num_clusters, 1e-6 * static_cast<double>(size),
                            1e-6 * static_cast<double>(of_environments),
                            options.num_samples == 0 ? ""
                                                     : fmt::format("; the light is within {:.2g} %",
                                                                   100.0 * page.worst)));
    constexpr double Visible = 0.05;
    if (page.worst > Visible)
        session.warn(
            fmt::format("the light of one of the environments is off by {:.2g} % in the mean: "
                        "suns and lamps go through the clusters in a page; a smaller "
                        "--tolerance, of the precompute and here, comes closer",
                        100.0 * page.worst));
    session.report({{"clusters", page.num_clusters},
                    {"tolerance", page.tolerance},
                    {"bounces", page.has_bounces},
                    {"bytes", size},
                    {"bytes_environments", of_environments},
                    {"relative_l2", page.worst}});
}

} // namespace

void add_export_web(Command& program, Session& session) {
    Command command = program.command("export").add_command(
        "web", "a page that lights the scene in any browser: SCENE.prt [ENV...] -> folder");
    auto options = std::make_shared<ExportWebArguments>();
    command.add(row("SCENE", options->scene, "scene of `relumine precompute`, of vertices",
                    {.file = true, .required = true}));
    command.add(row("ENV", options->environments,
                    "environments to choose from; none: some are made", {.file = true}));
    command.add(row("-o,--output", options->output,
                    "the folder to write, or OUT.html: one file with all within, which opens by a "
                    "double click",
                    {.folder = true, .required = true}));
    command.add(
        row("--tolerance", options->tolerance,
            "clusters are joined up to this tolerance, 1/sr; a scene's own larger one stays",
            {.min = 1e-6, .max = 1.0}));
    command.add(row("--samples", options->num_samples,
                    "receivers whose light is compared with exact integration, 0 for none"));
    command.add(row("--bounces", options->bounces,
                    "the light between surfaces: from 64 samples a receiver in the mean, from all "
                    "that the scene has, or 0 for none",
                    {.choices = {"auto", "all", "0"}}));
    command.add(row("--max-bytes", options->max_bytes,
                    "largest size of all files: bounces and clusters are given up for it",
                    {.min = 1, .type = "BYTES"}));
    session.add_common_options(command);
    command.on_run([options, &session] { export_web(*options, session); });
}

} // namespace relumine::app
