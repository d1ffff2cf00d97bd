// Environments in: from a file in any layout to the cube map that lights a scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"
#include "relight/exact.h"

namespace relumine {

struct EnvironmentOptions {
    /// Overrides what the file says; a square picture does not say
    std::optional<cubemap::Layout> layout = {};
    /// R, texels along a cube face's edge; 0: as many as keep the file's resolution
    std::uint32_t face_resolution = 0;
    /// NaN and negative radiance becomes 0, infinite radiance the largest finite one; otherwise
    /// such files are refused
    bool fix_bad_pixels = false;
    /// Turns the environment about +Y, degrees: light from +Z comes from +X at 90
    double rotate_degrees = 0.0;
};

/// An environment ready to light a scene, and what was found out about its file.
struct Environment {
    cubemap::CubeMap map;
    /// What the map was made from
    relight::EnvironmentFile file;
    /// One sentence: which layout and sampling the file has, and why
    std::string assumptions;
    /// Pixels that were replaced
    std::size_t num_fixed_pixels = 0;
    double seconds_load = 0.0;
    /// With the rotation
    double seconds_resample = 0.0;
};

/// Reads the image as the file has it: `layout` and `fix_bad_pixels` of the options count.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] cubemap::EnvironmentImage
load_environment_image(const std::filesystem::path& path, const EnvironmentOptions& options = {});

/// Resamples an image to a cube map and turns it. Keeps the energy of every pixel.
[[nodiscard]] cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                                           const EnvironmentOptions& options = {});

/// Reads an .exr or .hdr file, or six of them where the path holds `{face}`, resamples and turns.
///
/// Throws:  as load_environment_image().
[[nodiscard]] Environment load_environment(const std::filesystem::path& path,
                                           const EnvironmentOptions& options = {});

} // namespace relumine
