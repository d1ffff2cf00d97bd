#include "lights/light_clusters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>

namespace relumine::lights {

namespace {

bool same_light(std::span<const FrameSample> a, std::span<const FrameSample> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FrameSample& u, const FrameSample& v) {
        return u.direction == v.direction && u.irradiance == v.irradiance && u.luminance == v.luminance;
    });
}

/// The samples as points of [S, Eq. 4-6]; repeated frames share their time.
std::vector<ClusterPoint> points_of(const FrameSamples& samples) {
    double max_luminance = 0.0;
    std::vector<std::size_t> begin(samples.num_frames + 1, 0);
    for (const FrameSample& sample : samples.samples) {
        max_luminance = std::max(max_luminance, sample.luminance);
        begin[sample.frame + 1] += 1;
    }
    for (std::size_t frame = 0; frame < samples.num_frames; ++frame)
        begin[frame + 1] += begin[frame];

    const std::span<const FrameSample> all(samples.samples);
    std::vector<std::size_t> time(samples.num_frames, 0);
    for (std::size_t frame = 1; frame < samples.num_frames; ++frame) {
        const auto before = all.subspan(begin[frame - 1], begin[frame] - begin[frame - 1]);
        const auto now = all.subspan(begin[frame], begin[frame + 1] - begin[frame]);
        time[frame] = time[frame - 1] + (same_light(before, now) ? 0 : 1);
    }
    const double num_times = time.empty() ? 1.0 : static_cast<double>(time.back() + 1);
    std::vector<ClusterPoint> points;
    points.reserve(all.size());
    for (const FrameSample& sample : all)
        points.push_back({.direction = sample.direction,
                          .luminance = max_luminance > 0.0 ? sample.luminance / max_luminance : 0.0,
                          .time = static_cast<double>(time[sample.frame]) / num_times});
    return points;
}

/// How much of a light's total each frame gets, [num_frames], adding up to 1: the span's box, smoothed over `fade` frames by a raised cosine.
/// What would leave the sequence at an end is reflected there, so a light of all frames stays constant.
std::vector<double> profile(const LightCluster& cluster, std::size_t num_frames, std::size_t fade) {
    const auto last = static_cast<std::ptrdiff_t>(num_frames) - 1;
    const auto reach = static_cast<std::ptrdiff_t>(fade);
    std::vector<double> kernel;
    double sum = 0.0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
        kernel.push_back(
            1.0 + std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(reach + 1)));
        sum += kernel.back();
    }
    std::vector<double> shares(num_frames, 0.0);
    const double height = 1.0 / static_cast<double>(cluster.num_frames());
    for (std::ptrdiff_t frame = cluster.first_frame; frame <= std::ptrdiff_t{cluster.last_frame}; ++frame)
        for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
            std::ptrdiff_t to = frame + k;
            while (to < 0 || to > last)
                to = to < 0 ? -1 - to : 2 * last + 1 - to;
            shares[static_cast<std::size_t>(to)] +=
                height * kernel[static_cast<std::size_t>(k + reach)] / sum;
        }
    return shares;
}

} // namespace

double LightClusters::mean_live() const {
    double sum = 0.0;
    for (const LightCluster& cluster : clusters)
        sum += static_cast<double>(cluster.num_frames());
    return num_frames > 0 ? sum / static_cast<double>(num_frames) : 0.0;
}

LightClusters cluster_lights(const FrameSamples& samples, const KMeansOptions& options) {
    LightClusters result{.num_frames = samples.num_frames, .clusters = {}, .k_means = {}};
    result.k_means = k_means(points_of(samples), options);

    struct Sums {
        LightCluster cluster;
        glm::dvec3 directions{0.0};
    };
    std::vector<Sums> sums(result.k_means.centres.size());
    for (std::size_t i = 0; i < samples.samples.size(); ++i) {
        const FrameSample& sample = samples.samples[i];
        auto& [cluster, directions] = sums[result.k_means.cluster_of[i]];
        cluster.first_frame =
            cluster.num_samples == 0 ? sample.frame : std::min(cluster.first_frame, sample.frame);
        cluster.last_frame = std::max(cluster.last_frame, sample.frame);
        cluster.light.irradiance += sample.irradiance;
        cluster.light.solid_angle += sample.solid_angle;
        directions += sample.direction;
        ++cluster.num_samples;
    }
    for (std::size_t j = 0; j < sums.size(); ++j) {
        auto& [cluster, directions] = sums[j];
        if (cluster.num_samples == 0)
            continue;
        const auto span = static_cast<double>(cluster.num_frames());
        const double length = glm::length(directions);
        // Directions that cancel have no mean: the centre stays.
        cluster.light.direction = length > 1e-9 * static_cast<double>(cluster.num_samples)
                                      ? directions / length
                                      : result.k_means.centres[j].direction; // [S, Eq. 7]
        cluster.light.irradiance /= span;                                    // [S, Eq. 8]
        cluster.light.solid_angle /= span;
        result.clusters.push_back(cluster);
    }
    return result;
}

FrameLights frame_lights(const LightClusters& clusters, const FadeOptions& fade) {
    FrameLights lights{.frames = std::vector<std::vector<DistantLight>>(clusters.num_frames)};
    for (const LightCluster& cluster : clusters.clusters) {
        if (fade.frames == 0) {
            for (std::size_t frame = cluster.first_frame; frame <= cluster.last_frame; ++frame)
                lights.frames[frame].push_back(cluster.light);
            continue;
        }
        const std::vector<double> shares = profile(cluster, clusters.num_frames, fade.frames);
        for (std::size_t frame = 0; frame < shares.size(); ++frame)
            if (shares[frame] > 0.0) {
                DistantLight light = cluster.light;
                const double factor = shares[frame] * static_cast<double>(cluster.num_frames());
                light.irradiance *= factor;
                light.solid_angle *= factor;
                lights.frames[frame].push_back(light);
            }
    }
    return lights;
}

FrameLights importance_lights(const FrameImages& images, std::size_t num_frames, std::size_t lights_per_frame,
                              const FrameSamplesOptions& options) {
    FrameSamplesOptions sampling = options;
    sampling.samples_per_frame = lights_per_frame;
    const FrameSamples samples = sample_frames(images, num_frames, sampling);
    FrameLights lights{.frames = std::vector<std::vector<DistantLight>>(num_frames)};
    for (const FrameSample& sample : samples.samples)
        lights.frames[sample.frame].push_back({.direction = sample.direction,
                                               .irradiance = sample.irradiance,
                                               .solid_angle = sample.solid_angle});
    return lights;
}

glm::dvec3 total_irradiance(const FrameLights& lights) {
    glm::dvec3 sum(0.0);
    for (const std::vector<DistantLight>& frame : lights.frames)
        sum += total_irradiance(frame);
    return sum;
}

} // namespace relumine::lights
