#include "cubemap/resample/pixel_links.h"

#include <algorithm>
#include <span>

#include <glm/matrix.hpp>

#include "cubemap/resample/pixel_shares.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

/// The pixels over each texel of a cube map. Each has a part of the texel; the parts add up to 1.
class TexelPixels {
public:
    TexelPixels(const ImageShape& shape, const glm::dmat3& turn, std::uint32_t resolution)
        : starts_(std::size_t{NumFaces} * resolution * resolution + 1, 0) {
        std::vector<detail::PixelShare> shares;
        detail::for_each_row_of_shares(shape, turn, resolution,
                                       [&](std::span<const detail::PixelShare> row) {
                                           shares.insert(shares.end(), row.begin(), row.end());
                                       });
        std::vector<double> sums(starts_.size() - 1, 0.0);
        for (const detail::PixelShare& share : shares) {
            ++starts_[share.texel + 1];
            sums[share.texel] += share.solid_angle;
        }
        for (std::size_t i = 1; i < starts_.size(); ++i)
            starts_[i] += starts_[i - 1];
        parts_.resize(shares.size());
        std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
        for (const detail::PixelShare& share : shares)
            parts_[next[share.texel]++] = {
                share.pixel, static_cast<float>(share.solid_angle / sums[share.texel])};
    }

    struct Part {
        std::uint32_t pixel;
        float part;
    };
    [[nodiscard]] std::span<const Part> over(std::uint32_t texel) const {
        return std::span(parts_).subspan(starts_[texel], starts_[texel + 1] - starts_[texel]);
    }

private:
    std::vector<std::size_t> starts_;
    std::vector<Part> parts_;
};

} // namespace

PixelLinks::PixelLinks(const ImageShape& source, const ImageShape& target,
                       const glm::dmat3& target_from_source, std::uint32_t resolution, Axes axes)
    : num_source_pixels_(static_cast<std::size_t>(source.width) * source.height),
      source_angles_(num_source_pixels_, 0.0) {
    const bool as_source = axes == Axes::Source;
    const TexelPixels over(source, as_source ? glm::dmat3(1.0) : target_from_source, resolution);
    const std::size_t num_pixels = static_cast<std::size_t>(target.width) * target.height;

    // Rows of faces do not come in the order of pixels. So the place of each pixel's links is noted
    // first.
    struct Range {
        std::size_t begin = 0, end = 0;
    };
    std::vector<Range> ranges(num_pixels);
    std::vector<std::uint32_t> sources;
    std::vector<double> solid_angles;
    const auto add = [&](Range& range, std::uint32_t pixel, double solid_angle) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (sources[i] == pixel) {
                solid_angles[i] += solid_angle;
                return;
            }
        }
        sources.push_back(pixel);
        solid_angles.push_back(solid_angle);
        range.end = sources.size();
    };
    detail::for_each_row_of_shares(
        target, as_source ? glm::transpose(target_from_source) : glm::dmat3(1.0), resolution,
        [&](std::span<const detail::PixelShare> row) {
            for (const detail::PixelShare& share : row) {
                Range& range = ranges[share.pixel];
                if (range.begin == range.end)
                    range = {sources.size(), sources.size()};
                for (const auto& [pixel, part] : over.over(share.texel))
                    add(range, pixel, share.solid_angle * static_cast<double>(part));
            }
        });

    starts_.reserve(num_pixels + 1);
    starts_.push_back(0);
    sources_.reserve(sources.size());
    solid_angles_.reserve(sources.size());
    for (const Range& range : ranges) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            sources_.push_back(sources[i]);
            solid_angles_.push_back(solid_angles[i]);
            source_angles_[sources[i]] += solid_angles[i];
        }
        starts_.push_back(sources_.size());
    }

    sort_by_source();
}

/// Makes the same links in the order of their source pixels.
void PixelLinks::sort_by_source() {
    source_starts_.assign(num_source_pixels_ + 1, 0);
    for (const std::uint32_t source_pixel : sources_)
        ++source_starts_[source_pixel + 1];
    for (std::size_t i = 1; i < source_starts_.size(); ++i)
        source_starts_[i] += source_starts_[i - 1];
    back_.resize(sources_.size());
    std::vector<std::size_t> next(source_starts_.begin(), source_starts_.end() - 1);
    for (std::size_t i = 0; i + 1 < starts_.size(); ++i) {
        for (std::size_t link = starts_[i]; link < starts_[i + 1]; ++link)
            back_[next[sources_[link]]++] = {static_cast<std::uint32_t>(i),
                                             static_cast<std::uint32_t>(link)};
    }
}

std::vector<glm::vec3> PixelLinks::to_target(const std::vector<glm::vec3>& pixels) const {
    std::vector<glm::vec3> result(starts_.size() - 1);
    files::parallel_for(files::IndexRange<std::size_t>(0, result.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (std::size_t link = starts_[i]; link < starts_[i + 1]; ++link) {
                sum += glm::dvec3(pixels[sources_[link]]) * solid_angles_[link];
                weights += solid_angles_[link];
            }
            result[i] = weights > 0.0 ? glm::vec3(sum / weights) : glm::vec3(0.0f);
        }
    });
    return result;
}

std::vector<glm::vec3> PixelLinks::to_source(const std::vector<glm::vec3>& pixels) const {
    std::vector<glm::vec3> result(num_source_pixels_, glm::vec3(0.0f));
    files::parallel_for(files::IndexRange<std::size_t>(0, result.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            glm::dvec3 sum(0.0);
            for (std::size_t k = source_starts_[i]; k < source_starts_[i + 1]; ++k)
                sum += glm::dvec3(pixels[back_[k].target]) * solid_angles_[back_[k].link];
            if (source_angles_[i] > 0.0)
                result[i] = glm::vec3(sum / source_angles_[i]);
        }
    });
    return result;
}

} // namespace relumine::cubemap
