// Lights that live over several frames of a video environment, so that they do not jump from frame to frame.
// Based on: [S] Staton, Debattista, Bashford-Rogers, Chalmers, "Light clustering for Dynamic Image Based Lighting", Section 3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "lights/frame_lights.h"
#include "lights/frame_samples.h"
#include "lights/k_means.h"

namespace relumine::lights {

/// A light with its span of frames [S, Section 3.3].
struct LightCluster {
    DistantLight
        light; ///< direction: mean of the samples' [S, Eq. 7]; irradiance: their sum over the number of frames [S, Eq. 8]
    std::uint32_t first_frame = 0; ///< f_start
    std::uint32_t last_frame = 0;  ///< f_end, a frame of its span, too
    std::size_t num_samples = 0;

    [[nodiscard]] std::size_t num_frames() const { return std::size_t{last_frame} - first_frame + 1; }
};

struct LightClusters {
    std::size_t num_frames = 0;
    std::vector<LightCluster> clusters; ///< those with samples
    KMeans k_means;                     ///< its cluster_of: [samples]

    /// How many live in a frame on average: as many lights as importance sampling gets when both are compared.
    [[nodiscard]] double mean_live() const;
};

/// Clusters the samples of all frames into lights. Sum of light over all frames: that of the samples.
///
/// Differs from [S]: a frame with the very samples of the one before has its time too, and frames are counted without such repeats. So light that
/// does not change makes lights that do not change, whatever gamma is, and a frame shown twice changes nothing.
/// Throws as k_means() does.
[[nodiscard]] LightClusters cluster_lights(const FrameSamples& samples, const KMeansOptions& options = {});

struct FadeOptions {
    /// Frames over which a light comes and goes, 0: at once, as in [S].
    std::size_t frames = 0;
};

/// The lights of every frame: each in all frames of its span.
[[nodiscard]] FrameLights frame_lights(const LightClusters& clusters, const FadeOptions& fade = {});

/// The baseline of [S]: `lights_per_frame` lights by importance sampling for each frame on its own; options.samples_per_frame is not looked at.
[[nodiscard]] FrameLights importance_lights(const FrameImages& images, std::size_t num_frames,
                                            std::size_t lights_per_frame,
                                            const FrameSamplesOptions& options = {});

/// The irradiance of all lights in all frames.
[[nodiscard]] glm::dvec3 total_irradiance(const FrameLights& lights);

} // namespace relumine::lights
