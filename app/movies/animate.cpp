// A scene under an environment that changes over time, frame by frame: the next frame is loaded and
// binned while this one is relit and written.
#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/movies/animate_options.h"
#include "app/movies/frame_record.h"
#include "app/movies/movie.h"
#include "app/options/receiver_options.h"
#include "app/scenes/lit_scene.h"
#include "files/output_file.h"
#include "relumine/ask/environment_doctor.h"
#include "relumine/ask/reference.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/light_lists.h"
#include "relumine/light/light_parts.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

/// Lights of --method importance in a frame
constexpr std::size_t ImportanceLights = 64;

/// A frame as it lights the scene.
struct PreparedFrame {
    /// --method prt
    relight::BinnedEnvironment binned = {};
    /// The others, where pictures are drawn
    cubemap::CubeMap background = {};
    relight::Backdrop sharp = {};
    std::vector<lights::DistantLight> lights = {};
    double seconds_load = 0.0, seconds_resample = 0.0, seconds_bin = 0.0;
};

/// Sums over the frames.
struct Totals {
    double seconds_load = 0.0, seconds_resample = 0.0, seconds_bin = 0.0, seconds_wait = 0.0,
           seconds_relight = 0.0, seconds_trace = 0.0, seconds_write = 0.0;
    std::size_t num_clusters = 0, num_resummed = 0, num_lit = 0;
};

class Animation {
public:
    Animation(const AnimateOptions& options, const cubemap::FrameSequence& sequence,
              Session& session)
        : options_(options), sequence_(sequence), session_(session),
          pattern_(options.output_pattern()), lit_(lit_scene(options.scene, session)),
          binner_(relight::binner_of(lit_.relighter())),
          writer_(lit_, options.output.for_scene(scene())) {
        static_cast<void>(options.bounces.applies_to(scene(), options.scene.path));
        lit_.dim(options.output.picture.emission);
        OutputOptions seen = options.output;
        if (options.moves_camera() && pattern_) {
            require_vertices(scene(), options.scene.path);
            camera_ = camera_of(scene(), options.output.for_scene(scene()));
            seen.picture.camera = camera_of_frame(std::min<std::size_t>(1, sequence.size() - 1));
        }
        if (session.is_first())
            seen.warn_of_picture(scene(), session);
    }

    void run() {
        if (pattern_)
            options_.output.check_fits(scene());
        seconds_load_scene_ = watch_.lap();
        session_.poll();
        choose_frames();
        if (options_.method == "clusters" && !todo_.empty())
            cluster_frames();
        meter_frames();
        std::optional<relight::NpyFrames> vertices;
        if (!options_.vertices.empty() && session_.is_first())
            vertices.emplace(options_.vertices, sequence_.size(), scene().receivers.num_own());
        const auto progress = session_.progress("frames");
        cubemap::ReadAhead<PreparedFrame> ahead(
            todo_.size(), [this](std::size_t i) { return prepare(todo_[i]); });
        for (std::size_t i = 0; i < todo_.size(); ++i) {
            session_.poll();
            Stopwatch watch;
            PreparedFrame frame = ahead.get(i);
            totals_.seconds_wait += watch.lap();
            count(frame, light(frame));
            bounce();
            const double seconds_relight = watch.lap();
            totals_.seconds_relight += seconds_relight;
            seconds_relight_frames_.push_back(seconds_relight);
            Lighting lighting = lit_.lighting(is_drawn(todo_[i]));
            if (vertices)
                vertices->append(writer_.values(lighting.radiance));
            if (session_.is_first())
                write(todo_[i], std::move(lighting), frame);
            totals_.seconds_write += watch.lap();
            ++totals_.num_lit;
            if (!options_.output.path.empty())
                set_cancelled_message(cancelled_message());
            if (progress)
                progress(static_cast<double>(i + 1) / static_cast<double>(todo_.size()));
        }
        session_.end_progress();
        if (vertices)
            vertices->commit();
        if (!session_.is_first())
            return;
        if (!options_.reference.empty())
            measure();
        seconds_frames_ = watch_.lap();
        const Patience for_ffmpeg;
        if (!options_.movie.empty())
            make_movie(find_ffmpeg(options_.movie), options_.movie, output_paths(),
                       options_.frames_per_second, session_.stop());
        report();
    }

    [[nodiscard]] std::string cancelled_message() const {
        return fmt::format("cancelled; {} of {} frames are written, --resume goes on",
                           num_kept_ + num_written_, sequence_.size());
    }

private:
    [[nodiscard]] std::string output_path(std::size_t frame) const {
        return pattern_->name(sequence_.number(frame));
    }
    [[nodiscard]] std::vector<std::string> output_paths() const {
        std::vector<std::string> paths;
        for (std::size_t frame = 0; frame < sequence_.size(); ++frame)
            paths.push_back(output_path(frame));
        return paths;
    }

    [[nodiscard]] const Scene& scene() const { return lit_.scene(); }

    /// The camera on its path, or turned about its target.
    [[nodiscard]] Camera camera_of_frame(std::size_t frame) const {
        if (options_.camera_path)
            return options_.camera_on_path(sequence_.number(frame), *camera_).in(scene().mesh);
        Camera camera = *camera_;
        camera.eye = camera.target + glm::vec3(cubemap::turn_about_y(options_.turn_degrees(frame)) *
                                               glm::dvec3(camera.eye - camera.target));
        return camera;
    }
    void look_at(std::size_t frame) {
        if (camera_)
            writer_.look_from(camera_of_frame(frame));
    }

    /// Whether the frame is to be a picture.
    [[nodiscard]] bool is_drawn(std::size_t frame) const { return pattern_ && !is_there_[frame]; }

    /// Those that are not there yet; all of them where one file holds all.
    void choose_frames() {
        if (pattern_ && session_.is_first())
            record_.emplace(fmt::format("{}.done", pattern_->name_of_all("all")),
                            options_.settings(sequence_), options_.resume);
        for (std::size_t frame = 0; frame < sequence_.size(); ++frame) {
            const bool is_there =
                record_ && record_->is_done(sequence_.number(frame), sequence_.path(frame),
                                            output_path(frame));
            is_there_.push_back(is_there);
        }
        is_there_ = agreed(std::move(is_there_));
        for (std::size_t frame = 0; frame < sequence_.size(); ++frame) {
            const bool is_there = is_there_[frame];
            num_kept_ += static_cast<std::size_t>(is_there);
            if (!is_there || !options_.vertices.empty())
                todo_.push_back(frame);
        }
        if (options_.resume)
            session_.say(
                fmt::format("{} of {} frames are there already", num_kept_, sequence_.size()));
    }

    /// Chooses one exposure for all frames from up to nine of them, or keeps to that of the frames
    /// that are there.
    void meter_frames() {
        if (!pattern_ || todo_.empty() || !writer_.needs_light_for(options_.output.path))
            return;
        const std::optional<double> before =
            record_ ? record_->exposure_ev() : std::optional<double>();
        if (before)
            writer_.set_exposure_ev(*before);
        if (agreed({before.has_value()})[0])
            return;
        constexpr std::size_t MostFrames = 9;
        const std::size_t last = sequence_.size() - 1;
        const std::size_t num_gaps = std::min(MostFrames - 1, last);
        for (std::size_t i = 0; i <= num_gaps; ++i) {
            session_.poll();
            const std::size_t index = num_gaps == 0 ? 0 : i * last / num_gaps;
            PreparedFrame frame = prepare(index);
            static_cast<void>(light(frame));
            bounce();
            const Lighting lighting = lit_.lighting();
            if (!session_.is_first())
                continue;
            look_at(index);
            writer_.meter(lighting);
            if (i == num_gaps)
                record_->set_exposure_ev(writer_.choose_exposure_ev(lighting));
        }
        // The frames' differences must not depend on the exposure.
        lit_.light({});
    }

    /// A frame's image as it lights the scene: turned and of the resolution that was asked for.
    [[nodiscard]] cubemap::EnvironmentImage image_of(std::size_t frame) const {
        cubemap::EnvironmentImage image = sequence_.read(frame);
        const EnvironmentOptions environment = options_.environment_at(frame);
        if (world_from_image(image.layout, environment) == glm::dmat3(1.0) &&
            environment.face_resolution == 0)
            return image;
        return lights::lat_long_of(cube_map_of(image, environment));
    }

    void cluster_frames() {
        Stopwatch watch;
        const lights::FrameSamples samples = lights::sample_frames(
            [this](std::size_t frame) { return image_of(frame); }, sequence_.size(),
            {.stop = session_.stop(), .on_progress = session_.progress("samples")});
        session_.end_progress();
        session_.poll();
        const lights::LightClusters clusters = lights::cluster_lights(
            samples,
            {.num_clusters = options_.num_lights.value_or(lights::KMeansOptions{}.num_clusters),
             .stop = session_.stop()});
        session_.poll();
        frame_lights_ = lights::frame_lights(clusters);
        const lights::KMeans& means = clusters.k_means;
        session_.say(fmt::format(
            "{} samples in {} clusters, {} iterations{}, objective {:.4g} to {:.4g}, {} started "
            "again, {:.1f} s; {:.1f} lights live in a frame",
            samples.samples.size(), clusters.clusters.size(), means.objective.size(),
            means.converged ? "" : " (not converged)",
            means.objective.empty() ? 0.0 : means.objective.front(),
            means.objective.empty() ? 0.0 : means.objective.back(), means.num_reseeded, watch.lap(),
            clusters.mean_live()));
        extra_report_ = {
            {"samples", samples.samples.size()}, {"light_clusters", clusters.clusters.size()},
            {"objective", means.objective},      {"reseeded", means.num_reseeded},
            {"converged", means.converged},      {"mean_live_lights", clusters.mean_live()},
            {"seconds_k_means", means.seconds}};
    }

    void measure() {
        const std::filesystem::path own(options_.vertices);
        const std::filesystem::path reference(options_.reference);
        const relight::FlickerReport flicker = relight::measure_flicker({&own, 1}, {&reference, 1});
        session_.say(fmt::format(
            "{}: temporal inconsistency {:.5g} on average, {:.5g} at worst; relative L2 {:.5g}",
            options_.vertices, flicker.mean_inconsistency, flicker.worst_inconsistency,
            flicker.mean_relative_l2));
        extra_report_.set("mean_inconsistency", flicker.mean_inconsistency);
        extra_report_.set("inconsistency", flicker.inconsistency);
        extra_report_.set("mean_relative_l2", flicker.mean_relative_l2);
        extra_report_.set("relative_l2", flicker.relative_l2);
    }

    /// Runs on another thread; touches no state but the binner, has_warned_ and still_.
    PreparedFrame prepare(std::size_t frame) {
        if (still_)
            return *still_;
        PreparedFrame result = prepare_anew(frame);
        if ((options_.turntable.num_frames > 0 || options_.camera_path) &&
            sequence_.path(0) == sequence_.path(sequence_.size() - 1) &&
            !options_.turns_environment())
            still_ = result;
        return result;
    }

    PreparedFrame prepare_anew(std::size_t frame) {
        PreparedFrame result;
        Stopwatch watch;
        auto image = std::make_shared<const cubemap::EnvironmentImage>(sequence_.read(frame));
        result.seconds_load = watch.lap();
        EnvironmentOptions environment = options_.environment_at(frame);
        cubemap::CubeMap map = cube_map_of(*image, environment);
        if (pattern_)
            result.sharp = backdrop_of(image, environment);
        result.seconds_resample = watch.lap();
        // One warning is enough for all frames.
        if (!has_warned_) {
            environment.path = sequence_.path(frame).string();
            has_warned_ = warn_about(environment, *image, cubemap::light_from_below(map), session_);
        }
        try {
            if (options_.method == "prt") {
                result.binned = binner_.bin(std::move(map));
            } else {
                result.lights = options_.method == "clusters"
                                    ? frame_lights_.frames.at(frame)
                                    : lights::place_lights(
                                          lights::Method::Importance, map,
                                          options_.num_lights.value_or(ImportanceLights),
                                          1 + static_cast<std::uint64_t>(sequence_.number(frame)));
                result.background = std::move(map);
            }
        } catch (const std::invalid_argument& error) { // a radiance beyond all bounds
            throw std::runtime_error(
                fmt::format("{}: {}", sequence_.path(frame).string(), error.what()));
        }
        result.seconds_bin = watch.lap();
        return result;
    }

    UpdateReport light(PreparedFrame& frame) {
        if (options_.method != "prt")
            return lit_.light(std::move(frame.lights));
        return lit_.light(Light(std::move(frame.binned)));
    }

    /// Adds the bounces, where there are any.
    void bounce() {
        if (lit_.bounces().is_set())
            lit_.bounce();
        else
            options_.bounces.bounce(lit_, options_.output.for_scene(scene()), options_.scene.path);
    }

    /// What the first process says.
    [[nodiscard]] std::vector<bool> agreed(std::vector<bool> own) const {
        std::vector<std::byte> bytes(own.size());
        std::transform(own.begin(), own.end(), bytes.begin(),
                       [](bool flag) { return static_cast<std::byte>(flag ? 1 : 0); });
        std::vector<bool> result;
        for (const std::byte byte : session_.processes().broadcast(std::move(bytes)))
            result.push_back(byte != std::byte{0});
        return result;
    }

    void count(const PreparedFrame& frame, const UpdateReport& update) {
        totals_.seconds_load += frame.seconds_load;
        totals_.seconds_resample += frame.seconds_resample;
        totals_.seconds_bin += frame.seconds_bin;
        totals_.seconds_trace += update.seconds_trace;
        if (options_.method != "prt")
            return;
        totals_.num_clusters += update.num_clusters;
        totals_.num_resummed += static_cast<std::size_t>(update.resummed);
    }

    void write(std::size_t frame, Lighting lighting, const PreparedFrame& prepared) {
        if (!is_drawn(frame))
            return;
        const std::string path = output_path(frame);
        if (prepared.background.resolution != 0)
            lighting.environment = &prepared.background;
        lighting.sharp = prepared.sharp;
        look_at(frame);
        writer_.save(path, lighting);
        record_->add(sequence_.number(frame), sequence_.path(frame), path);
        ++num_written_;
    }

    void report() {
        const double per_frame =
            totals_.num_lit == 0 ? 0.0 : 1e3 / static_cast<double>(totals_.num_lit);
        const double relight_ms = per_frame * totals_.seconds_relight;
        session_.say(fmt::format(
            "{}: {} frames by {}, per frame: relight {:.1f} ms{}, write {:.0f} ms; beside that "
            "load {:.0f}, "
            "resample {:.0f}, bin {:.1f} ms; {:.1f} frames/s in all{}",
            options_.output.path.empty() ? options_.vertices : options_.output.path,
            totals_.num_lit, options_.method, relight_ms,
            totals_.seconds_trace > 0.0
                ? fmt::format(" (shadow rays {:.1f} ms)", per_frame * totals_.seconds_trace)
                : "",
            per_frame * totals_.seconds_write, per_frame * totals_.seconds_load,
            per_frame * totals_.seconds_resample, per_frame * totals_.seconds_bin,
            seconds_frames_ > 0.0 ? static_cast<double>(totals_.num_lit) / seconds_frames_ : 0.0,
            num_written_ == 0 ? "" : options_.output.exposure_text(writer_)));
        Report result = {{"frames", sequence_.size()},
                         {"exposure", writer_.exposure_ev(options_.output.path)},
                         {"frames_lit", totals_.num_lit},
                         {"frames_kept", num_kept_},
                         {"frames_resummed", totals_.num_resummed},
                         {"clusters", scene().transfer.num_clusters()},
                         {"clusters_changed", totals_.num_clusters},
                         {"receivers", scene().transfer.num_receivers()},
                         {"method", options_.method},
                         {"seconds_load_scene", seconds_load_scene_},
                         {"seconds_load", totals_.seconds_load},
                         {"seconds_resample", totals_.seconds_resample},
                         {"seconds_bin", totals_.seconds_bin},
                         {"seconds_wait", totals_.seconds_wait},
                         {"seconds_relight", totals_.seconds_relight},
                         {"seconds_relight_frames", seconds_relight_frames_},
                         {"seconds_trace", totals_.seconds_trace},
                         {"seconds_write", totals_.seconds_write},
                         {"seconds_frames", seconds_frames_}};
        files::update(result, extra_report_);
        session_.report(result);
    }

    const AnimateOptions& options_;
    const cubemap::FrameSequence& sequence_;
    Session& session_;
    Stopwatch watch_;
    std::optional<cubemap::FramePattern> pattern_;
    LitScene lit_;
    relight::EnvironmentBinner binner_;
    Painter writer_;
    /// Camera of --turntable at its first frame. Its field of view also serves a path without one.
    std::optional<Camera> camera_;
    /// The environment that lights all frames.
    std::optional<PreparedFrame> still_;
    std::optional<FrameRecord> record_;
    std::vector<bool> is_there_;
    std::vector<std::size_t> todo_;
    std::size_t num_kept_ = 0, num_written_ = 0;
    Totals totals_;
    /// --method clusters
    lights::FrameLights frame_lights_;
    Report extra_report_;
    std::vector<double> seconds_relight_frames_;
    bool has_warned_ = false;
    double seconds_load_scene_ = 0.0, seconds_frames_ = 0.0;
};

void run(const AnimateOptions& options, Session& session) {
    const cubemap::FrameSequence sequence(options.frame_files(),
                                          [&](const std::filesystem::path& path) {
                                              EnvironmentOptions environment = options.environment;
                                              environment.path = path.string();
                                              return load_image(environment, session);
                                          });
    // The first of several processes writes.
    if (session.is_first())
        options.check(sequence);
    Animation animation(options, sequence, session);
    try {
        animation.run();
    } catch (const prt::Cancelled&) {
        if (options.output.path.empty())
            throw;
        throw std::runtime_error(animation.cancelled_message());
    }
}

} // namespace

void add_animate(Command& program, Session& session) {
    Command command = program.add_command(
        "animate", "light a scene with a sequence of environments: pictures, a movie or numbers");
    auto options = std::make_shared<AnimateOptions>();
    options->add_to(command);
    session.add_common_options(command);
    command.on_run([options, &session] {
        options->scene.highlight_rays = options->output.picture.highlight_rays;
        options->load_camera();
        run(*options, session);
    });
}

} // namespace relumine::app
