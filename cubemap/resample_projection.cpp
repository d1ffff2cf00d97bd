#include "cubemap/resample_projection.h"

#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/patch.h"
#include "cubemap/projection.h"
#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap::detail {

namespace {

/// What a pixel gives to a texel.
struct Share {
    std::uint32_t pixel;
    std::uint32_t texel;
    double solid_angle;
};

/// Calls `take(shares)` for one row of pixels after the other; rows are found in parallel, a band at a time.
template<typename Take>
void for_each_row(const ImageShape& shape, std::uint32_t resolution, const Take& take) {
    const Projection& picture = *projection(shape.layout);
    const CubeMap map(resolution);
    constexpr std::uint32_t BandHeight = 32;
    std::vector<std::vector<Share>> shares(BandHeight);
    for (std::uint32_t band = 0; band < shape.height; band += BandHeight) {
        const std::uint32_t end = std::min(band + BandHeight, shape.height);
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(band, end), [&](const auto& rows) {
            PatchPieces pieces(picture, shape.width, shape.height);
            TexelOverlaps overlaps(resolution);
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                std::vector<Share>& found = shares[y - band];
                found.clear();
                for (std::uint32_t x = 0; x < shape.width; ++x) {
                    const std::uint32_t pixel = y * shape.width + x; // MaxPixels is below 2^32
                    pieces.visit(x, y, [&](std::span<const glm::dvec3> corners) {
                        overlaps.find(corners, [&](Face face, std::uint32_t column, std::uint32_t row,
                                                   double solid_angle) {
                            found.push_back({pixel, static_cast<std::uint32_t>(map.index(face, column, row)),
                                             solid_angle});
                        });
                    });
                }
            }
        });
        for (std::uint32_t y = band; y < end; ++y)
            take(shares[y - band]);
    }
}

/// Sums that become means, in the order in which shares are added.
class Means {
public:
    explicit Means(std::size_t size) : sums_(size, glm::dvec3(0.0)), weights_(size, 0.0) {}
    void add(std::size_t i, const glm::vec3& radiance, double weight) {
        sums_[i] += glm::dvec3(radiance) * weight;
        weights_[i] += weight;
    }
    void write(std::vector<glm::vec3>& out) const {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = weights_[i] > 0.0 ? glm::vec3(sums_[i] / weights_[i]) : glm::vec3(0.0f);
    }

private:
    std::vector<glm::dvec3> sums_;
    std::vector<double> weights_;
};

ImageShape shape_of(const EnvironmentImage& image) {
    return {image.layout, image.sampling, image.width, image.height};
}

} // namespace

ProjectionOverlaps::ProjectionOverlaps(const ImageShape& shape, std::uint32_t resolution)
    : resolution_(resolution) {
    for_each_row(shape, resolution, [&](const auto& shares) {
        for (const auto& share : shares)
            shares_.push_back({share.pixel, share.texel, share.solid_angle});
    });
}

CubeMap ProjectionOverlaps::to_cube(const EnvironmentImage& image) const {
    CubeMap map(resolution_);
    Means means(map.texels.size());
    for (const Share& share : shares_)
        means.add(share.texel, image.pixels[share.pixel], share.solid_angle);
    means.write(map.texels);
    return map;
}

void ProjectionOverlaps::fill(const CubeMap& map, EnvironmentImage& image) const {
    Means means(image.pixels.size());
    for (const Share& share : shares_)
        means.add(share.pixel, map.texels[share.texel], share.solid_angle);
    means.write(image.pixels);
}

CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution) {
    CubeMap map(resolution);
    Means means(map.texels.size());
    for_each_row(shape_of(image), resolution, [&](const std::vector<Share>& shares) {
        for (const Share& share : shares)
            means.add(share.texel, image.pixels[share.pixel], share.solid_angle);
    });
    means.write(map.texels);
    return map;
}

void fill_projection(const CubeMap& map, EnvironmentImage& image) {
    const Projection& picture = *projection(image.layout);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, image.height), [&](const auto& rows) {
        PatchPieces pieces(picture, image.width, image.height);
        TexelOverlaps overlaps(map.resolution);
        for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
            for (std::uint32_t x = 0; x < image.width; ++x) {
                glm::dvec3 sum(0.0);
                double weights = 0.0;
                pieces.visit(x, y, [&](std::span<const glm::dvec3> corners) {
                    overlaps.find(corners,
                                  [&](Face face, std::uint32_t column, std::uint32_t row, double weight) {
                                      sum += glm::dvec3(map.at(face, column, row)) * weight;
                                      weights += weight;
                                  });
                });
                image.pixels[static_cast<std::size_t>(y) * image.width + x] =
                    weights > 0.0 ? glm::vec3(sum / weights) : glm::vec3(0.0f);
            }
        }
    });
}

} // namespace relumine::cubemap::detail
