// Pictures for a part of an environment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// A decoded picture and its halved copies for filtering. Pictures do not change, so layers and
/// their history share them.
class Picture {
public:
    struct Level {
        std::uint32_t width = 0;
        std::uint32_t height = 0;
        /// [height * width] row by row from the top; linear RGB radiance.
        std::vector<glm::vec3> pixels;
        bool operator==(const Level&) const = default;
    };

    /// Throws:  std::invalid_argument for a wrong number of pixels, or radiance that is negative or
    ///          not finite.
    Picture(std::uint32_t width, std::uint32_t height, std::vector<glm::vec3> pixels);

    /// All levels, full size first, 1 x 1 last.
    [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }

    /// Returns the colour of a level at a position in [0, 1]^2 from the top left, bilinear between
    /// pixel centres.
    [[nodiscard]] glm::dvec3 sample(std::size_t level, const glm::dvec2& position) const;

    bool operator==(const Picture&) const = default;

private:
    std::vector<Level> levels_;
};

/// Reads an .exr or .hdr file of any shape as a picture.
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] std::shared_ptr<const Picture> load_picture(const std::filesystem::path& path);

} // namespace relumine::cubemap
