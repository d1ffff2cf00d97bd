#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/eye_options.h"
#include "app/scenes/lit_scene.h"
#include "relumine/in/move.h"
#include "relumine/in/place_report.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

namespace {

struct VerifyArguments {
    SceneOptions scene;
    EnvironmentOptions environment;
    std::size_t num_samples = 2000;
    BounceOption bounces;
    float albedo = 0.5f;
    std::uint32_t num_paths = VerifyOptions{}.num_paths;
    std::optional<glm::dvec3> eye;
    EyeOptions eye_options;
};

/// Points of the surface, beside the receivers: as many as these, and no more than are enough.
std::size_t surface_points(const VerifyArguments& options) {
    const std::size_t enough = VerifyOptions{}.num_surface_points;
    return options.num_samples == 0 ? enough : std::min(enough, options.num_samples);
}

/// One sentence that says what a picture has to expect, and how much worse it is elsewhere.
std::string headline(const Verification& check, std::string_view receiver) {
    constexpr double Large = 0.05;
    const double shown = check.picture ? check.picture->error.relative_l2 : check.error.relative_l2;
    std::string line = fmt::format("the light is off by {:.3g} % {}", 100.0 * shown,
                                   check.picture ? std::string(VerifiedPlaces[2])
                                                 : fmt::format("at each {}", receiver));
    if (shown > Large)
        line += check.picture && shown > 2.0 * check.error.relative_l2
                    ? "; the triangles are too large for what the vertices see, --refine adds more"
                    : "; a smaller --tolerance makes it better";
    if (const WorstError worst = worst_of(check); worst.relative_l2 > std::max(Large, 2.0 * shown))
        line += fmt::format("; elsewhere by {:.3g} % {}", 100.0 * worst.relative_l2, worst.place);
    return line;
}

/// The error at points of the surface, for people and for --json.
Report surface_report(std::string_view place, const mesh::TriangleMesh& mesh,
                      const Verification::Surface& surface, const Session& session) {
    const relight::ErrorReport& error = surface.error;
    const glm::vec3 worst =
        prt::value_at(mesh, mesh.positions, surface.points[error.worst_receiver]);
    session.say(fmt::format("{}, {} points of the surface: relative L2 {:.5f}, "
                            "mean error {:.3f} %, largest {:.2f} % at ({})",
                            place, surface.points.size(), error.relative_l2, 100.0 * error.mean_abs,
                            100.0 * error.max_abs, place_text(mesh, worst)));
    return {{"points", surface.points.size()},
            {"relative_l2", error.relative_l2},
            {"mean_abs", error.mean_abs},
            {"max_abs", error.max_abs},
            {"bias", error.bias},
            {"mean_radiance", error.mean_radiance},
            {"worst_position", place_json(mesh, worst)}};
}

/// The error at the receivers, for people.
void say_receivers(const Verification& check, const Scene& scene, std::uint32_t resolution,
                   double seconds, const Session& session) {
    const relight::ErrorReport& error = check.error;
    const std::string_view name = prt::kind_of(scene.layout).one;
    session.say(headline(check, name));
    session.say(
        fmt::format("{} receivers, R = {}, exact integration of the file's pixels in {:.1f} s",
                    check.receivers.size(), resolution, seconds));
    session.say(fmt::format("relative L2 {:.5f}, mean error {:.3f} %, largest {:.2f} %, bias "
                            "{:+.3f} % of the mean radiance {:.4g}",
                            error.relative_l2, 100.0 * error.mean_abs, 100.0 * error.max_abs,
                            100.0 * error.bias, error.mean_radiance));
}

/// What a precompute of a scene whose groups move would choose now, for people and for --json.
void report_clusters(const Scene& scene, Session& session, Report& report) {
    const std::size_t own = scene.transfer.num_clusters();
    const std::size_t fresh = fresh_clusters(scene, {.stop = session.stop()});
    std::string_view hint;
    if (3 * fresh <= 2 * own)
        hint = ", a third less or more: it would be smaller and quicker";
    else if (2 * fresh >= 3 * own)
        hint = ", half more or more: it would be closer";
    session.say(fmt::format("{} clusters; a precompute of the scene as it stands would choose "
                            "about {}{}",
                            own, fresh, hint));
    report.set("clusters", own);
    report.set("fresh_clusters", fresh);
}

void run(const VerifyArguments& options, Session& session) {
    LitScene lit = lit_scene(options.scene, session);
    if (options.eye)
        require_live_highlights(lit.scene(), options.scene.path);
    warn_of_eye_inside(lit, options.eye, session);
    lit.light(load_environment(options.environment, session));
    if (session.team != nullptr) {
        require_same(*session.team, options.scene.path);
        require_same(*session.team, options.scene.path, &environment_of(lit));
    }
    const std::optional<BounceReport> bounces =
        options.bounces.bounce(lit, {.albedo = glm::vec3(options.albedo)}, options.scene.path);

    Stopwatch watch;
    const std::optional<glm::vec3> eye =
        options.eye ? std::optional(place_in(lit.scene().mesh, *options.eye)) : std::nullopt;
    const Verification check = verify(lit,
                                      {.num_samples = options.num_samples,
                                       .num_surface_points = surface_points(options),
                                       .num_paths = options.num_paths,
                                       .eye = eye,
                                       .eye_options = options.eye_options},
                                      {.team = session.processes(),
                                       .stop = session.stop(),
                                       .on_progress = session.progress("exact integration")});
    session.end_progress();
    warn_of_smooth_surfaces(check.num_too_smooth, session);
    const relight::ErrorReport& error = check.error;
    const double seconds = watch.lap();

    const glm::vec3& worst = lit.scene().receivers.positions[error.worst_receiver];
    const std::string name(prt::kind_of(lit.scene().layout).one);
    say_receivers(check, lit.scene(), environment_of(lit).resolution, seconds, session);
    if (bounces)
        session.say(
            fmt::format("with {} bounces at albedo {}, against {} paths per receiver, whose "
                        "noise is {:.5f} of the relative L2",
                        bounces->num_bounces, options.albedo, options.num_paths, check.noise));
    session.say(fmt::format("largest at {} {} ({})", name, error.worst_receiver,
                            place_text(lit.scene().mesh, worst)));
    Report report = {{"relative_l2", error.relative_l2},
                     {"mean_abs", error.mean_abs},
                     {"max_abs", error.max_abs},
                     {"bias", error.bias},
                     {"bounces", bounces ? bounces->num_bounces : 0},
                     {"noise", check.noise},
                     {"samples", check.receivers.size()},
                     {"mean_radiance", error.mean_radiance},
                     {name == "vertex" ? "worst_vertex" : "worst_receiver", error.worst_receiver},
                     {"worst_position", place_json(lit.scene().mesh, worst)},
                     {"face_resolution", environment_of(lit).resolution},
                     {"seconds", seconds}};
    if (check.surface)
        report.set("surface",
                   surface_report(VerifiedPlaces[1], lit.scene().mesh, *check.surface, session));
    if (check.picture)
        report.set("picture",
                   surface_report(VerifiedPlaces[2], lit.scene().mesh, *check.picture, session));
    const WorstError all = worst_of(check);
    report.set("worst",
               Report({{"relative_l2", all.relative_l2}, {"place", std::string(all.place)}}));
    if (lit.scene().settings.is_movable)
        report_clusters(lit.scene(), session, report);
    session.report(report);
}

} // namespace

void add_verify(Command& program, Session& session) {
    Command command = program.add_command(
        "verify",
        "compare relighting with exact integration: every pixel of the file, every shadow ray");
    auto options = std::make_shared<VerifyArguments>();
    options->scene.add_to(command);
    options->environment.add_to(command);
    command.add(row("--samples", options->num_samples,
                    "receivers chosen at random, 0 for all; and as many points of the surface, 500 "
                    "at most, where exact light is compared with what the vertices interpolate"));
    options->bounces.add_to(command, false);
    command.add(
        row("--albedo", options->albedo, "of all surfaces, for bounces", {.min = 0.0, .max = 1.0}));
    command.add(row("--paths", options->num_paths, "paths per receiver that bounces are held to",
                    {.min = 1, .max = 1u << 24}));
    command.add(row<PointText>("--eye", options->eye,
                               "X,Y,Z: compares the light towards this eye, of a scene of glossy "
                               "vertices without --view, at the vertices",
                               {.example = "1,2,3"}));
    command.add(glossy_tolerance_row(options->eye_options));
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace relumine::app
