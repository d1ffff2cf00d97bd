#include "lights/light_clusters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>

#include "lights/lat_long_grid.h"

namespace relumine::lights {

namespace {

bool same_light(std::span<const FrameSample> a, std::span<const FrameSample> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const FrameSample& u, const FrameSample& v) {
                          return u.direction == v.direction && u.irradiance == v.irradiance &&
                                 u.luminance == v.luminance;
                      });
}

/// Returns the samples as points of [S, Eq. 4-6]. Repeated frames share their time.
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

/// Returns a raised cosine from -reach to reach that adds up to 1.
std::vector<double> fade_kernel(std::size_t reach) {
    std::vector<double> kernel(2 * reach + 1);
    double sum = 0.0;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
        const double place = static_cast<double>(k) - static_cast<double>(reach);
        kernel[k] = 1.0 + std::cos(std::numbers::pi * place / static_cast<double>(reach + 1));
        sum += kernel[k];
    }
    for (double& weight : kernel)
        weight /= sum;
    return kernel;
}

/// Returns the strengths, smoothed. What would leave the sequence at an end is reflected there, so
/// the total stays and a constant stays constant.
std::vector<glm::dvec3> faded(const std::vector<glm::dvec3>& strengths,
                              const std::vector<double>& kernel) {
    const auto last = static_cast<std::ptrdiff_t>(strengths.size()) - 1;
    const auto reach = static_cast<std::ptrdiff_t>(kernel.size() / 2);
    std::vector<glm::dvec3> result(strengths.size(), glm::dvec3(0.0));
    for (std::ptrdiff_t frame = 0; frame <= last; ++frame) {
        const glm::dvec3& strength = strengths[static_cast<std::size_t>(frame)];
        if (strength == glm::dvec3(0.0))
            continue;
        for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
            std::ptrdiff_t to = frame + k;
            while (to < 0 || to > last)
                to = to < 0 ? -1 - to : 2 * last + 1 - to;
            result[static_cast<std::size_t>(to)] +=
                kernel[static_cast<std::size_t>(k + reach)] * strength;
        }
    }
    return result;
}

/// Returns the light's irradiance in every frame of the sequence.
std::vector<glm::dvec3> strengths(const LightCluster& cluster, std::size_t num_frames,
                                  Strength strength) {
    std::vector<glm::dvec3> result(num_frames, glm::dvec3(0.0));
    for (std::size_t i = 0; i < cluster.num_frames(); ++i)
        result[cluster.first_frame + i] =
            strength == Strength::Even ? cluster.light.irradiance : cluster.frame_irradiance[i];
    return result;
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
        // Samples come frame after frame, so the span ends here for now.
        cluster.frame_irradiance.resize(cluster.num_frames(), glm::dvec3(0.0));
        cluster.frame_irradiance.back() += sample.irradiance;
        ++cluster.num_samples;
    }
    for (std::size_t j = 0; j < sums.size(); ++j) {
        auto& [cluster, directions] = sums[j];
        if (cluster.num_samples == 0)
            continue;
        const auto span = static_cast<double>(cluster.num_frames());
        const double length = glm::length(directions);
        // Directions that cancel have no mean. The centre then stays.
        cluster.light.direction = length > 1e-9 * static_cast<double>(cluster.num_samples)
                                      ? directions / length
                                      : result.k_means.centres[j].direction; // [S, Eq. 7]
        cluster.light.irradiance /= span;                                    // [S, Eq. 8]
        cluster.light.solid_angle /= span;
        result.clusters.push_back(cluster);
    }
    return result;
}

FrameLights frame_lights(const LightClusters& clusters, const StrengthOptions& options) {
    FrameLights lights{.frames = std::vector<std::vector<DistantLight>>(clusters.num_frames)};
    const std::vector<double> kernel = fade_kernel(options.fade);
    for (const LightCluster& cluster : clusters.clusters) {
        std::vector<glm::dvec3> irradiance =
            strengths(cluster, clusters.num_frames, options.strength);
        if (options.fade > 0)
            irradiance = faded(irradiance, kernel);
        const double mean = luminance(cluster.light.irradiance);
        for (std::size_t frame = 0; frame < irradiance.size(); ++frame)
            if (irradiance[frame] != glm::dvec3(0.0))
                lights.frames[frame].push_back(
                    {.direction = cluster.light.direction,
                     .irradiance = irradiance[frame],
                     .solid_angle = cluster.light.solid_angle *
                                    (mean > 0.0 ? luminance(irradiance[frame]) / mean : 1.0)});
    }
    return lights;
}

glm::dvec3 total_irradiance(const FrameLights& lights) {
    glm::dvec3 sum(0.0);
    for (const std::vector<DistantLight>& frame : lights.frames)
        sum += total_irradiance(frame);
    return sum;
}

} // namespace relumine::lights
