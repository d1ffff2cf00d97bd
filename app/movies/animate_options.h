// What `relumine animate` is asked to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "app/options/bounce_option.h"
#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "app/scenes/lit_scene.h"
#include "relumine/in/environment_files.h"
#include "relumine/out/camera_path.h"

namespace relumine::app {

enum class Turning { Camera, Object, Environment };

struct Turntable {
    /// Frames of one turn under one environment. 0: nothing turns.
    std::uint32_t num_frames = 0;
    Turning turns = Turning::Camera;
};

struct AnimateOptions {
    SceneOptions scene;
    /// The argument FRAMES: a pattern of file names.
    std::string frames;
    /// --frames. Empty: all frames.
    std::string range;
    EnvironmentOptions environment;
    std::string method = "prt";
    /// Lights of --method importance in a frame (64), or of --method clusters in all frames
    /// together (512).
    std::optional<std::size_t> num_lights;
    /// --measure: a .npy with the reference of all frames. Empty: nothing is measured.
    std::string reference;
    /// Its path is a pattern. Empty: no picture files.
    OutputOptions output;
    BounceOption bounces;
    /// A .npy of all frames. Empty: none.
    std::string vertices;
    /// An .mp4 movie. Empty: none.
    std::string movie;
    double frames_per_second = 24.0;
    bool resume = false;
    Turntable turntable;
    [[nodiscard]] bool turns_camera() const {
        return turntable.num_frames > 0 && turntable.turns != Turning::Environment;
    }
    [[nodiscard]] bool turns_environment() const {
        return turntable.num_frames > 0 && turntable.turns != Turning::Camera;
    }

    /// --camera-path: a file of key frames. Empty: the camera stands still or turns.
    std::string camera_file;
    /// What the file says, once load_camera() has read it.
    std::optional<CameraPath> camera_path;
    [[nodiscard]] bool moves_camera() const { return camera_path || turns_camera(); }

    void add_to(Command& command);

    /// Reads --camera-path. Throws UsageError beside options that also place the camera, and what
    /// load_camera_path() throws.
    void load_camera();

    /// The frames that FRAMES names; with --turntable or --camera-path one environment many times.
    /// Throws std::runtime_error as cubemap::find_frames().
    [[nodiscard]] std::vector<cubemap::FrameFile> frame_files() const;
    /// The environment's options at a frame: turned with --turntable.
    [[nodiscard]] EnvironmentOptions environment_at(std::size_t frame) const;
    /// How far --turntable has turned at a frame.
    [[nodiscard]] double turn_degrees(std::size_t frame) const;
    /// The camera of --camera-path at the frame of a number. Without a field of view in the file it
    /// has that of `other`.
    [[nodiscard]] PlacedCamera camera_on_path(std::int64_t number, const Camera& other) const;
    /// Refuses what cannot be done before any work is.
    void check(const cubemap::FrameSequence& sequence) const;
    /// The pattern of -o, nothing without -o. Throws std::runtime_error where the number has no
    /// place.
    [[nodiscard]] std::optional<cubemap::FramePattern> output_pattern() const;
    /// All that shapes every frame, for FrameRecord.
    [[nodiscard]] std::string settings(const cubemap::FrameSequence& sequence) const;

private:
    /// Refuses frames at which the eye meets its target.
    void check_cameras(const cubemap::FrameSequence& sequence) const;

    std::optional<Command> command_;
};

} // namespace relumine::app
