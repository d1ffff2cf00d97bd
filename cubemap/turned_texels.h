// Texels of a turned map, exactly.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"
#include "cubemap/turned_span.h"

namespace relumine::cubemap {

/// Mixes texels of a map into those of the turned one. The map must outlive this object.
class TurnedTexels {
public:
    /// What one thread keeps.
    class Worker {
    public:
        explicit Worker(std::uint32_t resolution) : overlaps_(resolution) {}

    private:
        friend TurnedTexels;
        /// A row of the corners of a face's texels, on the map that is turned.
        struct CornerLine {
            std::vector<Face> faces;
            /// In texels of that face.
            std::vector<glm::dvec2> points;
        };
        TexelOverlaps overlaps_;
        CornerLine top_, bottom_;
        TurnedSpan span_;
    };

    TurnedTexels(const CubeMap& map, const glm::dmat3& source_from_destination);

    /// Writes texels [begin, end) of a face's row to row[begin], row[begin + 1] and so on. Where
    /// `goes_on`, the worker's last call was for the row above and the same texels.
    void fill(Face face, std::uint32_t y, std::uint32_t begin, std::uint32_t end, bool goes_on,
              Worker& worker, glm::vec3* row) const;

private:
    [[nodiscard]] glm::dvec3 corner(Face face, std::uint32_t x, std::uint32_t y) const;
    void find_corners(Face face, std::uint32_t y, std::uint32_t begin, std::uint32_t end,
                      Worker::CornerLine& line) const;
    [[nodiscard]] glm::vec3 mean_on_several_faces(Face face, std::uint32_t x, std::uint32_t y,
                                                  TexelOverlaps& overlaps) const;

    const CubeMap& map_;
    glm::dmat3 source_from_destination_;
    bool is_mirrored_;
};

} // namespace relumine::cubemap
