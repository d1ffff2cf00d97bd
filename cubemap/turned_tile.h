// Mean radiance of the texels of a turned map, a tile of them at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "cubemap/turned_tile_work.h"

namespace relumine::cubemap {

/// Sums over a tile of texels. Keeps its memory; use one for each thread.
///
/// By Green's theorem what comes through a texel is a sum over its edges: of the light to their
/// left on the face, from the first column that the tile meets. So each edge is walked once for
/// the two texels beside it and no polygon is cut. An edge over several faces has a part on each.
///
/// A turn carries opposite directions to opposite ones. So the texels opposite of a tile mix those
/// opposite of its own, in the same parts, and both are summed along the same edges. So are more
/// pairs where the turn carries symmetries of the cube to symmetries of the cube.
class TurnedTile {
public:
    /// Texels, at most.
    static constexpr std::uint32_t MaxWidth = TileWork::MaxWidth, MaxHeight = TileWork::MaxHeight;

    TurnedTile() : work_(new TileWork) {} // its arrays stay as they come

    /// Starts so many pairs of width x height texels.
    void begin(std::uint32_t width, std::uint32_t height, std::size_t num_pairs = 1);

    /// Adds what comes from a face of R x R texels, R >= 128, to the first pair's tile, and from
    /// the face's images under symmetries of the cube to the images of the tile. [pairs] the same
    /// row and column is the same place of the face. All corners lie in front of the face: z > 0.
    /// The density of solid angle is taken to second order about each texel's middle, as
    /// solid_angle_about() does. What the tile meets of the face must not reach from its left side
    /// to its right one. With the last face writes the mean radiance over the solid angle of each
    /// texel to `tiles` [pairs], which is empty before.
    ///
    /// Error:   1e-6 of the largest radiance that a texel meets, beside the expansion's.
    /// Cost:    for each texel of a pair's tile and its opposite 45 to 50 ns with AVX2; 35 ns with
    ///          four pairs.
    void add(const TilePlace& place, std::span<const TexelPair<const glm::vec3>> faces,
             std::uint32_t resolution, std::span<const TexelPair<glm::vec3>> tiles);

private:
    std::unique_ptr<TileWork> work_;
};

} // namespace relumine::cubemap
