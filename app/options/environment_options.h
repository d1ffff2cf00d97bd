// Environment files on the command line: which options they take and how they become cube maps.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "app/session.h"
#include "cubemap/image/convention.h"
#include "relumine/environment.h"

namespace relumine::app {

/// The ENV argument and its options.
struct EnvironmentOptions {
    std::string path;
    /// Layout of the image. Empty: taken from the file.
    std::string layout;
    std::string from = "openexr";
    /// 0: the image's own
    std::uint32_t face_resolution = 0;
    bool fix = false;
    /// x, y or z; empty: no
    std::string flip;
    double tilt_degrees = 0.0;
    double rotate_degrees = 0.0;

    /// Adds ENV and its options; returns ENV, which is required until its caller says otherwise.
    Option add_to(Command& command);
    /// All but ENV.
    void add_conversion_to(Command& command);
    /// All but ENV and --face-resolution.
    void add_reading_to(Command& command);

    /// The matrix from the image's own directions to the world's.
    [[nodiscard]] glm::dmat3 world_from_image(cubemap::Layout image_layout) const;
    /// The same options for the library. Throws UsageError for a layout that --from does not read.
    [[nodiscard]] relumine::EnvironmentOptions for_library() const;
    /// All that changes the light, for the record of a run that may be resumed.
    [[nodiscard]] std::string settings() const;
};

/// The image as the file has it. Says on -v what was assumed, and always when pixels were fixed.
[[nodiscard]] cubemap::EnvironmentImage load_image(const EnvironmentOptions& options,
                                                   const Session& session);

/// Warns of what is odd about an image from load_image(). Returns true if there was something.
/// `light_from_below` is that of the turned image.
bool warn_about(const EnvironmentOptions& options, const cubemap::EnvironmentImage& image,
                double light_from_below, Session& session);

/// An image resampled to a cube map and rotated.
[[nodiscard]] cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                                           const EnvironmentOptions& options);

/// The image as it is seen behind the mesh.
[[nodiscard]] relight::Backdrop backdrop_of(std::shared_ptr<const cubemap::EnvironmentImage> image,
                                            const EnvironmentOptions& options);

/// Loads, resamples and turns. Says on -v what was assumed, always what --fix-env replaced, and
/// warns of what is odd.
[[nodiscard]] Environment load_environment(const EnvironmentOptions& options, Session& session);

/// The names that --layout takes.
[[nodiscard]] const std::vector<std::string>& layout_names();

/// The layouts' names on the command line, in words.
[[nodiscard]] std::string layouts_of(const cubemap::Convention& convention);

/// The layout of a name given on the command line.
[[nodiscard]] cubemap::Layout parse_layout(const std::string& name);

} // namespace relumine::app
