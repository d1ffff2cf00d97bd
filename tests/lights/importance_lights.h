// The baseline of [S], for the bench and for tests.
#pragma once

#include "lights/light_clusters.h"

namespace relumine::lights {

/// Returns `lights_per_frame` lights by importance sampling for each frame on its own.
/// options.samples_per_frame is ignored.
[[nodiscard]] inline FrameLights importance_lights(const FrameImages& images,
                                                   std::size_t num_frames,
                                                   std::size_t lights_per_frame,
                                                   const FrameSamplesOptions& options = {}) {
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

} // namespace relumine::lights
