#include "cubemap/layers/image_pyramid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"

namespace relumine::cubemap {

namespace {

bool is_radiance(const glm::vec3& value) {
    return value.x >= 0.0f && value.y >= 0.0f && value.z >= 0.0f && std::isfinite(value.x) &&
           std::isfinite(value.y) && std::isfinite(value.z);
}

/// Returns half as many pixels in each direction (at least one). Each is the mean of the pixels it
/// covers, also for an odd number of pixels.
Picture halved(const Picture& from) {
    Picture to{.width = std::max(1u, from.width / 2),
               .height = std::max(1u, from.height / 2),
               .pixels = {}};
    to.pixels.reserve(std::size_t{to.width} * to.height);
    // Calls visit(pixel, weight) for the pixels that pixel `index` of the halved row or column
    // covers.
    const auto for_covered = [](std::uint32_t index, std::uint32_t num_from, std::uint32_t num_to,
                                const auto& visit) {
        const double scale = static_cast<double>(num_from) / num_to;
        const double begin = index * scale;
        const double end = index + 1 == num_to ? num_from : (index + 1) * scale;
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
            visit(i, (std::min(end, i + 1.0) - std::max(begin, static_cast<double>(i))) /
                         (end - begin));
    };
    for (std::uint32_t y = 0; y < to.height; ++y) {
        for (std::uint32_t x = 0; x < to.width; ++x) {
            glm::dvec3 sum(0.0);
            for_covered(y, from.height, to.height, [&](std::uint32_t row, double row_weight) {
                for_covered(x, from.width, to.width, [&](std::uint32_t column, double weight) {
                    sum += weight * row_weight *
                           glm::dvec3(from.pixels[std::size_t{row} * from.width + column]);
                });
            });
            to.pixels.emplace_back(sum);
        }
    }
    return to;
}

} // namespace

ImagePyramid::ImagePyramid(Picture picture) {
    const std::vector<glm::vec3>& pixels = picture.pixels;
    if (picture.width == 0 || picture.height == 0 ||
        pixels.size() != std::size_t{picture.width} * picture.height)
        throw std::invalid_argument(
            fmt::format("picture: expected {} x {} pixels, at least one, got {}", picture.width,
                        picture.height, pixels.size()));
    const auto bad = std::find_if_not(pixels.begin(), pixels.end(), is_radiance);
    if (bad != pixels.end()) {
        const auto index = static_cast<std::size_t>(bad - pixels.begin());
        throw std::invalid_argument(fmt::format(
            "picture: expected finite radiance of at least 0, got ({}, {}, {}) at pixel ({}, {})",
            bad->x, bad->y, bad->z, index % picture.width, index / picture.width));
    }
    picture.alpha.clear();
    levels_.push_back(std::move(picture));
    while (levels_.back().pixels.size() > 1)
        levels_.push_back(halved(levels_.back()));
}

glm::dvec3 ImagePyramid::sample(std::size_t level, const glm::dvec2& position) const {
    const Picture& image = levels_[level];
    const double x = std::clamp(position.x * image.width - 0.5, 0.0, image.width - 1.0);
    const double y = std::clamp(position.y * image.height - 0.5, 0.0, image.height - 1.0);
    const auto x0 = static_cast<std::size_t>(x), y0 = static_cast<std::size_t>(y);
    const std::size_t x1 = std::min<std::size_t>(x0 + 1, image.width - 1);
    const std::size_t y1 = std::min<std::size_t>(y0 + 1, image.height - 1);
    const auto at = [&](std::size_t column, std::size_t row) {
        return glm::dvec3(image.pixels[row * image.width + column]);
    };
    const double fx = x - static_cast<double>(x0), fy = y - static_cast<double>(y0);
    return glm::mix(glm::mix(at(x0, y0), at(x1, y0), fx), glm::mix(at(x0, y1), at(x1, y1), fx), fy);
}

Picture load_picture(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    return format_of(bytes, path).decode(bytes, path.string());
}

std::shared_ptr<const ImagePyramid> load_image_pyramid(const std::filesystem::path& path) {
    try {
        return std::make_shared<const ImagePyramid>(load_picture(path));
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace relumine::cubemap
