#include "viewer/quadtree_lines.h"

#include <algorithm>
#include <cstdint>

#include "relumine/in/environment_files.h"
#include "viewer/lat_long_view.h"

namespace relumine::viewer {

std::vector<glm::vec2> quadtree_lines(const prt::Quadtree& quadtree) {
    std::vector<glm::vec2> ends;
    const auto append_line = [&](cubemap::Face face, glm::dvec2 from, glm::dvec2 to,
                                 int num_pieces) {
        std::vector<glm::dvec3> line;
        for (int i = 0; i <= num_pieces; ++i) {
            const glm::dvec2 at = from + (to - from) * (static_cast<double>(i) / num_pieces);
            line.push_back(cubemap::direction(face, at.x, at.y));
        }
        const std::vector<glm::dvec2> uv = unrolled(line);
        for (std::size_t i = 0; i + 1 < uv.size(); ++i) {
            ends.emplace_back(uv[i]);
            ends.emplace_back(uv[i + 1]);
        }
    };
    for (const prt::Cell& cell : quadtree.leaves()) {
        // A whole face needs 32 pieces to look round. A cell of 1/32 of the face's width needs one.
        const int num_pieces = std::max(1, 32 >> std::min<int>(cell.level, 5));
        const double size = cell.size();
        const glm::dvec2 corner(cell.x * size, cell.y * size);
        // Every cell draws its left and top. Right and bottom are drawn only at the face's edge;
        // elsewhere a neighbour draws them.
        append_line(cell.face, corner, corner + glm::dvec2(size, 0.0), num_pieces);
        append_line(cell.face, corner, corner + glm::dvec2(0.0, size), num_pieces);
        const std::uint32_t last = (1u << cell.level) - 1u;
        if (cell.x == last)
            append_line(cell.face, corner + glm::dvec2(size, 0.0), corner + glm::dvec2(size),
                        num_pieces);
        if (cell.y == last)
            append_line(cell.face, corner + glm::dvec2(0.0, size), corner + glm::dvec2(size),
                        num_pieces);
    }
    return ends;
}

} // namespace relumine::viewer
