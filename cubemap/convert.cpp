#include "cubemap/convert.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/projection.h"
#include "cubemap/resample.h"
#include "cubemap/resample_lat_long.h"
#include "cubemap/resample_projection.h"

namespace relumine::cubemap {

namespace {

EnvironmentImage empty_image(const ImageShape& shape) {
    EnvironmentImage image;
    image.width = shape.width;
    image.height = shape.height;
    image.layout = shape.layout;
    image.sampling = shape.sampling;
    image.pixels.resize(static_cast<std::size_t>(shape.width) * shape.height);
    return image;
}

ImageShape shape_of(const EnvironmentImage& image) {
    return {image.layout, image.sampling, image.width, image.height};
}

std::uint32_t natural_resolution(const ImageShape& shape) {
    EnvironmentImage image;
    image.layout = shape.layout;
    image.width = shape.width;
    image.height = shape.height;
    return cubemap::natural_resolution(image);
}

/// Pixel by pixel, where every target pixel lies on a source pixel.
std::optional<EnvironmentImage> copied(const EnvironmentImage& image, const ImageShape& target,
                                       const Reorientation& reorientation) {
    if (has_faces(image.layout) != has_faces(target.layout) ||
        (!has_faces(image.layout) && image.layout != target.layout) || image.sampling != target.sampling ||
        natural_resolution(target) != natural_resolution(shape_of(image)))
        return std::nullopt;
    // A lat-long's poles with samples on the borders are one direction for a whole row.
    if (image.layout == Layout::LatLong && image.sampling == Sampling::Borders &&
        reorientation.target_from_source() != glm::dmat3(1.0))
        return std::nullopt;
    const glm::dmat3 source_from_target = glm::transpose(reorientation.target_from_source());
    if (shape_of(image) == target && source_from_target == glm::dmat3(1.0))
        return image;
    EnvironmentImage result = empty_image(target);
    const ImageShape source = shape_of(image);
    bool complete = true;
    for_each_pixel(target, [&](std::size_t index, const PixelPlace& place) {
        if (!complete)
            return;
        const auto from = pixel_at(source, source_from_target * place.direction);
        complete = from.has_value();
        if (from)
            result.pixels[index] = image.pixels[*from];
    });
    return complete ? std::optional(std::move(result)) : std::nullopt;
}

/// The cube map that holds a cube image exactly: cells with borders half a sample off are two texels wide.
std::uint32_t exact_resolution(const ImageShape& shape) {
    const std::uint32_t faces = natural_resolution(shape);
    return shape.sampling == Sampling::Borders && faces > 1 ? 2 * (faces - 1) : faces;
}

bool is_quarter(const Reorientation& reorientation) {
    const double quarters = reorientation.degrees_about_y / 90.0;
    return quarters == std::round(quarters);
}

CubeMap reoriented(const CubeMap& map, const Reorientation& reorientation) {
    if (is_quarter(reorientation))
        return turned(map, reorientation.target_from_source());
    const CubeMap world =
        rotated(turned(map, reorientation.world_from_source), reorientation.degrees_about_y);
    return turned(world, glm::transpose(reorientation.world_from_target));
}

/// The resolution of the cube map on the way: a cube's own, else fine enough to add no blur that matters.
std::uint32_t resolution_between(const ImageShape& source, const ImageShape& target) {
    if (has_faces(source.layout))
        return exact_resolution(source);
    if (has_faces(target.layout))
        return exact_resolution(target);
    constexpr std::uint32_t Finest = 4096;
    return std::min(2 * std::max(natural_resolution(source), natural_resolution(target)),
                    std::max({Finest, natural_resolution(source), natural_resolution(target)}));
}

/// Averaging from one shape to another and back; finds the overlaps of a Projection once.
class Path {
public:
    Path(const ImageShape& source, const ImageShape& target, const Reorientation& reorientation, bool keep)
        : source_{source, {}}, target_{target, {}}, forth_(reorientation), back_(reorientation.inverse()) {
        if (!keep)
            return;
        for (End* end : {&source_, &target_}) {
            if (projection(end->shape.layout) != nullptr)
                end->overlaps = std::make_unique<detail::ProjectionOverlaps>(
                    end->shape, resolution_between(source, target));
        }
    }
    /// Each target pixel is the mean over its patch.
    [[nodiscard]] EnvironmentImage forth(const EnvironmentImage& image) const {
        return averaged(image, source_, target_, forth_);
    }
    [[nodiscard]] EnvironmentImage back(const EnvironmentImage& image) const {
        return averaged(image, target_, source_, back_);
    }

private:
    struct End {
        ImageShape shape;
        std::unique_ptr<detail::ProjectionOverlaps> overlaps;
    };

    [[nodiscard]] static EnvironmentImage averaged(const EnvironmentImage& image, const End& from,
                                                   const End& to, const Reorientation& reorientation) {
        if (from.shape.layout == Layout::LatLong && has_faces(to.shape.layout) && is_quarter(reorientation))
            return faces_from_lat_long(image, to.shape, reorientation);
        const std::uint32_t resolution = resolution_between(from.shape, to.shape);
        const CubeMap map = reoriented(
            from.overlaps ? from.overlaps->to_cube(image) : resample(image, resolution), reorientation);
        if (!to.overlaps)
            return to_image(map, to.shape.layout, to.shape.width, to.shape.height, to.shape.sampling);
        EnvironmentImage result = empty_image(to.shape);
        to.overlaps->fill(map, result);
        return result;
    }

    /// Straight into the cube's cells, wherever their samples lie.
    [[nodiscard]] static EnvironmentImage faces_from_lat_long(const EnvironmentImage& image,
                                                              const ImageShape& target,
                                                              const Reorientation& reorientation) {
        const FaceCells cells(target.layout, target.width, target.height);
        const CubeMap map = turned(detail::cube_from_lat_long(image, cells.resolution(), target.sampling),
                                   reorientation.target_from_source());
        EnvironmentImage result = empty_image(target);
        for (const Face face : AllFaces) {
            for (std::uint32_t y = 0; y < map.resolution; ++y) {
                for (std::uint32_t x = 0; x < map.resolution; ++x)
                    result.pixels[cells.pixel(face, x, y)] = map.at(face, x, y);
            }
        }
        return result;
    }

    End source_, target_;
    Reorientation forth_, back_;
};

/// Bilinear over the sphere, then averaged over the target's pixels: a smooth start that keeps energy only roughly.
EnvironmentImage interpolated(const EnvironmentImage& image, const ImageShape& target,
                              const Reorientation& reorientation) {
    // A lat-long's pixels are narrower than the texels of its natural resolution in the middle of a face.
    const std::uint32_t natural = natural_resolution(shape_of(image));
    const std::uint32_t coarse = has_faces(image.layout) ? natural : natural + natural / 4 + 1;
    const CubeMap source = reoriented(resample(image, coarse), reorientation);
    const std::uint32_t fine =
        has_faces(target.layout) ? exact_resolution(target) : 2 * natural_resolution(target);
    CubeMap map(fine);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, fine), [&](const auto& rows) {
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < fine; ++x)
                    map.at(face, x, y) = sample(source, glm::vec3(texel_direction(face, x, y, fine)));
            }
        }
    });
    return to_image(map, target.layout, target.width, target.height, target.sampling);
}

/// Multiplies `grown` by what `path.back(grown)` lacks of the image, spread over the patches (Richardson 1972, Lucy 1974). Every round keeps the
/// image's total power exactly, nothing becomes negative, and a constant stays as it is.
void correct(const EnvironmentImage& image, const Path& path, int num_rounds, EnvironmentImage& grown) {
    for (int round = 0; round < num_rounds; ++round) {
        EnvironmentImage ratio = path.back(grown);
        double difference = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < ratio.pixels.size(); ++i) {
            for (int channel = 0; channel < 3; ++channel) {
                const float have = ratio.pixels[i][channel], want = image.pixels[i][channel];
                difference += std::abs(static_cast<double>(have) - want);
                sum += want;
                ratio.pixels[i][channel] = have > 0.0f ? want / have : 1.0f;
            }
        }
        constexpr double Enough = 1e-5;
        if (round > 0 && difference <= Enough * sum)
            return;
        const EnvironmentImage factor = path.forth(ratio);
        for (std::size_t i = 0; i < grown.pixels.size(); ++i)
            grown.pixels[i] *= factor.pixels[i];
    }
}

} // namespace

glm::dmat3 Reorientation::target_from_source() const {
    return glm::transpose(world_from_target) * turn_about_y(degrees_about_y) * world_from_source;
}

Reorientation Reorientation::inverse() const {
    return {world_from_target, -degrees_about_y, world_from_source};
}

EnvironmentImage convert(const EnvironmentImage& image, const ImageShape& target,
                         const Reorientation& reorientation) {
    if (!fits(target.layout, target.width, target.height))
        throw std::invalid_argument(
            fmt::format("convert: a {} cannot be {}x{}", name(target.layout), target.width, target.height));
    if (auto copy = copied(image, target, reorientation))
        return std::move(*copy);
    // At about the same size there is nothing to make smooth, and hardly room for corrections.
    const bool grows = 5 * natural_resolution(target) > 6 * natural_resolution(shape_of(image));
    // Rounds cost as much as two conversions each. In pictures this large no sun is lost in a pixel any more.
    constexpr std::size_t Large = std::size_t{1} << 21;
    const bool is_large = std::max(image.pixels.size(), std::size_t{target.width} * target.height) > Large;
    const Path path(shape_of(image), target, reorientation, grows && !is_large);
    EnvironmentImage result = grows ? interpolated(image, target, reorientation) : path.forth(image);
    if (grows)
        correct(image, path, is_large ? 2 : 10, result);
    result.assumptions = "converted";
    return result;
}

std::uint32_t conversion_resolution(const EnvironmentImage& image) {
    constexpr std::uint32_t Roomy = 256;
    return std::max(natural_resolution(shape_of(image)), Roomy);
}

} // namespace relumine::cubemap
