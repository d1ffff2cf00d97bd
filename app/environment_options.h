// Environment files on the command line: which options they take and how they become cube maps.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session.h"
#include "relumine/environment.h"

namespace relumine::app {

/// The ENV argument and its options.
struct EnvironmentOptions {
    std::string path;
    /// Layout of the image. Empty: taken from the file.
    std::string layout;
    /// 0: the image's own
    std::uint32_t face_resolution = 0;
    bool fix = false;
    double rotate_degrees = 0.0;

    /// Adds ENV and its options; returns ENV, which is required until its caller says otherwise.
    Option add_to(Command& command);
    /// All but ENV.
    void add_conversion_to(Command& command);
};

/// The image as the file has it. Says on -v what was assumed, and always when pixels were fixed.
[[nodiscard]] cubemap::EnvironmentImage load_image(const EnvironmentOptions& options,
                                                   const Session& session);

/// An image resampled to a cube map and rotated.
[[nodiscard]] cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                                           const EnvironmentOptions& options);

/// The image as it is seen behind the mesh.
[[nodiscard]] relight::Backdrop backdrop_of(std::shared_ptr<const cubemap::EnvironmentImage> image,
                                            const EnvironmentOptions& options);

/// Loads, resamples and rotates. Says on -v what was assumed, and always when pixels were fixed.
[[nodiscard]] Environment load_environment(const EnvironmentOptions& options,
                                           const Session& session);

/// The names that --layout takes.
[[nodiscard]] const std::vector<std::string>& layout_names();

/// The name that --layout takes for it.
[[nodiscard]] std::string option_name(cubemap::Layout layout);

/// The layout of a name given on the command line.
[[nodiscard]] cubemap::Layout parse_layout(const std::string& name);

} // namespace relumine::app
