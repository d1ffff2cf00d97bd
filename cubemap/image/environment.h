// Environment files in and out: OpenEXR and Radiance .hdr, in the layouts people have them in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/picture.h"

namespace relumine::cubemap {

/// How the sphere of directions lies in an image.
enum class Layout {
    /// 2:1; centre is +Z, left edge longitude +pi, so +X lies left of the centre; top is +Y
    /// (OpenEXR)
    LatLong,
    /// 1:6; faces +X -X +Y -Y +Z -Z stacked top to bottom, orientation as in Face (OpenEXR)
    Cube,
    /// 3:4; Debevec's and HDR Shop's cross
    VerticalCross,
    /// 6:1; the faces of Cube side by side, +X leftmost
    HorizontalStrip,
    /// 4:3; as VerticalCross, but +Z upright at the right end
    HorizontalCross,
    /// 1:1; Debevec's light probes: a disc, -Z in the middle, +Z all around the rim
    AngularMap,
    /// 1:1; a ball photographed along -Z: a disc, +Z in the middle, -Z all around the rim
    MirrorBall,
    /// 1:1; equal-area octahedral, pbrt-v4: +Y in the middle, -Y in the corners
    Octahedral,
};

inline constexpr std::array<Layout, 8> AllLayouts = {
    Layout::LatLong,         Layout::Cube,       Layout::VerticalCross, Layout::HorizontalStrip,
    Layout::HorizontalCross, Layout::AngularMap, Layout::MirrorBall,    Layout::Octahedral};

[[nodiscard]] std::string_view name(Layout layout);

/// True for the layouts made of six cube faces.
[[nodiscard]] bool has_faces(Layout layout);

/// Where the samples of an image lie.
enum class Sampling {
    /// A pixel covers its square; nearly all HDRIs
    TexelCentres,
    /// The outermost samples lie on the border, so edges are shared: OpenEXR files with the
    /// `envmap` attribute
    Borders,
};

/// Pixels that no radiance can have.
struct BadPixels {
    /// Pixels with a NaN channel
    std::size_t num_nan = 0;
    /// Pixels with an infinite and no NaN channel
    std::size_t num_infinite = 0;
    /// Pixels with a negative and no NaN or infinite channel
    std::size_t num_negative = 0;
    /// Column of the first bad pixel in reading order, where there is one
    std::uint32_t first_x = 0;
    std::uint32_t first_y = 0;
    [[nodiscard]] std::size_t count() const { return num_nan + num_infinite + num_negative; }
};

/// An environment's picture as it stood in the file, with what was found out or assumed about it.
struct EnvironmentImage : Picture {
    Layout layout = Layout::LatLong;
    Sampling sampling = Sampling::TexelCentres;
    /// One sentence: why this layout and sampling ("2:1 image without envmap attribute")
    std::string assumptions;
    /// As found in the file
    BadPixels bad_pixels;
    /// Bad pixels were replaced
    bool fixed = false;
};

struct LoadOptions {
    /// Overrides what attribute and aspect ratio say
    std::optional<Layout> layout = {};
    /// NaN and negative become 0, infinity the largest finite value of the image; otherwise refused
    bool fix_bad_pixels = false;
    /// False: load them as they are (for `info`)
    bool refuse_bad_pixels = true;
};

/// The names of the six faces in file names, in the order of Face; `{face}` in a path stands for
/// all of them.
inline constexpr std::array<std::string_view, 6> FaceFileNames = {"px", "nx", "py",
                                                                  "ny", "pz", "nz"};

/// The files that a path names: six where it holds `{face}`, otherwise itself.
[[nodiscard]] std::vector<std::filesystem::path>
environment_files(const std::filesystem::path& path);

/// Reads an .exr (scanline or tiled, half/float/uint, any compression, luminance-only,
/// luminance-chroma, alpha and extra channels, any data window) or .hdr file, or six of them as a
/// Cube where the path holds `{face}`. A square picture needs LoadOptions::layout. Throws
/// std::runtime_error "path: expected X, got Y".
[[nodiscard]] EnvironmentImage load_environment(const std::filesystem::path& path,
                                                const LoadOptions& options = {});

/// The cube-map resolution that keeps about the image's own: width / 4 of a lat-long, an angular
/// map or a mirror ball, width / 2.25 of an octahedral map, the face of a cube or a cross.
[[nodiscard]] std::uint32_t natural_resolution(const EnvironmentImage& image);

/// Width and height of an image in a layout whose natural resolution is R.
struct ImageSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool operator==(const ImageSize&) const = default;
};
[[nodiscard]] ImageSize natural_size(Layout layout, std::uint32_t face_resolution);

/// Throws std::invalid_argument "path: ..." unless it ends in .exr or .hdr, in small letters or
/// capitals.
void check_environment_name(const std::filesystem::path& path);

/// On the borders for a LatLong or Cube in one .exr file, at texel centres otherwise.
[[nodiscard]] Sampling default_sampling(const std::filesystem::path& path, Layout layout);

/// Writes an image as it is: .exr (float, ZIP; with the `envmap` attribute where samples lie on the
/// borders) or .hdr; a Cube as six files where the path holds `{face}`. Whole or not at all. Throws
/// std::runtime_error or std::invalid_argument "path: ..."; .hdr cannot hold negative or infinite
/// radiance.
void save_image(const std::filesystem::path& path, const EnvironmentImage& image);

/// Writes a cube map in a layout of its natural size. The .exr Cube and LatLong have the `envmap`
/// attribute and samples on the borders, as its specification says; the others sample texel
/// centres. Reads back to the same energy (.hdr: to the 8 bits of RGBE, 0.2 % per pixel). Otherwise
/// as save_image().
void save_environment(const std::filesystem::path& path, const CubeMap& map,
                      Layout layout = Layout::Cube);

} // namespace relumine::cubemap
