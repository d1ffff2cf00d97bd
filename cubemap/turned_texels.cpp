#include "cubemap/turned_texels.h"

#include <algorithm>
#include <cstddef>

#include <glm/common.hpp>

namespace relumine::cubemap {

namespace {

std::uint32_t num_parts(std::uint32_t size, std::uint32_t most) {
    return (size + most - 1) / most;
}

/// Whether a tile may meet a face: the bounds of its corners do, in front of the face.
bool meets_face(const TilePlace& place, double width, double height) {
    glm::dvec2 least(1.0), most(-1.0);
    for (const glm::dvec3& corner : {place.corner(0.0, 0.0), place.corner(width, 0.0),
                                     place.corner(0.0, height), place.corner(width, height)}) {
        if (!(corner.z > 0.0))
            return false;
        least = glm::min(least, glm::dvec2(corner) / corner.z);
        most = glm::max(most, glm::dvec2(corner) / corner.z);
    }
    return least.x < 1.0 && least.y < 1.0 && most.x > -1.0 && most.y > -1.0;
}

/// A map's texels from (x, y) of a face on, and those opposite of them.
template<class Texel, class Map>
TurnedTile::BothSides<Texel> both_sides(Map& map, Face face, std::uint32_t x, std::uint32_t y) {
    const std::uint32_t r = map.resolution;
    const std::ptrdiff_t row = r;
    const auto [other, columns_are_mirrored, rows_are_mirrored] = opposite(face);
    return {TexelRows<Texel>{&map.at(face, x, y), 1, row},
            TexelRows<Texel>{&map.at(other, columns_are_mirrored ? r - 1 - x : x,
                                     rows_are_mirrored ? r - 1 - y : y),
                             columns_are_mirrored ? -1 : 1, rows_are_mirrored ? -row : row}};
}

} // namespace

// Tiles are so small that on a face they reach from no side to the other.
TurnedTexels::TurnedTexels(const CubeMap& map, const glm::dmat3& source_from_destination)
    : map_(map),
      num_rows_(num_parts(map.resolution, std::min(TurnedTile::MaxHeight, map.resolution / 8))),
      num_columns_(num_parts(map.resolution, std::min(TurnedTile::MaxWidth, map.resolution / 8))) {
    const double n = map.resolution;
    for (std::size_t face = 0; face < NumFaces; ++face) {
        const auto corner = [&](double s, double t) {
            return source_from_destination * cube_point(AllFaces[face], s, t);
        };
        const glm::dvec3 first = corner(0.0, 0.0);
        for (std::size_t from = 0; from < NumFaces; ++from) {
            const FaceAxes axes(AllFaces[from]);
            places_[face][from] = {axes.parts(first), axes.parts((corner(1.0, 0.0) - first) / n),
                                   axes.parts((corner(0.0, 1.0) - first) / n)};
        }
    }
}

TexelRectangle TurnedTexels::tile(Face face, std::uint32_t row, std::uint32_t column) const {
    const std::uint32_t r = map_.resolution;
    return {.face = face,
            .x0 = column * r / num_columns_,
            .y0 = row * r / num_rows_,
            .x1 = (column + 1) * r / num_columns_,
            .y1 = (row + 1) * r / num_rows_};
}

void TurnedTexels::fill(const TexelRectangle& tile, TurnedTile& sums, CubeMap& turned) const {
    const std::uint32_t width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    sums.begin(width, height);
    for (std::size_t from = 0; from < NumFaces; ++from) {
        TilePlace place = places_[static_cast<std::size_t>(tile.face)][from];
        place.origin = place.corner(tile.x0, tile.y0);
        if (meets_face(place, width, height))
            sums.add(place, both_sides<const glm::vec3>(map_, AllFaces[from], 0, 0),
                     map_.resolution);
    }
    sums.store(both_sides<glm::vec3>(turned, tile.face, tile.x0, tile.y0));
}

} // namespace relumine::cubemap
