#include "lights/frame_samples.h"

#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/resample/resample.h"
#include "cubemap/split_mix64.h"
#include "lights/importance_sampling.h"
#include "lights/lat_long_grid.h"
#include "lights/place_lights.h"

namespace relumine::lights {

namespace {

void add_frame(const cubemap::EnvironmentImage& image, std::uint32_t frame,
               const FrameSamplesOptions& options, std::vector<FrameSample>& samples) {
    const LatLongGrid grid(image);
    if (options.samples_per_frame > grid.num_pixels())
        throw std::invalid_argument(
            fmt::format("expected at most {} samples for {} x {} pixels, got {}", grid.num_pixels(),
                        grid.width(), grid.height(), options.samples_per_frame));
    // Seeds with such large steps make the samples of neighbouring frames independent.
    const std::uint64_t seed = options.seed_per_frame ? options.seed + (std::uint64_t{frame} + 1) *
                                                                           cubemap::SplitMix64::Step
                                                      : options.seed;
    for (const ImportanceSample& sample :
         options.stratified ? importance_samples(grid, options.samples_per_frame, seed)
                            : independent_samples(grid, options.samples_per_frame, seed))
        if (sample.light.irradiance != glm::dvec3(0.0))
            samples.push_back({.direction = sample.light.direction,
                               .irradiance = sample.light.irradiance,
                               .solid_angle = sample.light.solid_angle,
                               .luminance = sample.luminance,
                               .frame = frame});
}

} // namespace

FrameSamples sample_frames(const FrameImages& images, std::size_t num_frames,
                           const FrameSamplesOptions& options) {
    if (options.samples_per_frame == 0)
        throw std::invalid_argument("expected at least 1 sample for each frame, got 0");
    FrameSamples result{.num_frames = num_frames, .samples = {}};
    for (std::size_t frame = 0; frame < num_frames && !options.stop.stop_requested(); ++frame) {
        cubemap::EnvironmentImage image = images(frame);
        try {
            if (image.layout != cubemap::Layout::LatLong)
                image = lat_long_of(cubemap::resample(image, cubemap::natural_resolution(image)));
            add_frame(image, static_cast<std::uint32_t>(frame), options, result.samples);
        } catch (const std::invalid_argument& error) {
            throw std::invalid_argument(fmt::format("frame {}: {}", frame, error.what()));
        }
        if (options.on_progress)
            options.on_progress(static_cast<double>(frame + 1) / static_cast<double>(num_frames));
    }
    return result;
}

glm::dvec3 total_irradiance(std::span<const FrameSample> samples) {
    glm::dvec3 sum(0.0);
    for (const FrameSample& sample : samples)
        sum += sample.irradiance;
    return sum;
}

} // namespace relumine::lights
