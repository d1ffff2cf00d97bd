// How load_environment() judges a file. Files that are read whole and by bands share it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

#include "cubemap/image/environment.h"
#include "cubemap/image/image_file.h"

namespace relumine::cubemap::detail {

/// Sets layout, sampling and the reason for both. `image` has its size.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
void interpret(const ImageFile& file, const LoadOptions& options, const std::string& path,
               EnvironmentImage& image);

/// Counts a pixel if it is a bad one. Pixels come in reading order.
void count_if_bad(const glm::vec3& pixel, std::uint32_t x, std::uint32_t y, BadPixels& bad);

/// Whether bad pixels are to be replaced.
///
/// Throws:  std::runtime_error "path: expected X, got Y" where they are refused.
[[nodiscard]] bool are_fixed(const BadPixels& bad, const LoadOptions& options,
                             const std::string& path);

/// What a sun is that was brighter than the file's numbers can say, at least.
[[nodiscard]] float least_infinity(const ImageFile& file);

/// Returns the larger of `largest` and the pixel's radiance that is no infinity.
[[nodiscard]] float largest_finite(const glm::vec3& pixel, float largest);

/// Replaces what is bad in a pixel.
[[nodiscard]] glm::vec3 fixed(const glm::vec3& pixel, float infinity);

} // namespace relumine::cubemap::detail
