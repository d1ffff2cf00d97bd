#include "cubemap/turned_texels.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

std::uint32_t num_parts(std::uint32_t size, std::uint32_t most) {
    return (size + most - 1) / most;
}

/// Returns a tile of a rectangle whose first texel is (0, 0), cut into rows and columns of tiles.
TexelRectangle tile_of(const TexelRectangle& whole, std::uint32_t num_rows, std::uint32_t row,
                       std::uint32_t num_columns, std::uint32_t column) {
    return {.face = whole.face,
            .x0 = column * whole.x1 / num_columns,
            .y0 = row * whole.y1 / num_rows,
            .x1 = (column + 1) * whole.x1 / num_columns,
            .y1 = (row + 1) * whole.y1 / num_rows};
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

/// Rows of a map's texels: the images of a face's texels from (x, y) on under a symmetry of the
/// cube.
template<class Texel, class Map>
TexelRows<Texel> rows_at(Map& map, const glm::dmat3& symmetry, Face face, std::uint32_t x,
                         std::uint32_t y) {
    const double n = map.resolution;
    const auto texel = [&](std::uint32_t column, std::uint32_t row) -> Texel* {
        const FacePoint point =
            face_point(symmetry * cube_point(face, (column + 0.5) / n, (row + 0.5) / n));
        return &map.at(point.face, static_cast<std::uint32_t>(point.s * n),
                       static_cast<std::uint32_t>(point.t * n));
    };
    return {texel(x, y), texel(1, 0) - texel(0, 0), texel(0, 1) - texel(0, 0)};
}

template<class Texel, class Map>
TexelPair<Texel> pair_at(Map& map, const glm::dmat3& symmetry, Face face, std::uint32_t x,
                         std::uint32_t y) {
    return {rows_at<Texel>(map, symmetry, face, x, y), rows_at<Texel>(map, -symmetry, face, x, y)};
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
    find_symmetries(source_from_destination);
    for (std::size_t face = 0; face < NumFaces; ++face)
        for (const Symmetry& symmetry : symmetries_)
            faces_[face].push_back(
                pair_at<const glm::vec3>(map, symmetry.source, AllFaces[face], 0, 0));
}

/// A turn that carries an axis of the cube to an axis carries quarter turns about the one to those
/// about the other. The middle row of an odd map would be its own image.
void TurnedTexels::find_symmetries(const glm::dmat3& source_from_destination) {
    const std::uint32_t r = map_.resolution;
    symmetries_ = {{glm::dmat3(1.0), glm::dmat3(1.0)}};
    // One face of each two that lie opposite each other.
    for (const Face face : {Face::PositiveX, Face::PositiveY, Face::PositiveZ})
        parts_.push_back({.face = face, .x0 = 0, .y0 = 0, .x1 = r, .y1 = r});
    for (int axis = 0; axis < 3 && r % 2 == 0; ++axis) {
        const glm::dvec3 there = glm::abs(source_from_destination[axis]);
        if (std::max({there.x, there.y, there.z}) != 1.0)
            continue;
        const int second = (axis + 1) % 3, third = (axis + 2) % 3;
        glm::dmat3 quarter(0.0);
        quarter[axis][axis] = quarter[second][third] = 1.0;
        quarter[third][second] = -1.0;
        while (symmetries_.size() < 4) {
            const glm::dmat3 turned = quarter * symmetries_.back().turned;
            const glm::dmat3 source =
                source_from_destination * turned * glm::transpose(source_from_destination);
            symmetries_.push_back(
                {turned, {glm::round(source[0]), glm::round(source[1]), glm::round(source[2])}});
        }
        // A quarter of the face on the axis, and the half of one beside it.
        TexelRectangle& on_axis = parts_[static_cast<std::size_t>(axis)];
        on_axis.x1 = on_axis.y1 = r / 2;
        TexelRectangle& beside = parts_[static_cast<std::size_t>(second)];
        (FaceAxes(beside.face).right[axis] != 0.0 ? beside.x1 : beside.y1) = r / 2;
        parts_.erase(parts_.begin() + third);
        return;
    }
}

void TurnedTexels::fill(const TexelRectangle& tile, TurnedTile& sums, CubeMap& turned) const {
    const std::uint32_t width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    std::vector<TexelPair<glm::vec3>> tiles;
    for (const Symmetry& symmetry : symmetries_)
        tiles.push_back(pair_at<glm::vec3>(turned, symmetry.turned, tile.face, tile.x0, tile.y0));
    std::vector<std::pair<std::size_t, TilePlace>> met;
    for (std::size_t from = 0; from < NumFaces; ++from) {
        TilePlace place = places_[static_cast<std::size_t>(tile.face)][from];
        place.origin = place.corner(tile.x0, tile.y0);
        if (meets_face(place, width, height))
            met.emplace_back(from, place);
    }
    sums.begin(width, height, symmetries_.size());
    for (std::size_t i = 0; i < met.size(); ++i) {
        const auto& [from, place] = met[i];
        sums.add(place, faces_[from], map_.resolution,
                 i + 1 == met.size() ? std::span(tiles) : std::span<TexelPair<glm::vec3>>());
    }
}

void TurnedTexels::fill_all(CubeMap& turned) const {
    const std::uint32_t r = map_.resolution;
    std::vector<TexelRectangle> tiles;
    for (const TexelRectangle& part : parts_) {
        const std::uint32_t rows = num_parts(part.y1, r / num_rows_),
                            columns = num_parts(part.x1, r / num_columns_);
        for (std::uint32_t row = 0; row < rows; ++row)
            for (std::uint32_t column = 0; column < columns; ++column)
                tiles.push_back(tile_of(part, rows, row, columns, column));
    }
    files::parallel_for(files::IndexRange<std::size_t>(0, tiles.size(), 64),
                        [&](const auto& range) {
                            TurnedTile sums;
                            for (std::size_t i = range.begin(); i != range.end(); ++i)
                                fill(tiles[i], sums, turned);
                        });
}

} // namespace relumine::cubemap
