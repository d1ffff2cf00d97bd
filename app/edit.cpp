#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/commands.h"
#include "app/environment_options.h"
#include "app/lit_scene.h"
#include "app/output_options.h"
#include "cubemap/environment.h"
#include "relight/relighter.h"

namespace relumine::app {

namespace {

struct Options {
    SceneOptions scene;
    EnvironmentOptions environment;
    OutputOptions output;
    std::string direction;
    double radius_degrees = 10.0;
    std::string gain = "2";
    std::string saved_environment;
};

/// The texels of a face whose centres lie in the disc, by their bounding rectangle.
std::optional<relight::TexelRectangle> texels_in_disc(cubemap::Face face, std::uint32_t resolution,
                                                      const glm::dvec3& axis, double min_cosine) {
    relight::TexelRectangle box{.face = face, .x0 = resolution, .y0 = resolution};
    for (std::uint32_t y = 0; y < resolution; ++y)
        for (std::uint32_t x = 0; x < resolution; ++x)
            if (glm::dot(cubemap::texel_direction(face, x, y, resolution), axis) >= min_cosine) {
                box.x0 = std::min(box.x0, x);
                box.x1 = std::max(box.x1, x + 1);
                box.y0 = std::min(box.y0, y);
                box.y1 = std::max(box.y1, y + 1);
            }
    if (box.x0 >= box.x1)
        return std::nullopt;
    return box;
}

/// Refuses what cannot be written before any work is done.
void check_saved_environment(const Options& options) {
    const std::string& path = options.saved_environment;
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension != ".exr" && extension != ".hdr")
        throw std::runtime_error(
            fmt::format("{}: expected a name that ends in .exr or .hdr, got '{}'", path, extension));
    if (std::filesystem::path(path).lexically_normal() ==
        std::filesystem::path(options.output.path).lexically_normal())
        throw std::runtime_error(fmt::format("{}: expected another name than the output's", path));
    check_output(path, {options.scene.path, options.environment.path});
}

void run(const Options& options, Session& session) {
    options.output.check({options.scene.path, options.environment.path});
    if (!options.saved_environment.empty())
        check_saved_environment(options);
    const glm::vec3 direction = parse_vec3("--disc", options.direction);
    if (!(glm::length(direction) > 0.0f))
        throw CLI::ValidationError("--disc", "expected a direction, got 0,0,0");
    const bool is_grey = options.gain.find(',') == std::string::npos;
    const glm::vec3 gain =
        parse_vec3("--gain", is_grey ? fmt::format("{0},{0},{0}", options.gain) : options.gain);
    if (!(gain.r >= 0.0f && gain.g >= 0.0f && gain.b >= 0.0f))
        throw CLI::ValidationError("--gain", fmt::format("expected numbers >= 0, got '{}'", options.gain));

    const LitScene lit(options.scene);
    const prt::Scene& scene = lit.scene();
    LoadedEnvironment environment = load_environment(options.environment, session);
    relight::Relighter relighter(scene.transfer, lit.shadow_rays());
    const relight::RelightTimes full = relighter.set_environment(std::move(environment.map));

    // Multiply the disc's texels, face by face; only the clusters under them are lit again.
    const glm::dvec3 axis = glm::normalize(glm::dvec3(direction));
    const double min_cosine = std::cos(options.radius_degrees * std::numbers::pi / 180.0);
    const std::uint32_t resolution = relighter.environment().resolution;
    relight::UpdateReport total;
    for (const cubemap::Face face : cubemap::AllFaces) {
        const std::optional<relight::TexelRectangle> box = texels_in_disc(face, resolution, axis, min_cosine);
        if (!box)
            continue;
        std::vector<glm::vec3> radiance;
        for (std::uint32_t y = box->y0; y < box->y1; ++y)
            for (std::uint32_t x = box->x0; x < box->x1; ++x) {
                const bool inside =
                    glm::dot(cubemap::texel_direction(face, x, y, resolution), axis) >= min_cosine;
                radiance.push_back(relighter.environment().at(face, x, y) *
                                   (inside ? gain : glm::vec3(1.0f)));
            }
        const relight::UpdateReport report = relighter.update_region(*box, radiance);
        total.num_clusters += report.num_clusters;
        total.seconds += report.seconds;
    }

    options.output.save(lit, relighter.radiance(), relighter.environment());
    if (!options.saved_environment.empty())
        cubemap::save_environment(options.saved_environment, relighter.environment());
    const double seconds_full = full.seconds_bin + full.seconds_trace + full.seconds_relight;
    session.say(fmt::format("{}: edit touched {} of {} clusters in {:.2f} ms; a full relight took {:.1f} ms",
                            options.output.path, total.num_clusters, scene.transfer.num_clusters(),
                            1e3 * total.seconds, 1e3 * seconds_full));
    session.report({{"clusters_touched", total.num_clusters},
                    {"clusters", scene.transfer.num_clusters()},
                    {"seconds_edit", total.seconds},
                    {"seconds_full", seconds_full}});
}

} // namespace

void add_edit(CLI::App& program, Session& session) {
    CLI::App& command = *program.add_subcommand(
        "edit", "brighten, dim or tint a disc of the environment and update the scene");
    auto options = std::make_shared<Options>();
    options->scene.add_to(command);
    options->environment.add_to(command);
    options->output.add_to(command);
    command
        .add_option("--disc", options->direction,
                    "centre of the disc: direction X,Y,Z from the scene to the light")
        ->required();
    command.add_option("--radius", options->radius_degrees, "angular radius of the disc in degrees")
        ->check(number_between(0.0, 180.0))
        ->capture_default_str();
    command.add_option("--gain", options->gain, "factor on the disc's radiance: a number or R,G,B")
        ->capture_default_str();
    command.add_option("--save-env", options->saved_environment,
                       "write the edited environment: cube .exr or .hdr");
    session.add_common_options(command);
    command.callback([options, &session] { run(*options, session); });
}

} // namespace relumine::app
