// The experiment of Staton et al., "Light clustering for Dynamic Image Based Lighting", Section 4:
// how much an animation flickers that is lit by clustered lights, by importance sampling of every
// frame, and by Relumine's own transfer. On a sun that moves through the sky and a probe that
// turns.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data_gen/sequences.h"
#include "lights/light_clusters.h"
#include "lights/luminance.h"
#include "lights/place_lights.h"
#include "relight/reference/flicker.h"
#include "relight/sharp/shadow_rays.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"
#include "tests/lights/importance_lights.h"

using namespace relumine;

namespace {

constexpr double PaperImportance = 0.00262;
constexpr double PaperClusters = 0.00125;
constexpr const char* Importance = "importance";
constexpr const char* EvenClusters = "clusters, even [S, Eq. 8]";
constexpr const char* FollowedClusters = "clusters, followed";
/// Frames are exposed so that the ground truth's mean luminance is this
constexpr double MeanLuminance = 0.25;

struct Settings {
    std::size_t num_frames = 100;
    std::size_t num_receivers = 300;
    std::uint32_t resolution = 128;
    std::size_t num_samples = 1024;
    std::size_t num_clusters = 512;
    std::uint64_t seed = 1;
    bool variants = false;
};

struct Sequence {
    std::string name;
    data_gen::FrameMaker map;
};

/// Those of `relumine generate sequence` that the tables of docs/measurements.md show.
std::vector<Sequence> sequences(const Settings& settings, const bench::Inputs& inputs) {
    std::vector<Sequence> result;
    for (const data_gen::Sequence& sequence : data_gen::sequences()) {
        data_gen::SequenceOptions options{.num_frames = settings.num_frames,
                                          .face_resolution = settings.resolution};
        if (sequence.name == "sun") {
            result.push_back({"sun", sequence.make(options)});
        } else if (sequence.name == "turn") {
            try {
                options.probe = inputs.environment("grace_cross.hdr", settings.resolution);
                result.push_back({"turn, grace", sequence.make(options)});
            } catch (const bench::Absent& absent) {
                fmt::print("turn: skipped, {}\n", absent.what());
            }
        }
    }
    return result;
}

/// One method's figures on one sequence.
struct Row {
    std::string method;
    /// A frame, mean
    double lights = 0.0;
    relight::FlickerReport report;
    /// A frame: sampling and clustering
    double seconds_prepare = 0.0;
    /// A frame: all vertices
    double seconds_light = 0.0;
};

class Experiment {
public:
    Experiment(const Settings& settings, LitScene& lit)
        : settings_(settings), lit_(lit),
          sample_(relight::random_receivers(lit.scene().transfer, settings.num_receivers, 1)) {}

    std::vector<Row> run(const Sequence& sequence) {
        rows_.clear();
        images_.clear();
        integrate(sequence);
        const lights::FrameImages images = [&](std::size_t frame) {
            return images_[frame];
        };
        const auto sampled = [&](bool seed_per_frame, double& seconds) {
            seconds = 0.0;
            bench::Stopwatch watch;
            // the clock stands while a frame is made
            const lights::FrameImages timed = [&](std::size_t frame) {
                if (frame > 0)
                    seconds += watch.seconds();
                cubemap::EnvironmentImage image = images(frame);
                watch.restart();
                return image;
            };
            lights::FrameSamples samples =
                lights::sample_frames(timed, settings_.num_frames,
                                      {.samples_per_frame = settings_.num_samples,
                                       .seed = settings_.seed,
                                       .seed_per_frame = seed_per_frame});
            seconds += watch.seconds();
            return samples;
        };
        double seconds_sample = 0.0;
        const lights::FrameSamples samples = sampled(false, seconds_sample);
        const lights::LightClusters clusters = cluster(samples);
        const auto num_lights = static_cast<std::size_t>(std::lround(clusters.mean_live()));
        const double per_frame = 1.0 / static_cast<double>(settings_.num_frames);

        const double seconds_importance = seconds_sample * per_frame *
                                          static_cast<double>(num_lights) /
                                          static_cast<double>(settings_.num_samples);
        lights::FrameSamplesOptions baseline{
            .seed = settings_.seed, .seed_per_frame = true, .stratified = false};
        const auto add_importance = [&](const char* name) {
            add(name, lights::importance_lights(images, settings_.num_frames, num_lights, baseline),
                seconds_importance);
        };
        add_importance(Importance);
        baseline.stratified = true;
        add_importance("importance, stratified");
        baseline.seed_per_frame = false;
        add_importance("importance, stratified, one seed");

        const double seconds_clusters = (seconds_sample + clusters.k_means.seconds) * per_frame;
        add(EvenClusters, lights::frame_lights(clusters, {.strength = lights::Strength::Even}),
            seconds_clusters);
        add(FollowedClusters, lights::frame_lights(clusters), seconds_clusters);
        add("clusters, followed, fade 2", lights::frame_lights(clusters, {.fade = 2}),
            seconds_clusters);
        if (settings_.variants) {
            for (const lights::Strength strength :
                 {lights::Strength::Even, lights::Strength::Followed})
                for (const std::size_t fade : {1u, 4u, 8u})
                    add(fmt::format("clusters, {}, fade {}",
                                    strength == lights::Strength::Even ? "even" : "followed", fade),
                        lights::frame_lights(clusters, {.strength = strength, .fade = fade}),
                        seconds_clusters);
            double seconds_fresh = 0.0;
            const lights::LightClusters other = cluster(sampled(true, seconds_fresh));
            for (const lights::Strength strength :
                 {lights::Strength::Even, lights::Strength::Followed}) {
                const char* name = strength == lights::Strength::Even ? "even" : "followed";
                add(fmt::format("clusters, {}, a seed per frame", name),
                    lights::frame_lights(other, {.strength = strength}),
                    (seconds_fresh + other.k_means.seconds) * per_frame);
            }
        }
        rows_.push_back(prt_);
        return rows_;
    }

    [[nodiscard]] std::size_t num_receivers() const { return sample_.size(); }

private:
    /// Ground truth, and the transfer's frames beside it.
    void integrate(const Sequence& sequence) {
        exact_.clear();
        std::vector<std::vector<glm::dvec3>> relit;
        std::vector<double> seconds;
        double luminance = 0.0;
        for (std::size_t frame = 0; frame < settings_.num_frames; ++frame) {
            fmt::print(stderr, "\r{}: exact integration of frame {} of {} ", sequence.name,
                       frame + 1, settings_.num_frames);
            const cubemap::CubeMap map = sequence.map(frame);
            exact_.push_back(relight::exact_radiance(lit_.scene().receivers, sample_,
                                                     lit_.rays().of_mesh(), map,
                                                     {.bias = lit_.scene().settings.bias}));
            images_.push_back(lights::lat_long_of(map));
            for (const glm::dvec3& value : exact_.back())
                luminance += lights::luminance(value);
            const UpdateReport times = lit_.light(map);
            seconds.push_back(times.seconds_bin + times.seconds_relight + times.seconds_trace);
            relit.emplace_back();
            for (const std::uint32_t receiver : sample_)
                relit.back().emplace_back(lit_.radiance()[receiver]);
        }
        fmt::print(stderr, "\n");
        exposure_ = MeanLuminance * static_cast<double>(exact_.size() * sample_.size()) / luminance;
        prt_ = {.method = "prt",
                .report = relight::measure_flicker(relit, exact_, exposure_),
                .seconds_light = bench::median(seconds)};
    }

    [[nodiscard]] lights::LightClusters cluster(const lights::FrameSamples& samples) const {
        lights::KMeansOptions options;
        options.num_clusters = settings_.num_clusters;
        options.seed = settings_.seed;
        lights::LightClusters result = lights::cluster_lights(samples, options);
        const lights::KMeans& k = result.k_means;
        fmt::print(stderr,
                   "{} samples into {} clusters: {} iterations{}, {:.2f} s, objective {:.4g} -> "
                   "{:.4g}, {} "
                   "reseeded, {} empty, {:.1f} % searched, {:.1f} lights live\n",
                   samples.samples.size(), result.clusters.size(), k.objective.size(),
                   k.converged ? "" : " (not converged)", k.seconds, k.objective.front(),
                   k.objective.back(), k.num_reseeded, k.num_empty,
                   100.0 * static_cast<double>(k.num_searches) /
                       static_cast<double>(samples.samples.size() * k.objective.size()),
                   result.mean_live());
        return result;
    }

    void add(const std::string& method, const lights::FrameLights& frames, double seconds_prepare) {
        relight::FlickerMeter meter(exposure_);
        Row row{.method = method, .report = {}, .seconds_prepare = seconds_prepare};
        for (std::size_t frame = 0; frame < frames.num_frames(); ++frame) {
            meter.add_frame(relight::radiance_under(frames.at(frame),
                                                    lit_.scene().receivers.normals, sample_,
                                                    lit_.relighter().shadow_rays()),
                            exact_[frame]);
            row.lights += static_cast<double>(frames.at(frame).size()) /
                          static_cast<double>(frames.num_frames());
        }
        row.report = meter.report();
        if (settings_.variants) { // light alone
            rows_.push_back(std::move(row));
            return;
        }
        std::vector<double> seconds;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t frame = i * (frames.num_frames() - 1) / 2;
            const std::span<const lights::DistantLight> list = frames.at(frame);
            const UpdateReport times =
                lit_.light(std::vector<lights::DistantLight>(list.begin(), list.end()));
            seconds.push_back(times.seconds_bin + times.seconds_relight + times.seconds_trace);
        }
        row.seconds_light = bench::median(seconds);
        rows_.push_back(std::move(row));
    }

    const Settings& settings_;
    LitScene& lit_;
    std::vector<std::uint32_t> sample_;

    /// [frames] as lat-longs
    std::vector<cubemap::EnvironmentImage> images_;
    /// [frames][receivers]
    std::vector<std::vector<glm::dvec3>> exact_;
    double exposure_ = 1.0;
    Row prt_;
    std::vector<Row> rows_;
};

void print_rows(const Sequence& sequence, const std::vector<Row>& rows) {
    fmt::print("\n### {}\n\n| method | lights | inconsistency | of importance | relative L2 | "
               "prepare, ms a "
               "frame | light, ms a frame |\n|---|---|---|---|---|---|---|\n",
               sequence.name);
    fmt::print("| importance, paper | 200 | {:.5f} | 1 | - | - | - |\n", PaperImportance);
    fmt::print("| clusters, paper | 200 | {:.5f} | {:.2f} | - | - | - |\n", PaperClusters,
               PaperClusters / PaperImportance);
    const double importance = rows.front().report.mean_inconsistency;
    for (const Row& row : rows)
        fmt::print("| {} | {} | {:.6f} | {:.4f} | {:.4f} | {} | {} |\n", row.method,
                   row.lights > 0.0 ? fmt::format("{:.0f}", row.lights) : "-",
                   row.report.mean_inconsistency, row.report.mean_inconsistency / importance,
                   row.report.mean_relative_l2,
                   row.seconds_prepare > 0.0 ? fmt::format("{:.1f}", 1e3 * row.seconds_prepare)
                                             : "-",
                   row.seconds_light > 0.0 ? fmt::format("{:.0f}", 1e3 * row.seconds_light) : "-");
}

void run(const Settings& settings, const bench::Inputs& inputs) {
    LitScene lit(inputs.bunny());
    Experiment experiment(settings, lit);
    fmt::print("Bunny, {} vertices; {} frames at R = {}; ground truth by exact integration for {} "
               "vertices; {} clusters from {} samples a frame\n",
               lit.scene().mesh.num_vertices(), settings.num_frames, settings.resolution,
               experiment.num_receivers(), settings.num_clusters, settings.num_samples);
    for (const Sequence& sequence : sequences(settings, inputs))
        print_rows(sequence, experiment.run(sequence));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_video", "Staton et al.'s flicker experiment; Markdown on "
                                          "stdout");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--frames", settings.num_frames, "of each sequence, 2 or more");
    program.add("--receivers", settings.num_receivers, "vertices that are integrated exactly");
    program.add("--face-resolution", settings.resolution, "R");
    program.add("--samples", settings.num_samples, "of each frame");
    program.add("--clusters", settings.num_clusters, "of lights");
    program.add("--seed", settings.seed, "of the samples");
    program.add_flag("--variants", settings.variants, "also other fades, and a seed per frame");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny()) {
            settings.num_frames = 4;
            settings.num_receivers = 20;
            settings.resolution = 16;
            settings.num_samples = 64;
            settings.num_clusters = 16;
        }
        if (settings.num_frames < 2)
            throw std::invalid_argument("--frames: expected at least 2");
        run(settings, inputs);
    });
}
