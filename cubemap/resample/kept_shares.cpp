#include "cubemap/resample/kept_shares.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <span>

#include "cubemap/resample/pixel_shares.h"
#include "files/large_vector.h"
#include "files/parallel.h"

namespace relumine::cubemap::detail {

KeptShares::KeptShares(const ImageShape& shape, std::uint32_t resolution)
    : shape_(shape), resolution_(resolution),
      symmetries_(pixel_symmetries(shape, glm::dmat3(1.0), resolution)), rows_(shape.height) {
    for (const PixelSymmetry& symmetry : symmetries_) {
        auto& faces = moved_faces_.emplace_back();
        for (const Face face : AllFaces)
            faces[static_cast<std::size_t>(face)] = static_cast<std::uint32_t>(
                symmetry.texel(face, 0, 0) / (std::size_t{resolution} * resolution));
    }
    files::parallel_for(files::IndexRange<std::uint32_t>(0, shape.height), [&](const auto& rows) {
        RowsOfShares finder(shape_, glm::dmat3(1.0), resolution_, symmetries_);
        for (std::uint32_t y = rows.begin(); y != rows.end(); ++y)
            rows_[y] = found_row(y, finder);
    });
}

KeptShares::Row KeptShares::found_row(std::uint32_t y, RowsOfShares& finder) const {
    Row row;
    finder.find_first(
        y, [&](std::size_t pixel, std::uint32_t x, std::span<const RowsOfShares::Found> found) {
            std::uint32_t images = 0, faces = 0;
            for_each_image(symmetries_, pixel, x, y,
                           [&](std::size_t i, std::size_t) { images |= 1u << i; });
            for (const RowsOfShares::Found& each : found) {
                faces |= 1u << static_cast<unsigned>(each.face);
                row.texels.push_back({static_cast<std::uint32_t>(each.face) & 0xf, each.x & 0x3fff,
                                      each.y & 0x3fff});
                row.solid_angles.push_back(each.solid_angle);
            }
            row.pixels.push_back({x, static_cast<std::uint32_t>(row.texels.size()), images, faces});
        });
    return row;
}

CubeMap KeptShares::to_cube(const std::vector<glm::vec3>& pixels) const {
    CubeMap map(resolution_);
    // Each face has one writer, who adds in the order of the rows. A thread's faces share memory.
    std::atomic<std::size_t> next_face = 0;
    files::parallel_for(std::size_t{0}, files::num_threads(), [&](std::size_t) {
        std::vector<Sum> sums;
        for (std::size_t face = next_face++; face < NumFaces; face = next_face++)
            fill_face(pixels, face, sums, map);
    });
    return map;
}

void KeptShares::fill_face(const std::vector<glm::vec3>& pixels, std::size_t face,
                           std::vector<Sum>& sums, CubeMap& map) const {
    const std::size_t size = std::size_t{resolution_} * resolution_;
    sums.assign(size, {});
    for (std::uint32_t y = 0; y < shape_.height; ++y) {
        const Row& row = rows_[y];
        std::uint32_t begin = 0;
        for (const Pixel& pixel : row.pixels) {
            for (std::uint32_t images = pixel.images; images != 0; images &= images - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(images));
                // The faces that this symmetry carries to `face`: one.
                const auto& moved = moved_faces_[i];
                const auto from = static_cast<std::uint32_t>(
                    std::find(moved.begin(), moved.end(), face) - moved.begin());
                if ((pixel.faces >> from & 1u) == 0)
                    continue;
                const glm::dvec3 radiance = pixels[symmetries_[i].pixel(pixel.x, y)];
                for (std::uint32_t k = begin; k < pixel.end; ++k) {
                    const Texel& texel = row.texels[k];
                    if (texel.face != from)
                        continue;
                    Sum& sum =
                        sums[symmetries_[i].texel(AllFaces[from], texel.x, texel.y) - face * size];
                    sum.radiance += radiance * row.solid_angles[k];
                    sum.weight += row.solid_angles[k];
                }
            }
            begin = pixel.end;
        }
    }
    for (std::size_t i = 0; i < size; ++i)
        if (sums[i].weight > 0.0)
            map.texels[face * size + i] = glm::vec3(sums[i].radiance / sums[i].weight);
}

std::vector<glm::vec3> KeptShares::to_pixels(const CubeMap& map) const {
    auto pixels = files::large_vector<glm::vec3>(std::size_t{shape_.width} * shape_.height);
    files::parallel_for(std::uint32_t{0}, shape_.height, [&](std::uint32_t y) {
        const Row& row = rows_[y];
        std::uint32_t begin = 0;
        for (const Pixel& pixel : row.pixels) {
            double weights = 0.0;
            for (std::uint32_t k = begin; k < pixel.end; ++k)
                weights += row.solid_angles[k];
            for (std::uint32_t images = pixel.images; images != 0; images &= images - 1) {
                const PixelSymmetry& symmetry =
                    symmetries_[static_cast<std::size_t>(std::countr_zero(images))];
                glm::dvec3 sum(0.0);
                for (std::uint32_t k = begin; k < pixel.end; ++k) {
                    const Texel& texel = row.texels[k];
                    sum += glm::dvec3(
                               map.texels[symmetry.texel(AllFaces[texel.face], texel.x, texel.y)]) *
                           row.solid_angles[k];
                }
                pixels[symmetry.pixel(pixel.x, y)] = sum / weights;
            }
            begin = pixel.end;
        }
    });
    return pixels;
}

} // namespace relumine::cubemap::detail
