// Environments in: from a file in any layout to the cube map that lights a scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/convention.h"
#include "cubemap/image/environment.h"
#include "relight/pictures/backdrop.h"
#include "relight/reference/exact.h"
#include "relumine/in/mesh.h"
#include "relumine/options/option_words.h"

namespace relumine {

struct EnvironmentOptions {
    /// Overrides what the file says; a square picture does not say
    std::optional<cubemap::Layout> layout = {};
    /// Whose convention the file follows: a name of cubemap::conventions()
    std::string from = "openexr";
    /// R, texels along a cube face's edge; 0: as fine as the file, and finer where single pixels of
    /// it hold much of the light: cubemap::automatic_resolution()
    std::uint32_t face_resolution = 0;
    /// NaN and negative radiance becomes 0, infinite radiance the largest finite one; otherwise
    /// such files are refused, but for the few negative pixels that resampling leaves
    bool fix_bad_pixels = false;
    /// Mirrors the environment along this axis of the world, 'x', 'y' or 'z'; applied first. 0: no
    char flip = 0;
    /// Turns the environment about +X, degrees: light from +Y comes from +Z at 90; applied second
    double tilt_degrees = 0.0;
    /// Turns the environment about +Y, degrees: light from +Z comes from +X at 90; applied third
    double rotate_degrees = 0.0;
    /// A rotation about any axis, for programs; applied last
    glm::dmat3 turn{1.0};
};

/// The words of layouts, conventions and axes
struct LayoutText {
    static constexpr const char* Type = "TEXT";
    static std::span<const std::string_view> choices();
    static cubemap::Layout read(const std::string& text);
    static std::string show(cubemap::Layout layout);
};
struct ConventionText {
    static constexpr const char* Type = "TEXT";
    static std::span<const std::string_view> choices();
    static std::string read(const std::string& text) { return text; }
    static std::string show(const std::string& name) { return name; }
};
struct FlipText {
    static constexpr const char* Type = "TEXT";
    static std::span<const std::string_view> choices();
    static char read(const std::string& text) { return text.front(); }
    static std::string show(char axis) { return axis == 0 ? "" : std::string(1, axis); }
};

/// The layouts that a convention has, in words.
[[nodiscard]] std::string layouts_of(const cubemap::Convention& convention);

/// All options of reading and turning an environment.
[[nodiscard]] OptionTable options_of(EnvironmentOptions& options);

/// An environment ready to light a scene, and what was found out about its file.
struct Environment {
    cubemap::CubeMap map;
    /// What the map was made from
    cubemap::EnvironmentFile file;
    /// One sentence: which layout and sampling the file has, and why
    std::string assumptions;
    /// Pixels that were replaced
    std::size_t num_fixed_pixels = 0;
    /// What a user should know, one clause each: negative pixels that became 0, a ground that is
    /// brighter than the sky
    std::vector<std::string> warnings = {};
    double seconds_load = 0.0;
    /// With the turn
    double seconds_resample = 0.0;
    /// The file that was read; empty without one
    std::filesystem::path path = {};
};

/// Reads the image as the file has it: `layout`, `from` and `fix_bad_pixels` of the options count.
/// A map of OpenGL or Direct3D gets the faces +Z and -Z of OpenEXR.
///
/// Throws:  std::runtime_error "path: expected X, got Y"; std::invalid_argument for an unknown
///          convention.
[[nodiscard]] cubemap::EnvironmentImage
load_environment_image(const std::filesystem::path& path, const EnvironmentOptions& options = {});

/// Returns a picture made in code as load_environment_image() returns a file's. Samples lie at
/// texel centres.
///
/// Throws:  std::runtime_error "environment: expected X, got Y"; std::invalid_argument for an
///          unknown convention.
[[nodiscard]] cubemap::EnvironmentImage environment_image(cubemap::Picture picture,
                                                          const EnvironmentOptions& options = {});

/// Returns the matrix of convention, flip, tilt and rotation, from the image's own directions to
/// the world's.
[[nodiscard]] glm::dmat3 world_from_image(cubemap::Layout layout,
                                          const EnvironmentOptions& options = {});

/// Resamples an image to a cube map. Keeps the energy of every pixel.
[[nodiscard]] cubemap::CubeMap unturned_cube_map_of(const cubemap::EnvironmentImage& image,
                                                    const EnvironmentOptions& options = {});

/// Resamples an image to a cube map and turns it.
[[nodiscard]] cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                                           const EnvironmentOptions& options = {});

/// Returns the image, turned, as what is seen behind a mesh: as sharp as its own pixels.
[[nodiscard]] relight::Backdrop backdrop_of(std::shared_ptr<const cubemap::EnvironmentImage> image,
                                            const EnvironmentOptions& options = {});

/// Returns Environment::warnings of an image; `light_from_below` as in cubemap::upside_down().
[[nodiscard]] std::vector<std::string> warnings_about(const cubemap::EnvironmentImage& image,
                                                      double light_from_below);

/// Resamples and turns an image. Only load_environment() fills `seconds_load`.
[[nodiscard]] Environment
environment_of(const std::shared_ptr<const cubemap::EnvironmentImage>& image,
               const EnvironmentOptions& options = {});

/// Turns an image that was resampled: `resampled` is its cube map before any turn. For a picture
/// that turns.
[[nodiscard]] Environment
environment_of(const std::shared_ptr<const cubemap::EnvironmentImage>& image,
               const cubemap::CubeMap& resampled, const EnvironmentOptions& options = {});

/// Reads a file, or six of them where the path holds `{face}`, resamples and turns.
/// A lat-long wider than 8,192 pixels, and than 4 `face_resolution`, is averaged down as it is
/// read: cubemap::load_averaged().
///
/// Throws:  as load_environment_image().
[[nodiscard]] Environment load_environment(const std::filesystem::path& path,
                                           const EnvironmentOptions& options = {});

} // namespace relumine
