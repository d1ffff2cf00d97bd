// Texels of a turned map.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/texel_rectangle.h"
#include "cubemap/turned_tile.h"

namespace relumine::cubemap {

/// Mixes texels of a map into those of the turned one, a tile at a time. The map must outlive this
/// object.
class TurnedTexels {
public:
    static constexpr std::uint32_t MinResolution = 128;
    /// The map needs R >= MinResolution, and the matrix to be orthogonal.
    TurnedTexels(const CubeMap& map, const glm::dmat3& source_from_destination);

    /// Writes all texels. Parallel (TBB).
    void fill_all(CubeMap& turned) const;

private:
    /// A symmetry of the cube, and the one that its texels have in the map when they have this one
    /// in the turned map.
    struct Symmetry {
        glm::dmat3 turned, source;
    };

    void find_symmetries(const glm::dmat3& source_from_destination);
    /// Writes the texels of a tile and those that symmetries carry it to.
    void fill(const TexelRectangle& tile, TurnedTile& sums, CubeMap& turned) const;

    const CubeMap& map_;
    /// Of tiles on a face
    std::uint32_t num_rows_, num_columns_;
    /// [face of the turned map][face of the map] the former's first texel on the latter.
    std::array<std::array<TilePlace, NumFaces>, NumFaces> places_;
    /// Turns, the identity first. Each turn times -1 is a symmetry, too.
    std::vector<Symmetry> symmetries_;
    /// Rectangles of the turned map. Of texels that symmetries carry to each other, one lies here.
    std::vector<TexelRectangle> parts_;
    /// [face of the map] what lies there by each symmetry.
    std::array<std::vector<TexelPair<const glm::vec3>>, NumFaces> faces_;
};

} // namespace relumine::cubemap
