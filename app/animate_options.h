// What `relumine animate` is asked to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "app/environment_options.h"
#include "app/lit_scene.h"
#include "app/output_options.h"
#include "cubemap/image/frame_pattern.h"
#include "cubemap/image/frame_sequence.h"

namespace relumine::app {

struct AnimateOptions {
    SceneOptions scene;
    /// FRAMES
    std::string frames;
    /// --frames; empty: all
    std::string range;
    EnvironmentOptions environment;
    std::string method = "prt";
    /// --method prt
    double bound = 0.0;
    /// --method importance: lights per frame
    std::size_t num_lights = 64;
    std::uint64_t seed = 1;
    /// --method clusters: of all frames
    std::size_t num_clusters = 512;
    /// Of a frame
    std::size_t num_samples = 1024;
    /// frames
    std::size_t fade = 0;
    /// The paper's strength
    bool even = false;
    /// --measure: .npy of all frames, or empty
    std::string reference;
    /// Of --measure: .svg, or empty
    std::string plot;
    /// Path: a pattern, or empty
    OutputOptions output;
    /// .npy, or empty
    std::string vertices;
    /// .mp4, or empty
    std::string movie;
    double frames_per_second = 24.0;
    bool resume = false;

    void add_to(Command& command);

    /// Refuses what cannot be done before any work is.
    void check(const cubemap::FrameSequence& sequence) const;
    /// The pattern of -o, nothing without -o. Throws std::runtime_error where the number has no
    /// place.
    [[nodiscard]] std::optional<cubemap::FramePattern> output_pattern() const;
    /// All that shapes every frame, for FrameRecord.
    [[nodiscard]] std::string settings(const cubemap::FrameSequence& sequence) const;
};

} // namespace relumine::app
