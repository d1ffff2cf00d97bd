// Pictures for a part of an environment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/picture.h"

namespace relumine::cubemap {

/// A picture and its halved copies for filtering. Pyramids do not change, so layers and their
/// history share them.
class ImagePyramid {
public:
    /// Takes a picture without its alpha.
    /// Throws:  std::invalid_argument for a wrong number of pixels, or radiance that is negative or
    ///          not finite.
    explicit ImagePyramid(Picture picture);

    /// Returns all levels, full size first, 1 x 1 last.
    [[nodiscard]] const std::vector<Picture>& levels() const { return levels_; }

    /// Returns the colour of a level at a position in [0, 1]^2 from the top left, bilinear between
    /// pixel centres.
    [[nodiscard]] glm::dvec3 sample(std::size_t level, const glm::dvec2& position) const;

    bool operator==(const ImagePyramid&) const = default;

private:
    std::vector<Picture> levels_;
};

/// Reads the pixels of an .exr or .hdr file, without alpha.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] Picture load_picture(const std::filesystem::path& path);

/// Reads an .exr or .hdr file of any shape as a picture.
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] std::shared_ptr<const ImagePyramid>
load_image_pyramid(const std::filesystem::path& path);

} // namespace relumine::cubemap
