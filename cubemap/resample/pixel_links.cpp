#include "cubemap/resample/pixel_links.h"

#include <span>
#include <utility>

#include <glm/matrix.hpp>

#include "cubemap/resample/pixel_shares.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

/// A part of the sphere that a pixel of each image shows.
struct PixelPair {
    std::uint32_t from, to;
    double solid_angle;
};

/// Sorts overlaps by `to`. Those of one `to` keep their order.
PixelMeans means(std::span<const PixelPair> overlaps, std::size_t num_to) {
    PixelMeans result;
    result.starts.assign(num_to + 1, 0);
    std::vector<double> sums(num_to, 0.0);
    for (const PixelPair& overlap : overlaps) {
        ++result.starts[overlap.to + 1];
        sums[overlap.to] += overlap.solid_angle;
    }
    for (std::size_t i = 1; i < result.starts.size(); ++i)
        result.starts[i] += result.starts[i - 1];
    result.parts.resize(overlaps.size());
    std::vector<std::size_t> next(result.starts.begin(), result.starts.end() - 1);
    for (const PixelPair& overlap : overlaps) {
        const double sum = sums[overlap.to];
        const double part = sum > 0.0 ? overlap.solid_angle / sum : 0.0;
        result.parts[next[overlap.to]++] = {overlap.from, static_cast<float>(part)};
    }
    return result;
}

/// Returns the pixels over each texel of a cube map.
PixelMeans pixels_over_texels(const ImageShape& shape, const glm::dmat3& turn,
                              std::uint32_t resolution) {
    std::vector<PixelPair> overlaps;
    detail::for_each_row_of_shares(
        shape, turn, resolution, [&](std::span<const detail::PixelShare> row) {
            for (const detail::PixelShare& share : row)
                overlaps.push_back({share.pixel, share.texel, share.solid_angle});
        });
    return means(overlaps, std::size_t{NumFaces} * resolution * resolution);
}

} // namespace

PixelLinks::PixelLinks(const ImageShape& source, const ImageShape& target,
                       const glm::dmat3& target_from_source, std::uint32_t resolution, Axes axes) {
    const bool as_source = axes == Axes::Source;
    const PixelMeans over =
        pixels_over_texels(source, as_source ? glm::dmat3(1.0) : target_from_source, resolution);

    // Rows of faces do not come in the order of pixels. So the place of each pixel's overlaps is
    // noted.
    struct Range {
        std::size_t begin = 0, end = 0;
    };
    const std::size_t num_pixels = std::size_t{target.width} * target.height;
    std::vector<Range> ranges(num_pixels);
    std::vector<PixelPair> overlaps;
    const auto add = [&](Range& range, const PixelPair& overlap) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (overlaps[i].from == overlap.from) {
                overlaps[i].solid_angle += overlap.solid_angle;
                return;
            }
        }
        overlaps.push_back(overlap);
        range.end = overlaps.size();
    };
    detail::for_each_row_of_shares(
        target, as_source ? glm::transpose(target_from_source) : glm::dmat3(1.0), resolution,
        [&](std::span<const detail::PixelShare> row) {
            for (const detail::PixelShare& share : row) {
                Range& range = ranges[share.pixel];
                if (range.begin == range.end)
                    range = {overlaps.size(), overlaps.size()};
                for (std::size_t i = over.starts[share.texel]; i < over.starts[share.texel + 1];
                     ++i)
                    add(range, {over.parts[i].pixel, share.pixel,
                                share.solid_angle * static_cast<double>(over.parts[i].part)});
            }
        });
    targets_ = means(overlaps, num_pixels);
    for (PixelPair& overlap : overlaps)
        std::swap(overlap.from, overlap.to);
    sources_ = means(overlaps, std::size_t{source.width} * source.height);
}

std::vector<glm::vec3> PixelMeans::of(const std::vector<glm::vec3>& pixels) const {
    auto result = files::large_vector<glm::vec3>(starts.size() - 1);
    files::parallel_for(files::IndexRange<std::size_t>(0, result.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            glm::dvec3 sum(0.0);
            for (std::size_t k = starts[i]; k < starts[i + 1]; ++k)
                sum += glm::dvec3(pixels[parts[k].pixel]) * static_cast<double>(parts[k].part);
            result[i] = glm::vec3(sum);
        }
    });
    return result;
}

} // namespace relumine::cubemap
