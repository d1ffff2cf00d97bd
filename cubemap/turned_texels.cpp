#include "cubemap/turned_texels.h"

#include <array>
#include <cstddef>
#include <utility>

#include <glm/matrix.hpp>

namespace relumine::cubemap {

TurnedTexels::TurnedTexels(const CubeMap& map, const glm::dmat3& source_from_destination)
    : map_(map), source_from_destination_(source_from_destination),
      is_mirrored_(glm::determinant(source_from_destination) < 0.0) {}

glm::dvec3 TurnedTexels::corner(Face face, std::uint32_t x, std::uint32_t y) const {
    const double n = map_.resolution;
    return source_from_destination_ * cube_point(face, x / n, y / n);
}

void TurnedTexels::find_corners(Face face, std::uint32_t y, std::uint32_t begin, std::uint32_t end,
                                Worker::CornerLine& line) const {
    const double n = map_.resolution;
    line.faces.resize(map_.resolution + 1);
    line.points.resize(map_.resolution + 1);
    const glm::dvec3 first = corner(face, 0, y), across = corner(face, map_.resolution, y) - first;
    for (std::uint32_t x = begin; x <= end; ++x) {
        const FacePoint point = face_point(first + across * (x / n));
        line.faces[x] = point.face;
        line.points[x] = glm::dvec2(point.s, point.t) * n;
    }
}

/// Texels that lie on one face go together; those on several, a share of some 10 / R, by
/// themselves.
void TurnedTexels::fill(Face face, std::uint32_t y, std::uint32_t begin, std::uint32_t end,
                        bool goes_on, Worker& worker, glm::vec3* row) const {
    Worker::CornerLine &top = worker.top_, &bottom = worker.bottom_;
    if (goes_on)
        std::swap(top, bottom);
    else
        find_corners(face, y, begin, end, top);
    find_corners(face, y + 1, begin, end, bottom);
    // In coarser maps TexelOverlaps takes the solid angle in finer cells than texels.
    const bool has_spans = map_.resolution >= TexelOverlaps::FinestCell;
    std::uint32_t x = begin;
    while (x < end) {
        const Face from = top.faces[x];
        TurnedSpan& span = worker.span_;
        span.size = 0;
        const std::uint32_t first = x;
        while (has_spans && x < end && span.size < TurnedSpan::MaxSize && top.faces[x] == from &&
               top.faces[x + 1] == from && bottom.faces[x] == from && bottom.faces[x + 1] == from) {
            std::array<glm::dvec2, 4> corners = {top.points[x], top.points[x + 1],
                                                 bottom.points[x + 1], bottom.points[x]};
            if (is_mirrored_)
                std::swap(corners[1], corners[3]);
            span.add(corners);
            ++x;
        }
        if (span.size > 0)
            mean_under(span, &map_.at(from, 0, 0), map_.resolution, row + first);
        else {
            row[x] = mean_on_several_faces(face, x, y, worker.overlaps_);
            ++x;
        }
    }
}

glm::vec3 TurnedTexels::mean_on_several_faces(Face face, std::uint32_t x, std::uint32_t y,
                                              TexelOverlaps& overlaps) const {
    std::array<glm::dvec3, 4> corners = {corner(face, x, y), corner(face, x + 1, y),
                                         corner(face, x + 1, y + 1), corner(face, x, y + 1)};
    if (is_mirrored_)
        std::swap(corners[1], corners[3]);
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    overlaps.find(corners, [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
        sum += glm::dvec3(map_.at(from, column, row)) * weight;
        weights += weight;
    });
    return glm::vec3(sum / weights);
}

} // namespace relumine::cubemap
