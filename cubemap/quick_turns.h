// Turns of one map that are quick and near, for a slider while it moves.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/mat3x3.hpp>

#include "cubemap/cube_map.h"

namespace relumine::cubemap {

/// Turns a map again and again.
///
/// A texel of the turned map is the map's radiance at the texel's centre, bilinear between centres.
/// Tiles of texels where the map's light is bright beside its neighbours, as at a sun or the edge
/// of a window, are exact, as turned() makes them. So the energy of small lights is kept.
class QuickTurns {
public:
    /// The map needs R >= MinResolution.
    explicit QuickTurns(std::shared_ptr<const CubeMap> map);

    static constexpr std::uint32_t MinResolution = 128;

    /// Returns the map turned by an orthogonal matrix, as cubemap::turned() nearly does.
    ///
    /// Error:   the map's power and the irradiance of any normal are within 3e-4 of the power.
    /// Cost:    O(texels), parallel; near bright edges as much as cubemap::turned().
    [[nodiscard]] CubeMap turned(const glm::dmat3& turn) const;

    /// The map that is turned.
    [[nodiscard]] const CubeMap& map() const { return *map_; }

private:
    /// Red, green, blue, and 1 near a bright edge.
    struct alignas(16) Texel {
        float values[4];
    };

    [[nodiscard]] const Texel* face(Face face) const {
        return texels_.data() + static_cast<std::size_t>(face) * stride_ * stride_;
    }
    void fill_row(Face face, std::uint32_t y, const glm::dmat3& source_from_destination,
                  glm::vec3* row, std::vector<std::uint32_t>& near_edges) const;

    std::shared_ptr<const CubeMap> map_;
    /// R and a texel of border on either side.
    std::size_t stride_;
    /// [6][stride][stride]
    std::vector<Texel> texels_;
};

} // namespace relumine::cubemap
