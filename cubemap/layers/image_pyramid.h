// Pictures that are placed on a part of an environment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/picture.h"

namespace relumine::cubemap {

/// A picture and its halved copies, for filtering. Immutable, so layers and their history share it.
class ImagePyramid {
public:
    /// Alpha is left out. Throws std::invalid_argument for a wrong number of pixels or radiance
    /// that is negative or not finite.
    explicit ImagePyramid(Picture picture);

    /// Full size first, 1 x 1 last
    [[nodiscard]] const std::vector<Picture>& levels() const { return levels_; }

    /// Bilinear between the pixel centres of a level; position in [0, 1]^2 from the top left.
    [[nodiscard]] glm::dvec3 sample(std::size_t level, const glm::dvec2& position) const;

    bool operator==(const ImagePyramid&) const = default;

private:
    std::vector<Picture> levels_;
};

/// Reads an .exr or .hdr file as a picture, whatever its shape. Throws std::runtime_error "path:
/// expected X, got Y".
[[nodiscard]] std::shared_ptr<const ImagePyramid>
load_image_pyramid(const std::filesystem::path& path);

} // namespace relumine::cubemap
