// Environment files: read and written in the usual layouts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cubemap/cube_map.h"
#include "cubemap/image/picture.h"

namespace relumine::cubemap {

/// How an image shows the sphere of directions. Proportions are width to height.
enum class Layout {
    /// 2:1. The centre is +Z, the left edge is longitude +pi, so +X lies left of the centre. The
    /// top is +Y. (OpenEXR)
    LatLong,
    /// 1:6. Faces +X -X +Y -Y +Z -Z stacked from top to bottom, oriented as in Face. (OpenEXR)
    Cube,
    /// 3:4. The cross of Debevec and HDR Shop.
    VerticalCross,
    /// 6:1. The faces of Cube side by side, +X leftmost.
    HorizontalStrip,
    /// 4:3. As VerticalCross, but +Z stands upright at the right end.
    HorizontalCross,
    /// 1:1. Debevec's light probes: a disc with -Z in the middle and +Z all around the rim.
    AngularMap,
    /// 1:1. A ball photographed along -Z: a disc with +Z in the middle and -Z all around the rim.
    MirrorBall,
    /// 1:1. Equal-area octahedral as in pbrt-v4: +Y in the middle, -Y in the corners.
    Octahedral,
};

inline constexpr std::array<Layout, 8> AllLayouts = {
    Layout::LatLong,         Layout::Cube,       Layout::HorizontalStrip, Layout::VerticalCross,
    Layout::HorizontalCross, Layout::AngularMap, Layout::MirrorBall,      Layout::Octahedral};

/// Returns the layout's name in sentences.
[[nodiscard]] std::string_view name(Layout layout);

/// Returns the layout's name as an option's value: one word.
[[nodiscard]] std::string_view option_name(Layout layout);

/// Returns true for layouts made of six cube faces.
[[nodiscard]] bool has_faces(Layout layout);

/// Where the samples of an image lie.
enum class Sampling {
    /// A pixel covers its square, as in nearly all HDRIs.
    TexelCentres,
    /// The outermost samples lie on the border, so neighbouring edges share samples. OpenEXR files
    /// with the `envmap` attribute are like this.
    Borders,
};

/// Whose faces a file has. All became OpenEXR's as it was read.
enum class FacesOf {
    OpenExr,
    /// As one sees them in Direct3D's left-handed world: +Z and -Z are exchanged
    Direct3D,
    /// Of a right-handed world that OpenGL looks up without a sign: mirrored
    OpenGl,
};

/// Count of pixels whose values are no radiance.
struct BadPixels {
    /// Largest negative_share that is taken for what a resampling filter left.
    static constexpr double MostNegativeLight = 0.01;

    /// Radiance beyond this is no light: it counts as infinite.
    static constexpr float MostRadiance = 1e30f;

    /// Pixels with a NaN channel.
    std::size_t num_nan = 0;
    /// Pixels with a channel beyond MostRadiance and no NaN.
    std::size_t num_infinite = 0;
    /// Pixels with a negative channel, no NaN and nothing infinite.
    std::size_t num_negative = 0;
    /// Column and row of the first bad pixel in reading order. 0 if there is none.
    std::uint32_t first_x = 0;
    std::uint32_t first_y = 0;
    /// The light below zero over the light above zero: sums over the sphere and the channels, of
    /// finite values.
    double negative_share = 0.0;
    [[nodiscard]] std::size_t count() const { return num_nan + num_infinite + num_negative; }
    /// Returns true for what resampling filters leave: some negative pixels with hardly any light.
    [[nodiscard]] bool is_harmless() const {
        return count() == num_negative && negative_share <= MostNegativeLight;
    }
};

/// An environment's picture as read from a file, with what was found out or assumed about it.
struct EnvironmentImage : Picture {
    Layout layout = Layout::LatLong;
    Sampling sampling = Sampling::TexelCentres;
    FacesOf faces_of = FacesOf::OpenExr;
    /// One sentence on why this layout and sampling were chosen: "2:1 image without envmap
    /// attribute".
    std::string assumptions;
    /// Bad pixels as they were in the file, with their places there.
    BadPixels bad_pixels;
    /// Pixels of the file. More than the picture's where they were averaged as they were read.
    std::size_t num_file_pixels = 0;
    /// Pixels of alpha 0 in the file: no light comes from them.
    std::size_t num_transparent = 0;
    /// True if bad pixels were replaced: all of them, or the few negative ones that every file may
    /// have.
    bool fixed = false;
    /// What infinite radiance was replaced by
    float infinity_became = 0.0f;
};

/// How load_environment() interprets a file.
struct LoadOptions {
    /// Layout of the image. Empty: taken from the `envmap` attribute or the aspect ratio.
    std::optional<Layout> layout = {};
    /// True: NaN and negative values become 0, infinity becomes the largest finite value of the
    /// image.
    bool fix_bad_pixels = false;
    /// True: an image with bad pixels that are not fixed is an error, but harmless ones become 0.
    /// False: an image is loaded as it is.
    bool refuse_bad_pixels = true;
};

/// Names of the six faces in file names, in the order of Face. `{face}` in a path stands for each
/// of them.
inline constexpr std::array<std::string_view, 6> FaceFileNames = {"px", "nx", "py",
                                                                  "ny", "pz", "nz"};

/// Returns the files that a path names: six if the path holds `{face}`, otherwise the path itself.
[[nodiscard]] std::vector<std::filesystem::path>
environment_files(const std::filesystem::path& path);

/// Reads a file, or six of them as a Cube if the path holds `{face}`. docs/environments.md has the
/// formats.
///
/// Format:  .exr may be scanline or tiled, half, float or uint, in any compression, with any data
///          window. Luminance-only, luminance-chroma, alpha and extra channels are understood. A
///          square picture needs LoadOptions::layout.
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] EnvironmentImage load_environment(const std::filesystem::path& path,
                                                const LoadOptions& options = {});

/// Returns a picture made in code as load_environment() returns a file's, with samples at texel
/// centres. `name` stands for it in messages.
///
/// Throws:  std::runtime_error "name: expected X, got Y".
[[nodiscard]] EnvironmentImage environment_image(Picture picture, const std::string& name,
                                                 const LoadOptions& options = {});

/// Returns the cube-map resolution that is about as fine as the image: width / 4 for a lat-long, an
/// angular map or a mirror ball, width / 2.25 for an octahedral map, the face's resolution for a
/// cube or a cross.
[[nodiscard]] std::uint32_t natural_resolution(const EnvironmentImage& image);

/// Returns the cube-map resolution at which an image should light a scene: the natural one, and
/// twice as much (four times up to 256), 1,024 at most, where a single pixel holds over a hundredth
/// of the light. A sun of one pixel lies in up to four texels, which must be small for its shadows
/// not to move.
///
/// Cost:    O(pixels).
[[nodiscard]] std::uint32_t automatic_resolution(const EnvironmentImage& image);

/// Width and height of an image in pixels.
struct ImageSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool operator==(const ImageSize&) const = default;
};
/// Returns the size of an image in a layout whose natural resolution is `face_resolution`.
[[nodiscard]] ImageSize natural_size(Layout layout, std::uint32_t face_resolution);

/// Returns the extensions of files that are read: ".exr, .hdr, .tif, .pfm, .dds, .ktx2 or .jpg".
[[nodiscard]] std::string environment_extensions();

/// Whether a name ends as an environment's does, in capitals or not.
[[nodiscard]] bool is_environment_name(const std::filesystem::path& path);

/// Checks that a path ends in .exr or .hdr, which are written, in small letters or capitals.
/// Throws:  std::invalid_argument "path: ..." for any other name.
void check_environment_name(const std::filesystem::path& path);

/// Returns the sampling of a new file: Borders for a LatLong or Cube in one .exr file, TexelCentres
/// otherwise.
[[nodiscard]] Sampling default_sampling(const std::filesystem::path& path, Layout layout);

/// Writes an image as it is, to .exr or .hdr. A Cube becomes six files if the path holds `{face}`.
/// Each file appears whole or not at all.
///
/// Format:  .exr is float with ZIP compression, and has the `envmap` attribute if samples lie on
///          the borders. .hdr cannot hold negative or infinite radiance.
/// Throws:  std::runtime_error or std::invalid_argument "path: ...".
void save_image(const std::filesystem::path& path, const EnvironmentImage& image);

} // namespace relumine::cubemap
