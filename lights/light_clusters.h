// Lights that live over several frames of a video environment, so they do not jump from frame to
// frame.
// Based on: [S] Staton, Debattista, Bashford-Rogers, Chalmers, "Light clustering for Dynamic Image
// Based Lighting", Section 3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "lights/frame_samples.h"
#include "lights/k_means.h"
#include "lights/light_list.h"

namespace relumine::lights {

/// Distant lights for every frame of a sequence. A light that lives over several frames appears in
/// each of them.
struct FrameLights {
    /// [num_frames], the lights of each frame.
    std::vector<std::vector<DistantLight>> frames;

    [[nodiscard]] std::size_t num_frames() const { return frames.size(); }
    /// Returns the lights of a frame, 0 <= frame < num_frames().
    [[nodiscard]] std::span<const DistantLight> at(std::size_t frame) const {
        return frames[frame];
    }
};

/// A light with its span of frames [S, Section 3.3].
struct LightCluster {
    /// Direction: mean of the samples' directions [S, Eq. 7]. Irradiance: sum of the samples'
    /// irradiance over the number of frames [S, Eq. 8].
    DistantLight light;
    /// f_start, the first frame of the span.
    std::uint32_t first_frame = 0;
    /// f_end, the last frame of the span, included.
    std::uint32_t last_frame = 0;
    std::size_t num_samples = 0;
    /// [num_frames()] irradiance of the samples of each frame of the span.
    std::vector<glm::dvec3> frame_irradiance;

    [[nodiscard]] std::size_t num_frames() const {
        return std::size_t{last_frame} - first_frame + 1;
    }
};

/// The lights of a video environment.
struct LightClusters {
    std::size_t num_frames = 0;
    /// All clusters that have samples.
    std::vector<LightCluster> clusters;
    /// The clustering itself. Its cluster_of is [samples].
    KMeans k_means;

    /// Returns the mean number of lights per frame. A comparison gives importance sampling the same
    /// number.
    [[nodiscard]] double mean_live() const;
};

/// Clusters the samples of all frames into lights. The light of all frames together is the light of
/// all samples.
///
/// Differs from [S]: a frame with exactly the samples of the frame before it has the same time, and
/// frames are counted without such repeats. So constant light makes constant lights for every
/// gamma, and a frame shown twice changes nothing.
///
/// Throws:  as k_means().
[[nodiscard]] LightClusters cluster_lights(const FrameSamples& samples,
                                           const KMeansOptions& options = {});

/// The strength of a light over the frames of its span.
enum class Strength {
    /// A constant strength in all frames [S, Eq. 8]. Where the spans of two lights overlap, both
    /// shine in full.
    Even,
    /// In each frame the strength of the light's samples there. Each frame has the power of its
    /// environment.
    Followed,
};

/// How lights change over their spans.
struct StrengthOptions {
    Strength strength = Strength::Followed;
    /// Number of frames before and after a change of strength over which a raised cosine spreads
    /// the change. The total stays the same. 0: no fading, as in [S].
    std::size_t fade = 0;
};

/// Returns the lights of every frame. A light appears in each frame in which it shines.
[[nodiscard]] FrameLights frame_lights(const LightClusters& clusters,
                                       const StrengthOptions& options = {});

/// Returns the irradiance of all lights in all frames.
[[nodiscard]] glm::dvec3 total_irradiance(const FrameLights& lights);

} // namespace relumine::lights
