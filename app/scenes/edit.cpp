#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/file_watch.h"
#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "app/scenes/lit_by.h"
#include "app/scenes/lit_scene.h"
#include "files/counted.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/place_report.h"
#include "relumine/light/layers.h"
#include "relumine/out/light_mix.h"

namespace relumine::app {

namespace {

struct EditArguments {
    SceneOptions scene;
    EnvironmentOptions environment;
    std::string layers;
    OutputOptions output;
    BounceOption bounces;
    /// The quick edit. Empty: LAYERS are given.
    std::optional<cubemap::Disc> disc;
    glm::vec3 gain{2.0f};
    std::string saved_environment;
    /// --who: a position. Empty: not asked for.
    std::optional<glm::dvec3> who;
    /// --lit-by: a layer's name, or a disc X,Y,Z,RADIUS. Empty: not asked for.
    std::string lit_by;
    bool watch = false;
    bool mixer = false;
};

void check_saved_environment(const EditArguments& options) {
    const std::string& path = options.saved_environment;
    require_environment_name("--save-env", path);
    if (std::filesystem::path(path).lexically_normal() ==
        std::filesystem::path(options.output.path).lexically_normal())
        throw std::runtime_error(fmt::format("{}: expected another name than the output's", path));
    check_output(path, {options.scene.path, options.environment.path});
}

/// The quick edit without a layer file: one gain layer.
cubemap::LightLayer disc_layer(const EditArguments& options) {
    cubemap::LightLayer layer;
    layer.name = "disc";
    layer.region = *options.disc;
    layer.effect = cubemap::Gain{.tint = options.gain};
    return layer;
}

cubemap::LightLayers layers_of(const EditArguments& options) {
    if (options.layers.empty() == !options.disc)
        throw UsageError("edit", "expected either LAYERS or --disc");
    if (!options.layers.empty())
        return cubemap::load_layers(options.layers);
    cubemap::LightLayers layers;
    layers.layers.push_back(disc_layer(options));
    return layers;
}

/// Refuses what cannot be written before any work is done.
void check_outputs(const EditArguments& options, const cubemap::LightLayers& layers) {
    OutputOptions output = options.output;
    if (!options.who && options.lit_by.empty() && !layers.frames.empty())
        output.path = frame_names(output.path).name(0);
    if (options.mixer && (options.who || !options.lit_by.empty()))
        throw UsageError("--mixer", "expected neither --who nor --lit-by with it");
    if (options.who || options.mixer) {
        require_extension("--output", output.path, {".exr", options.mixer ? ".exr" : ".png"});
    }
    if (!options.lit_by.empty())
        static_cast<void>(lit_by_region(options.lit_by, layers.layers));
    output.check({options.scene.path, options.environment.path, options.layers});
    if (!options.saved_environment.empty())
        check_saved_environment(options);
}

class Edit {
public:
    Edit(const EditArguments& options, cubemap::LightLayers layers, Session& session)
        : options_(options), session_(session), layers_(std::move(layers)),
          lit_(lit_scene(options.scene, session)) {
        lit_.dim(options.output.for_scene(lit_.scene()).emission);
    }

    void run() {
        check_receivers();
        Environment environment = load_environment(options_.environment, session_);
        UpdateReport full = lit_.light(std::move(environment));
        if (layers_.rotate_degrees)
            full = set_rotation(lit_, *layers_.rotate_degrees);
        seconds_full_ = full.seconds;
        expose();
        apply_one_by_one();
        bounce();
        write_output();
        if (layers_.frames.empty())
            session_.say(
                fmt::format("{}: {}{}", options_.output.path,
                            files::counted(lit_.scene().receivers.num_own(), "receiver"),
                            painter_ ? options_.output.exposure_text(*painter_) : std::string()));
        if (!options_.saved_environment.empty())
            cubemap::save_environment(options_.saved_environment, environment_of(lit_));
        if (options_.watch)
            watch();
        Report result = {{"clusters", lit_.scene().transfer.num_clusters()},
                         {"clusters_touched", clusters_touched_},
                         {"seconds_edit", seconds_edit_},
                         {"seconds_full", seconds_full_},
                         {"bounces", bounced_.num_bounces},
                         {"seconds_bounces", bounced_.seconds},
                         {"edits", edits_}};
        if (!options_.lit_by.empty())
            result.set("lit_by_share", lit_by_share_);
        if (painter_)
            result.set("exposure", painter_->exposure_ev(options_.output.path));
        session_.report(result);
    }

private:
    void check_receivers() {
        static_cast<void>(options_.bounces.applies_to(lit_.scene(), options_.scene.path));
        if (options_.who) // a map, whatever the receivers are
            return;
        painter_.emplace(lit_, options_.output.for_scene(lit_.scene()));
        options_.output.warn_of_picture(lit_.scene(), session_);
        OutputOptions output = options_.output;
        if (options_.lit_by.empty() && !layers_.frames.empty())
            output.path = frame_names(output.path).name(0);
        output.check_fits(lit_.scene());
    }

    void write_output() {
        if (options_.who)
            save_who();
        else if (!options_.lit_by.empty())
            save_lit_by();
        else if (!layers_.frames.empty())
            save_frames();
        else
            save_picture(options_.output.path);
    }

    /// The scene in its light, with --mixer taken apart.
    void save_picture(const std::string& path) {
        if (options_.mixer)
            relight::save_layered_picture(path, light_mix(lit_, *painter_),
                                          options_.output.picture.exposure_ev.value_or(0.0));
        else
            painter_->save(path, lit_.lighting());
    }

    /// Chooses the exposure by the light before the edits, so that a light which is added brightens
    /// the picture, and parts of the light show their share of it. Not over a black environment.
    void expose() {
        if (!painter_ || !painter_->needs_light_for(options_.output.path))
            return;
        static_cast<void>(options_.bounces.bounce(lit_, options_.output.for_scene(lit_.scene()),
                                                  options_.scene.path));
        const std::span<const glm::vec3> radiance = lit_.radiance();
        if (std::any_of(radiance.begin(), radiance.end(),
                        [](const glm::vec3& own) { return own != glm::vec3(0.0f); }))
            static_cast<void>(painter_->choose_exposure_ev(lit_.lighting()));
    }

    /// Edits are timed without their bounces, which come once, before anything is written.
    void bounce() {
        const auto report = options_.bounces.bounce(lit_, options_.output.for_scene(lit_.scene()),
                                                    options_.scene.path);
        if (!report)
            return;
        bounced_ = *report;
        session_.say(fmt::format("{} in {:.1f} ms", files::counted(report->num_bounces, "bounce"),
                                 1e3 * report->seconds));
    }

    void record(const std::string& name, const relight::UpdateReport& report) {
        clusters_touched_ += report.num_clusters;
        seconds_edit_ += report.seconds;
        edits_.push_back({{"name", name},
                          {"clusters", report.num_clusters},
                          {"receivers", report.num_receivers},
                          {"sharp_lights", report.num_sharp_lights},
                          {"seconds", report.seconds}});
        session_.say(
            fmt::format("{}: touched {} of {} clusters in {:.2f} ms; a full relight took {:.1f} ms",
                        name, report.num_clusters, lit_.scene().transfer.num_clusters(),
                        1e3 * report.seconds, 1e3 * seconds_full_));
    }

    void apply_one_by_one() {
        std::vector<cubemap::LightLayer> layers;
        for (const cubemap::LightLayer& layer : layers_.layers) {
            layers.push_back(layer);
            record(layer.name, set_layers(lit_, layers));
            session_.poll();
        }
    }

    void save_frames() {
        const int first = static_cast<int>(std::ceil(layers_.frames.front().frame));
        const int last = static_cast<int>(std::floor(layers_.frames.back().frame));
        for (int frame = first; frame <= last; ++frame) {
            record(fmt::format("frame {}", frame),
                   set_layers(lit_, cubemap::layers_at(layers_, frame)));
            bounce();
            save_picture(frame_names(options_.output.path).name(frame));
            session_.poll();
        }
    }

    /// The environment weighted by what it gives to the receiver nearest to the position.
    void save_who() const {
        const std::uint32_t receiver =
            nearest_receiver(lit_.scene(), place_in(lit_.scene().mesh, *options_.who));
        const glm::vec3& nearest = lit_.scene().receivers.positions[receiver];
        const cubemap::CubeMap map = contribution_map(lit_, {&receiver, 1});
        const auto is_dark = [](const glm::vec3& texel) {
            return texel == glm::vec3(0.0f);
        };
        if (std::all_of(map.texels.begin(), map.texels.end(), is_dark))
            session_.warn(fmt::format(
                "{}: black, since no light reaches {} {}: other surfaces cover it whole, or all "
                "that it sees is dark; name a point that is in the open",
                options_.output.path, prt::kind_of(lit_.scene().layout).one, receiver));
        save_map(options_.output.path, map, options_.output.picture.exposure_ev.value_or(0.0));
        session_.say(fmt::format("{}: what lights {} {} ({})", options_.output.path,
                                 prt::kind_of(lit_.scene().layout).one, receiver,
                                 place_text(lit_.scene().mesh, nearest)));
    }

    /// The scene as a region of the environment lights it, with that region behind it.
    void save_lit_by() {
        const Share part =
            lit_by(lit_, lit_by_region(options_.lit_by, lit_.environment().state().layers));
        painter_->save(options_.output.path, part.lighting());
        lit_by_share_ = part.share;
        session_.say(
            fmt::format("{}: what '{}' lights, {:.1f} % of the light that the scene reflects",
                        options_.output.path, options_.lit_by, 100.0 * part.share));
    }

    void watch() {
        using Clock = std::chrono::system_clock;
        FileWatch file(options_.environment.path);
        session_.say(fmt::format("{}: watching; Ctrl-C ends", options_.environment.path));
        while (const std::optional<Clock::time_point> saved = file.wait(session_.stop())) {
            // A program may save in several steps; what does not load yet will be saved again.
            try {
                Environment environment = load_environment(options_.environment, session_);
                const double seconds_load = environment.seconds_load + environment.seconds_resample;
                const relight::UpdateReport report = update(lit_, std::move(environment));
                const double since_saved =
                    std::chrono::duration<double>(Clock::now() - *saved).count();
                Stopwatch output;
                record("saved", report);
                const std::size_t index = edits_.size() - 1;
                bounce();
                write_output();
                const double seconds_output = output.total();
                // The file system's clock may be a tick behind.
                const double seconds_reaction = std::max(0.0, since_saved - seconds_load);
                files::update(edits_[index], {{"seconds_load", seconds_load},
                                              {"seconds_reaction", seconds_reaction},
                                              {"seconds_output", seconds_output}});
                session_.say(
                    fmt::format("lit {:.1f} ms after it was saved, and {:.1f} ms to load it; "
                                "{:.1f} ms to write {}",
                                1e3 * seconds_reaction, 1e3 * seconds_load, 1e3 * seconds_output,
                                options_.output.path));
            } catch (const prt::Cancelled&) {
                return; // what was written before is whole
            } catch (const std::runtime_error& error) {
                session_.complain(error.what());
            }
        }
    }

    const EditArguments& options_;
    Session& session_;
    cubemap::LightLayers layers_;
    LitScene lit_;
    /// Not for --who.
    std::optional<Painter> painter_;
    double seconds_full_ = 0.0;
    double seconds_edit_ = 0.0;
    double lit_by_share_ = 0.0;
    std::size_t clusters_touched_ = 0;
    BounceReport bounced_;
    std::vector<Report> edits_;
};

void run(const EditArguments& options, Session& session) {
    cubemap::LightLayers layers = layers_of(options);
    check_outputs(options, layers);
    Edit(options, std::move(layers), session).run();
}

} // namespace

void add_edit(Command& program, Session& session) {
    Command command =
        program.add_command("edit", "put light layers over the environment and update the scene");
    auto options = std::make_shared<EditArguments>();
    options->scene.add_to(command);
    options->environment.add_to(command);
    command.add(row("LAYERS", options->layers, "light layers, .json (docs/light-layers.md)",
                    {.file = true}));
    options->output.add_to(command);
    options->bounces.add_to(command);
    command.add(row<DiscText>("--disc", options->disc,
                              "instead of LAYERS: multiply a disc around the direction X,Y,Z from "
                              "the scene to the light, RADIUS in degrees"));
    command.add(row<ColorText>("--gain", options->gain,
                               "factor on the disc's radiance: a number or R,G,B"));
    command.add(row("--save-env", options->saved_environment,
                    "write the edited environment: cube .exr or .hdr", {.file = true}));
    command.add(row<PointText>(
        "--who", options->who,
        "write what lights the receiver nearest to X,Y,Z instead: a lat-long .exr or .png"));
    command.add(
        row("--lit-by", options->lit_by,
            "write the scene as lit by a region of the environment alone: a layer's name, or "
            "X,Y,Z,RADIUS for a disc",
            {.excludes = "--who"}));
    command.add(row("--mixer", options->mixer,
                    "write OUT, .exr, with a layer for the environment and for each light, whose "
                    "sum is the picture"));
    command.add(row("--watch", options->watch,
                    "go on: when another program saves ENV, update and write OUT again"));
    session.add_common_options(command);
    command.on_run([options, &session] {
        options->scene.highlight_rays = options->output.picture.highlight_rays;
        run(*options, session);
    });
}

} // namespace relumine::app
