// Every frame of a video environment as a few hundred weighted directions: what is clustered into
// lights that live over many frames. Based on: Staton, Debattista, Bashford-Rogers, Chalmers,
// "Light clustering for Dynamic Image Based Lighting" [S], Section 3.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::lights {

/// Gives the environment of a frame, 0 first. Called once for every frame, in order, by one thread.
using FrameImages = std::function<cubemap::EnvironmentImage(std::size_t frame)>;

/// A part of one frame's light.
struct FrameSample {
    /// Unit, from the scene to the light
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// RGB, on a surface that faces it: the c_u of [S, Eq. 8]
    glm::dvec3 irradiance{0.0};
    /// Steradians that it stands for
    double solid_angle = 0.0;
    /// Of the environment's radiance in this direction: the Lum_u of [S, Eq. 5]
    double luminance = 0.0;
    std::uint32_t frame = 0;
};

struct FrameSamples {
    std::size_t num_frames = 0;
    /// Frame after frame
    std::vector<FrameSample> samples;
};

struct FrameSamplesOptions {
    std::size_t samples_per_frame = 1024;
    std::uint64_t seed = 1;
    /// Other random numbers in each frame. Without them equal frames have equal samples, which a
    /// light that stands still needs to be lit without flicker.
    bool seed_per_frame = false;
    /// Directions at random in strata of equal luminance; otherwise independent of each other, and
    /// their sum is right on average [S, Eq. 2].
    bool stratified = true;
    /// Polled once a frame; what is there by then is returned
    std::stop_token stop = {};
    /// Fraction in [0, 1]
    std::function<void(double)> on_progress = {};
};

/// Samples each frame by luminance times solid angle (lights/importance_sampling.h). Stratified,
/// the irradiance of a frame's samples adds up to the frame's power in every channel. A black frame
/// has none. Images of other layouts than lat-long become one by way of a cube map. One image is in
/// memory at a time. Throws std::invalid_argument "frame F: expected X, got Y" for radiance that is
/// negative or not finite, for 0 samples and for more than a frame has pixels.
[[nodiscard]] FrameSamples sample_frames(const FrameImages& images, std::size_t num_frames,
                                         const FrameSamplesOptions& options = {});

/// The sum of the samples' irradiance.
[[nodiscard]] glm::dvec3 total_irradiance(std::span<const FrameSample> samples);

} // namespace relumine::lights
