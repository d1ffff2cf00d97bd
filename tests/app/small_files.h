// Small inputs, made in code: meshes as text, environments byte by byte.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace relumine::app {

using Rgb = std::array<float, 3>;

/// Six vertices at +X -X +Y -Y +Z -Z (in this order), normals outwards: convex, so each vertex sees
/// its whole hemisphere.
[[nodiscard]] std::string octahedron_obj();

/// Radiance of pixel (x, y).
using Painter = std::function<Rgb(std::uint32_t x, std::uint32_t y)>;

/// A Radiance picture without run lengths. RGBE holds powers of two exactly.
[[nodiscard]] std::string hdr_file(std::uint32_t width, std::uint32_t height,
                                   const Painter& painter);

/// An uncompressed OpenEXR picture of float channels, without the `envmap` attribute. Holds NaN,
/// too.
[[nodiscard]] std::string exr_file(std::uint32_t width, std::uint32_t height,
                                   const Painter& painter);

/// A lat-long of 64 x 32 with radiance 1 everywhere.
[[nodiscard]] std::string white_hdr();

/// A lat-long of 128 x 64 that is dark but for 2 x 2 pixels of radiance 512 about the horizon at
/// column `x`, which is the longitude pi (1 - x / 64): +Z at 64, +X at 32, -X at 96.
[[nodiscard]] std::string lamp_hdr(std::uint32_t x);

} // namespace relumine::app
