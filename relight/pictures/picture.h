// Pictures as files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "cubemap/image/picture.h"
#include "relight/pictures/display_transform.h"
#include "relight/pictures/tone_curve.h"

namespace relumine::relight {

using cubemap::Picture;

/// How radiance becomes a file's values.
struct Development {
    /// In stops.
    double exposure_ev = 0.0;
    /// The tone curve of .png; .exr is linear.
    ToneCurve tone = ToneCurve::None;
    /// The display transform of .png, in place of `tone`; null: none.
    const DisplayTransform* display = nullptr;
};

/// Returns a PNG file: exposed, through the tone curve, sRGB, 8 bit, with alpha where the picture
/// has it.
///
/// Throws:  std::invalid_argument for a picture without pixels, or with too few.
[[nodiscard]] std::vector<std::byte> png_file(const Picture& picture,
                                              const Development& development = {});

/// Writes .png (exposed, through the tone curve, sRGB, 8 bit) or .exr (exposed linear float). Alpha
/// becomes a channel. Writes the file whole or not at all.
///
/// Throws:  std::runtime_error that names the path; std::invalid_argument for another extension, or
///          a picture with too few pixels.
void save_picture(const std::filesystem::path& path, const Picture& picture,
                  const Development& development = {});

} // namespace relumine::relight
