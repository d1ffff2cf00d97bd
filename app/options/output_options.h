// Lit scenes as files: which options they take and how they are written.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/command_line/command_line.h"
#include "app/options/lit_scene.h"
#include "cubemap/image/frame_pattern.h"
#include "files/extension.h"
#include "relumine/output.h"

namespace relumine::app {

/// -o and everything that shapes the output: camera, size, exposure, albedo, background.
struct OutputOptions {
    std::string path;
    std::string albedo = "auto";
    std::string floor_albedo;
    float floor_fade = relumine::OutputOptions{}.floor_fade;
    std::string exposure = "auto";
    std::string tone_map = "neutral";
    /// AZIMUTH,ELEVATION[,DISTANCE][,FOV]. Empty: automatic.
    std::string camera;
    std::string front = "+z";
    /// Camera position X,Y,Z. Empty: automatic.
    std::string eye;
    /// Point X,Y,Z that the camera looks at. Empty: automatic.
    std::string target;
    std::optional<float> fov_degrees;
    std::string size = "1024x768";
    std::string background = "sharp";
    /// The same as the background `none`.
    bool transparent = false;
    std::string sun = "pixel";
    /// Texel receivers: texels around the charts
    std::uint32_t gutter = 16;

    /// Adds -o and the others; returns -o, which is required until its caller says otherwise.
    Option add_to(Command& command);

    /// Refuses what cannot be written, or is one of the inputs, before any work is done.
    void check(const std::vector<std::string>& inputs) const;

    /// Refuses outputs and options that the scene's receivers have no use for: meshes of pixels and
    /// texels, a camera where there is none to choose. Throws std::runtime_error.
    void check_fits(const Scene& scene) const;

    /// The same for the library: camera and colours as this scene has them. Throws
    /// std::runtime_error for colours that its mesh does not have.
    [[nodiscard]] relumine::OutputOptions for_scene(const Scene& scene) const;

    /// All of them in one text, to tell whether files were made with the same.
    [[nodiscard]] std::string settings() const;

    /// Stops of --exposure; empty for auto.
    [[nodiscard]] std::optional<double> exposure_ev() const;

    /// What to tell the user of the exposure of a picture or of colours: "; exposure -1.37 (auto)";
    /// nothing for numbers.
    [[nodiscard]] std::string exposure_text(const Painter& painter) const;

private:
    /// --camera, --front, --eye, --target, --fov, --size
    std::vector<Option> camera_options_;
    /// --background, --transparent
    std::vector<Option> background_options_;
};

/// Adds --exposure and --tone-map.
void add_exposure_options(Command& command, std::string& exposure, std::string& tone_map);

/// Stops of --exposure; empty for auto. Throws UsageError.
[[nodiscard]] std::optional<double> parse_exposure(const std::string& text);

using files::extension_of;

/// Throws UsageError unless an option's path has one of these extensions (capital letters are
/// allowed).
void require_extension(const std::string& option, const std::string& path,
                       const std::vector<std::string>& extensions);

/// The same for environments: .exr or .hdr.
void require_environment_name(const std::string& option, const std::string& path);

/// The names of frames, from --output. Throws UsageError where `path` has no place for a number.
[[nodiscard]] cubemap::FramePattern frame_names(const std::string& path);

/// Throws std::runtime_error when `path` cannot be written or is one of the inputs, under whatever
/// name.
void check_output(const std::string& path, const std::vector<std::string>& inputs);

} // namespace relumine::app
