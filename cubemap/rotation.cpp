// Cube maps turned by a matrix.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <glm/matrix.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/spherical_overlap.h"
#include "cubemap/turned_span.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

struct Angle {
    double cosine, sine;
};

/// Exact for multiples of 90 degrees.
Angle angle_of(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters != std::round(quarters)) {
        const double angle = std::fmod(degrees, 360.0) * std::numbers::pi / 180.0;
        return {std::cos(angle), std::sin(angle)};
    }
    constexpr std::array<double, 4> Cosines = {1.0, 0.0, -1.0, 0.0};
    const auto quarter = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
    return {Cosines[quarter], Cosines[(quarter + 3) % 4]};
}

/// A row of the corners of a face's texels, on the map that is turned.
struct CornerLine {
    std::vector<Face> faces;
    /// In texels of that face.
    std::vector<glm::dvec2> points;
};

/// Mixes texels of a map into those of the turned one.
class TurnedMap {
public:
    TurnedMap(const CubeMap& map, const glm::dmat3& source_from_destination)
        : map_(map), source_from_destination_(source_from_destination),
          is_mirrored_(glm::determinant(source_from_destination) < 0.0) {}

    [[nodiscard]] CubeMap texels() const {
        CubeMap result(map_.resolution);
        files::parallel_for(files::IndexRange<std::uint32_t>(0, map_.resolution),
                            [&](const auto& rows) {
                                Worker worker{TexelOverlaps(map_.resolution), {}, {}, {}};
                                for (const Face face : AllFaces) {
                                    find_corners(face, rows.begin(), worker.top);
                                    for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
                                        find_corners(face, y + 1, worker.bottom);
                                        fill_row(face, y, worker, &result.at(face, 0, y));
                                        std::swap(worker.top, worker.bottom);
                                    }
                                }
                            });
        return result;
    }

private:
    /// What one thread keeps.
    struct Worker {
        TexelOverlaps overlaps;
        CornerLine top, bottom;
        TurnedSpan span;
    };

    [[nodiscard]] glm::dvec3 corner(Face face, std::uint32_t x, std::uint32_t y) const {
        const double n = map_.resolution;
        return source_from_destination_ * cube_point(face, x / n, y / n);
    }

    void find_corners(Face face, std::uint32_t y, CornerLine& line) const {
        const double n = map_.resolution;
        line.faces.resize(map_.resolution + 1);
        line.points.resize(map_.resolution + 1);
        const glm::dvec3 first = corner(face, 0, y),
                         across = corner(face, map_.resolution, y) - first;
        for (std::uint32_t x = 0; x <= map_.resolution; ++x) {
            const FacePoint point = face_point(first + across * (x / n));
            line.faces[x] = point.face;
            line.points[x] = glm::dvec2(point.s, point.t) * n;
        }
    }

    /// Texels that lie on one face go together; those on several, a share of some 10 / R, by
    /// themselves.
    void fill_row(Face face, std::uint32_t y, Worker& worker, glm::vec3* row) const {
        const CornerLine &top = worker.top, &bottom = worker.bottom;
        // In coarser maps TexelOverlaps takes the solid angle in finer cells than texels.
        const bool has_spans = map_.resolution >= TexelOverlaps::FinestCell;
        std::uint32_t x = 0;
        while (x < map_.resolution) {
            const Face from = top.faces[x];
            TurnedSpan& span = worker.span;
            span.size = 0;
            const std::uint32_t begin = x;
            while (has_spans && x < map_.resolution && span.size < TurnedSpan::MaxSize &&
                   top.faces[x] == from && top.faces[x + 1] == from && bottom.faces[x] == from &&
                   bottom.faces[x + 1] == from) {
                std::array<glm::dvec2, 4> corners = {top.points[x], top.points[x + 1],
                                                     bottom.points[x + 1], bottom.points[x]};
                if (is_mirrored_)
                    std::swap(corners[1], corners[3]);
                span.add(corners);
                ++x;
            }
            if (span.size > 0)
                mean_under(span, &map_.at(from, 0, 0), map_.resolution, row + begin);
            else {
                row[x] = mean_on_several_faces(face, x, y, worker.overlaps);
                ++x;
            }
        }
    }

    [[nodiscard]] glm::vec3 mean_on_several_faces(Face face, std::uint32_t x, std::uint32_t y,
                                                  TexelOverlaps& overlaps) const {
        std::array<glm::dvec3, 4> corners = {corner(face, x, y), corner(face, x + 1, y),
                                             corner(face, x + 1, y + 1), corner(face, x, y + 1)};
        if (is_mirrored_)
            std::swap(corners[1], corners[3]);
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        overlaps.find(corners,
                      [&](Face from, std::uint32_t column, std::uint32_t row, double weight) {
                          sum += glm::dvec3(map_.at(from, column, row)) * weight;
                          weights += weight;
                      });
        return glm::vec3(sum / weights);
    }

    const CubeMap& map_;
    glm::dmat3 source_from_destination_;
    bool is_mirrored_;
};

/// By a matrix that carries axes to axes.
CubeMap moved(const CubeMap& map, const glm::dmat3& source_from_destination) {
    CubeMap result(map.resolution);
    const auto texel = [&](double s) {
        return std::min(static_cast<std::uint32_t>(s * map.resolution), map.resolution - 1);
    };
    files::parallel_for(std::uint32_t{0}, map.resolution, [&](std::uint32_t y) {
        for (const Face face : AllFaces)
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const FacePoint source = face_point(source_from_destination *
                                                    texel_direction(face, x, y, map.resolution));
                result.at(face, x, y) = map.at(source.face, texel(source.s), texel(source.t));
            }
    });
    return result;
}

} // namespace

bool carries_axes_to_axes(const glm::dmat3& turn) {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            const double entry = std::abs(turn[column][row]);
            if (entry != 0.0 && entry != 1.0)
                return false;
        }
    }
    return true;
}

CubeMap turned(const CubeMap& map, const glm::dmat3& turn) {
    if (turn == glm::dmat3(1.0))
        return map;
    const glm::dmat3 source_from_destination = glm::transpose(turn);
    if (carries_axes_to_axes(turn)) {
        return moved(map, source_from_destination);
    }
    return TurnedMap(map, source_from_destination).texels();
}

glm::dmat3 turn_about_y(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{cosine, 0.0, -sine}, {0.0, 1.0, 0.0}, {sine, 0.0, cosine}}; // columns
}

glm::dmat3 turn_about_x(double degrees) {
    const auto [cosine, sine] = angle_of(degrees);
    return {{1.0, 0.0, 0.0}, {0.0, cosine, sine}, {0.0, -sine, cosine}}; // columns
}

CubeMap rotated(const CubeMap& map, double degrees_about_y) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("rotation: expected a finite number of degrees");
    return turned(map, turn_about_y(degrees_about_y));
}

} // namespace relumine::cubemap
