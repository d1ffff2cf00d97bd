#include "cubemap/resample/resample.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "cubemap/image/image_layout.h"
#include "cubemap/resample/pixel_shares.h"
#include "cubemap/resample/resample_lat_long.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

/// The part [begin, end], in [0, 1], of a source cell under a destination cell.
struct Overlap {
    std::uint32_t source;
    double begin, end;
};

/// Returns the source cells under each destination cell.
std::vector<std::vector<Overlap>> overlaps(const std::vector<double>& source,
                                           const std::vector<double>& destination) {
    std::vector<std::vector<Overlap>> found(destination.size() - 1);
    std::uint32_t cell = 0;
    for (std::size_t i = 0; i + 1 < destination.size(); ++i) {
        while (source[cell + 1] <= destination[i])
            ++cell;
        for (std::uint32_t j = cell; j + 1 < source.size() && source[j] < destination[i + 1]; ++j)
            found[i].push_back({j, std::max(source[j], destination[i]),
                                std::min(source[j + 1], destination[i + 1])});
    }
    return found;
}

/// Returns the solid_angle() of a rectangle, faster for small ones. There are millions of them.
double small_solid_angle(const Overlap& x, const Overlap& y) {
    const double width = 2.0 * (x.end - x.begin), height = 2.0 * (y.end - y.begin);
    // The midpoint rule with its second-order term has a relative error of 0.023 h^4: 3e-8 here.
    constexpr double Small = 1.0 / 32.0;
    if (width > Small || height > Small)
        return solid_angle(x.begin, y.begin, x.end, y.end);
    const double u = x.begin + x.end - 1.0, v = y.begin + y.end - 1.0;
    const double inverse = 1.0 / (1.0 + u * u + v * v);
    const double slope = -3.0 * inverse, bend = 15.0 * inverse * inverse;
    return width * height * inverse * std::sqrt(inverse) *
           (1.0 +
            ((slope + bend * u * u) * width * width + (slope + bend * v * v) * height * height) /
                24.0);
}

/// Resamples six faces to six faces if all cells are rectangles of the same face. `source_of(face,
/// x, y)` reads, `write(face, x, y, radiance)` writes.
template<typename SourceOf, typename Write>
void resample_faces(const std::vector<double>& source_borders,
                    const std::vector<double>& destination_borders, const SourceOf& source_of,
                    const Write& write) {
    const auto found = overlaps(source_borders, destination_borders);
    const auto resolution = static_cast<std::uint32_t>(found.size());
    files::parallel_for(files::IndexRange<std::uint32_t>(0, resolution), [&](const auto& rows) {
        for (const Face face : AllFaces) {
            for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                for (std::uint32_t x = 0; x < resolution; ++x) {
                    if (found[x].size() == 1 && found[y].size() == 1) {
                        write(face, x, y, source_of(face, found[x][0].source, found[y][0].source));
                        continue;
                    }
                    glm::dvec3 sum(0.0);
                    double weights = 0.0;
                    for (const Overlap& row : found[y]) {
                        for (const Overlap& column : found[x]) {
                            const double weight = small_solid_angle(column, row);
                            sum += glm::dvec3(source_of(face, column.source, row.source)) * weight;
                            weights += weight;
                        }
                    }
                    write(face, x, y, glm::vec3(sum / weights));
                }
            }
        }
    });
}

/// Returns a picture of a Projection as a cube map: means over exact overlaps, added in the order
/// of the shares.
CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution) {
    CubeMap map(resolution);
    std::vector<glm::dvec3> sums(map.texels.size(), glm::dvec3(0.0));
    std::vector<double> weights(map.texels.size(), 0.0);
    const auto add = [&](const detail::PixelShare& share) {
        sums[share.texel] += glm::dvec3(image.pixels[share.pixel]) * share.solid_angle;
        weights[share.texel] += share.solid_angle;
    };
    detail::for_each_row_of_shares(shape_of(image), glm::dmat3(1.0), resolution,
                                   [&](std::span<const detail::PixelShare> shares) {
                                       std::for_each(shares.begin(), shares.end(), add);
                                   });
    for (std::size_t i = 0; i < sums.size(); ++i)
        map.texels[i] = weights[i] > 0.0 ? glm::vec3(sums[i] / weights[i]) : glm::vec3(0.0f);
    return map;
}

void check(const EnvironmentImage& image) {
    if (image.pixels.size() != static_cast<std::size_t>(image.width) * image.height ||
        !fits(image.layout, image.width, image.height))
        throw std::invalid_argument(
            fmt::format("resample: a {} image cannot be {}x{} with {} pixels", name(image.layout),
                        image.width, image.height, image.pixels.size()));
}

} // namespace

CubeMap resample(const EnvironmentImage& image, std::uint32_t resolution) {
    check(image);
    if (image.layout == Layout::LatLong)
        return detail::cube_from_lat_long(image, resolution);
    if (!has_faces(image.layout))
        return cube_from_projection(image, resolution);
    CubeMap map(resolution);
    const FaceSquares squares(image.layout, image.width, image.height);
    resample_faces(
        cell_borders(squares.resolution(), image.sampling),
        cell_borders(resolution, Sampling::TexelCentres),
        [&](Face face, std::uint32_t x, std::uint32_t y) {
            return image.pixels[squares.pixel(face, x, y)];
        },
        [&](Face face, std::uint32_t x, std::uint32_t y, const glm::vec3& radiance) {
            map.at(face, x, y) = radiance;
        });
    return map;
}

CubeMap resample(const CubeMap& map, std::uint32_t resolution) {
    CubeMap result(resolution);
    resample_faces(
        cell_borders(map.resolution, Sampling::TexelCentres),
        cell_borders(resolution, Sampling::TexelCentres),
        [&](Face face, std::uint32_t x, std::uint32_t y) { return map.at(face, x, y); },
        [&](Face face, std::uint32_t x, std::uint32_t y, const glm::vec3& radiance) {
            result.at(face, x, y) = radiance;
        });
    return result;
}

EnvironmentImage to_image(const CubeMap& map, Layout layout, std::uint32_t width,
                          std::uint32_t height, Sampling sampling) {
    EnvironmentImage image;
    image.width = width;
    image.height = height;
    image.layout = layout;
    image.sampling = sampling;
    image.assumptions = "made from a cube map";
    image.pixels = files::large_vector<glm::vec3>(static_cast<std::size_t>(width) * height);
    check(image);
    if (!has_faces(layout)) {
        detail::fill_from_shares(map, image);
        return image;
    }
    const FaceSquares squares(layout, width, height);
    resample_faces(
        cell_borders(map.resolution, Sampling::TexelCentres),
        cell_borders(squares.resolution(), sampling),
        [&](Face face, std::uint32_t x, std::uint32_t y) { return map.at(face, x, y); },
        [&](Face face, std::uint32_t x, std::uint32_t y, const glm::vec3& radiance) {
            image.pixels[squares.pixel(face, x, y)] = radiance;
        });
    return image;
}

} // namespace relumine::cubemap
