// Every frame of a video environment as a few hundred weighted directions. light_clusters.h
// clusters them into lights that live over many frames.
// Based on: Staton, Debattista, Bashford-Rogers, Chalmers, "Light clustering for Dynamic Image
// Based Lighting" [S], Section 3.1.
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

/// Returns the environment of a frame, counted from 0. One thread calls it once for every frame, in
/// order.
using FrameImages = std::function<cubemap::EnvironmentImage(std::size_t frame)>;

/// A part of one frame's light.
struct FrameSample {
    /// Unit, from the scene to the light.
    glm::dvec3 direction{0.0, 1.0, 0.0};
    /// RGB irradiance on a surface that faces the light: c_u of [S, Eq. 8].
    glm::dvec3 irradiance{0.0};
    /// Solid angle that the sample stands for, in steradians.
    double solid_angle = 0.0;
    /// Luminance of the environment's radiance in this direction: Lum_u of [S, Eq. 5].
    double luminance = 0.0;
    std::uint32_t frame = 0;
};

/// The samples of all frames of a video environment.
struct FrameSamples {
    std::size_t num_frames = 0;
    /// Samples of all frames, frame after frame.
    std::vector<FrameSample> samples;
};

/// How frames are sampled.
struct FrameSamplesOptions {
    std::size_t samples_per_frame = 1024;
    std::uint64_t seed = 1;
    /// True: each frame has its own random numbers. False: equal frames have equal samples, so a
    /// light that stands still is lit without flicker.
    bool seed_per_frame = false;
    /// True: directions are random within strata of equal luminance. False: directions are
    /// independent, and their sum is right on average only [S, Eq. 2].
    bool stratified = true;
    /// Polled once per frame. After a stop, the samples made so far are returned.
    std::stop_token stop = {};
    /// Called with the finished fraction in [0, 1].
    std::function<void(double)> on_progress = {};
};

/// Samples each frame by luminance times solid angle (lights/importance_sampling.h). The irradiance
/// of a frame's stratified samples adds up to the frame's power in every channel. A black frame has
/// no samples. An image of another layout becomes a lat-long by way of a cube map.
///
/// Memory:  one image at a time.
/// Throws:  std::invalid_argument "frame F: expected X, got Y" for radiance that is negative or not
///          finite, for 0 samples, and for more samples than a frame has pixels.
[[nodiscard]] FrameSamples sample_frames(const FrameImages& images, std::size_t num_frames,
                                         const FrameSamplesOptions& options = {});

/// Returns the sum of the samples' irradiance.
[[nodiscard]] glm::dvec3 total_irradiance(std::span<const FrameSample> samples);

} // namespace relumine::lights
