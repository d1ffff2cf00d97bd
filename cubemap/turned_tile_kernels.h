// The sums of TurnedTile, several edges at a time.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

#include "cubemap/turned_tile_work.h"

namespace relumine::cubemap {

/// Sets where the corners lie.
void place_corners(const TilePlace& place, TileWork& work);
/// Finds the columns of each row of the part, and the densities there. Asks for the texels of the
/// pair that comes first: memory takes as long as the walks along the edges.
void find_columns(const TexelPair<const glm::vec3>& first, TileWork& work);
/// Fills the cells of the part, and asks for the texels of the pair that comes next, if any.
void fill_cells(const TexelPair<const glm::vec3>& faces, const TexelPair<const glm::vec3>* next,
                TileWork& work, TileWork::Pair& pair);
/// Finds the cells of rows of points.
void find_cells(std::size_t num_rows, const TileWork& work, TileWork::Points& points);
/// Sums along the edges from width x height starts, each to the end `to_end` further on. With more
/// than one pair keeps the edges' pieces.
void walk_edges(std::size_t width, std::size_t height, const TileWork::Points& starts,
                const TileWork::Points& ends, std::size_t to_end, const TileWork& work,
                TileWork::Pieces& pieces, TileWork::Sums& sums);
/// Sums along the same edges what the cells hold now.
void sum_edges(std::size_t width, std::size_t height, const TileWork::Pieces& pieces,
               const TileWork& work, TileWork::Sums& sums);
/// Adds to the texels what their edges say.
void add_texels(const TileWork& work, TileWork::Pair& pair);
/// Writes the mean radiance of the texels, with what their edges say added.
void store_means(const TileWork& work, const TileWork::Pair& pair,
                 const TexelPair<glm::vec3>& tiles);

} // namespace relumine::cubemap
