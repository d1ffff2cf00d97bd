// Lights that live over several frames of a video environment, so that they do not jump from frame
// to frame. Based on: [S] Staton, Debattista, Bashford-Rogers, Chalmers, "Light clustering for
// Dynamic Image Based Lighting", Section 3.
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
    /// Direction: mean of the samples' [S, Eq. 7]. Irradiance: their sum over the number of frames
    /// [S, Eq. 8].
    DistantLight light;
    /// f_start
    std::uint32_t first_frame = 0;
    /// f_end, a frame of its span, too
    std::uint32_t last_frame = 0;
    std::size_t num_samples = 0;
    /// [num_frames()] of the samples of each frame of the span
    std::vector<glm::dvec3> frame_irradiance;

    [[nodiscard]] std::size_t num_frames() const {
        return std::size_t{last_frame} - first_frame + 1;
    }
};

struct LightClusters {
    std::size_t num_frames = 0;
    /// Those with samples
    std::vector<LightCluster> clusters;
    /// Its cluster_of: [samples]
    KMeans k_means;

    /// How many live in a frame on average: as many lights as importance sampling gets when both
    /// are compared.
    [[nodiscard]] double mean_live() const;
};

/// Clusters the samples of all frames into lights. Sum of light over all frames: that of the
/// samples.
///
/// Differs from [S]: a frame with the very samples of the one before has its time too, and frames
/// are counted without such repeats. So light that does not change makes lights that do not change,
/// whatever gamma is, and a frame shown twice changes nothing. Throws as k_means() does.
[[nodiscard]] LightClusters cluster_lights(const FrameSamples& samples,
                                           const KMeansOptions& options = {});

/// How strong a light is over the frames of its span.
enum class Strength {
    /// The same in all frames [S, Eq. 8]: where the spans of two lights overlap, both shine in full
    Even,
    /// In each frame that of its samples: each frame has the power of its environment
    Followed,
};

struct StrengthOptions {
    Strength strength = Strength::Followed;
    /// Frames over which a change of strength is drawn out before and after, by a raised cosine; 0:
    /// not at all, as in [S]. The total stays.
    std::size_t fade = 0;
};

/// The lights of every frame, each in all frames where it shines.
[[nodiscard]] FrameLights frame_lights(const LightClusters& clusters,
                                       const StrengthOptions& options = {});

/// The baseline of [S]: `lights_per_frame` lights by importance sampling for each frame on its own;
/// options.samples_per_frame is not looked at.
[[nodiscard]] FrameLights importance_lights(const FrameImages& images, std::size_t num_frames,
                                            std::size_t lights_per_frame,
                                            const FrameSamplesOptions& options = {});

/// The irradiance of all lights in all frames.
[[nodiscard]] glm::dvec3 total_irradiance(const FrameLights& lights);

} // namespace relumine::lights
