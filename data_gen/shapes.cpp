#include "data_gen/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace relumine::data_gen {
namespace {

std::uint32_t next_index(const mesh::TriangleMesh& mesh) {
    return static_cast<std::uint32_t>(mesh.positions.size());
}

// Appends the two triangles of the quad a b c d, counter-clockwise. Alternating diagonals keep
// shadow edges from looking combed.
void append_quad(mesh::TriangleMesh& mesh, const std::array<std::uint32_t, 4>& q, bool flip) {
    if (flip) {
        mesh.triangles.push_back({q[0], q[1], q[3]});
        mesh.triangles.push_back({q[1], q[2], q[3]});
    } else {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
}

// Appends an open grid of (num_u + 1) x (num_v + 1) vertices; d/du x d/dv points outside.
template<typename Position>
void append_grid(mesh::TriangleMesh& mesh, std::uint32_t num_u, std::uint32_t num_v,
                 const Position& position) {
    const std::uint32_t first = next_index(mesh);
    for (std::uint32_t j = 0; j <= num_v; ++j) {
        for (std::uint32_t i = 0; i <= num_u; ++i) {
            mesh.positions.emplace_back(position(i, j));
        }
    }
    for (std::uint32_t j = 0; j < num_v; ++j) {
        for (std::uint32_t i = 0; i < num_u; ++i) {
            const std::uint32_t corner = first + j * (num_u + 1) + i;
            append_quad(mesh, {corner, corner + 1, corner + num_u + 2, corner + num_u + 1},
                        ((i + j) & 1U) != 0);
        }
    }
}

// Cuts [low, high] at the breaks inside it, and the pieces evenly.
std::vector<double> coordinates(double low, double high, std::vector<double> breaks,
                                double spacing) {
    breaks.push_back(low);
    breaks.push_back(high);
    std::sort(breaks.begin(), breaks.end());
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
    std::vector<double> result = {low};
    for (std::size_t i = 1; i < breaks.size(); ++i) {
        const double begin = breaks[i - 1];
        const double end = breaks[i];
        if (begin < low || end > high) {
            continue;
        }
        const std::uint32_t num = num_intervals(end - begin, spacing);
        for (std::uint32_t k = 1; k < num; ++k) {
            result.push_back(begin + (end - begin) * k / num);
        }
        result.push_back(end);
    }
    return result;
}

} // namespace

std::uint32_t num_intervals(double length, double spacing, std::uint32_t minimum) {
    return std::max(minimum, static_cast<std::uint32_t>(std::lround(length / spacing)));
}

void append_box(mesh::TriangleMesh& mesh, const glm::dvec3& min, const glm::dvec3& max,
                double spacing) {
    // Each coordinate depends on its own index alone, so neighbouring faces meet to the bit.
    std::array<std::uint32_t, 3> num = {};
    for (int axis = 0; axis < 3; ++axis) {
        num[static_cast<std::size_t>(axis)] = num_intervals(max[axis] - min[axis], spacing);
    }
    const auto coordinate = [&](int axis, std::uint32_t index) {
        const std::uint32_t n = num[static_cast<std::size_t>(axis)];
        return index == n ? max[axis] : min[axis] + (max[axis] - min[axis]) * index / n;
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (const bool upper : {false, true}) {
            // On the lower side u and v are exchanged, which turns the face around.
            const int u = upper ? (axis + 1) % 3 : (axis + 2) % 3;
            const int v = upper ? (axis + 2) % 3 : (axis + 1) % 3;
            append_grid(mesh, num[static_cast<std::size_t>(u)], num[static_cast<std::size_t>(v)],
                        [&](std::uint32_t i, std::uint32_t j) {
                            glm::dvec3 point;
                            point[axis] = upper ? max[axis] : min[axis];
                            point[u] = coordinate(u, i);
                            point[v] = coordinate(v, j);
                            return point;
                        });
        }
    }
}

void append_wall(mesh::TriangleMesh& mesh, const Wall& wall, double spacing,
                 std::span<const PlaneRectangle> holes) {
    std::array<std::vector<double>, 2> lines;
    for (int side = 0; side < 2; ++side) {
        std::vector<double> breaks;
        for (const PlaneRectangle& hole : holes) {
            breaks.push_back(hole.min[side]);
            breaks.push_back(hole.max[side]);
        }
        lines[static_cast<std::size_t>(side)] =
            coordinates(wall.outline.min[side], wall.outline.max[side], breaks, spacing);
    }
    const std::vector<double>&us = lines[0], &vs = lines[1];
    const auto is_hole = [&](std::size_t i, std::size_t j) {
        const double u = 0.5 * (us[i] + us[i + 1]);
        const double v = 0.5 * (vs[j] + vs[j + 1]);
        return std::any_of(holes.begin(), holes.end(), [&](const PlaneRectangle& hole) {
            return u > hole.min.x && u < hole.max.x && v > hole.min.y && v < hole.max.y;
        });
    };
    // Vertices appear with the first cell that needs them.
    constexpr std::uint32_t None = ~0U;
    std::vector<std::uint32_t> vertices(us.size() * vs.size(), None);
    const auto vertex = [&](std::size_t i, std::size_t j) {
        std::uint32_t& index = vertices[j * us.size() + i];
        if (index == None) {
            index = next_index(mesh);
            glm::dvec3 point;
            point[wall.axis] = wall.at;
            point[(wall.axis + 1) % 3] = us[i];
            point[(wall.axis + 2) % 3] = vs[j];
            mesh.positions.emplace_back(point);
        }
        return index;
    };
    for (std::size_t j = 0; j + 1 < vs.size(); ++j) {
        for (std::size_t i = 0; i + 1 < us.size(); ++i) {
            if (is_hole(i, j)) {
                continue;
            }
            std::array<std::uint32_t, 4> quad = {vertex(i, j), vertex(i + 1, j),
                                                 vertex(i + 1, j + 1), vertex(i, j + 1)};
            if (!wall.faces_up) {
                std::swap(quad[1], quad[3]);
            }
            append_quad(mesh, quad, ((i + j) & 1U) != 0);
        }
    }
}

void append_ground(mesh::TriangleMesh& mesh, double side, std::size_t num_vertices) {
    const double wish = static_cast<double>(num_vertices);
    const double num_z = std::max(2.0, std::round(std::sqrt(wish)));
    const double num_x = std::max(2.0, std::round(wish / num_z));
    append_grid(mesh, static_cast<std::uint32_t>(num_z) - 1, static_cast<std::uint32_t>(num_x) - 1,
                [&](std::uint32_t i, std::uint32_t j) {
                    return glm::dvec3(side * (j / (num_x - 1.0) - 0.5), 0.0,
                                      side * (i / (num_z - 1.0) - 0.5));
                });
}

void append_wrapped_grid(mesh::TriangleMesh& mesh, std::uint32_t num_u, std::uint32_t num_v,
                         const std::function<glm::dvec3(std::uint32_t, std::uint32_t)>& position) {
    const std::uint32_t first = next_index(mesh);
    for (std::uint32_t i = 0; i < num_u; ++i) {
        for (std::uint32_t j = 0; j < num_v; ++j) {
            mesh.positions.emplace_back(position(i, j));
        }
    }
    const auto index = [&](std::uint32_t i, std::uint32_t j) {
        return first + (i % num_u) * num_v + j % num_v;
    };
    for (std::uint32_t i = 0; i < num_u; ++i) {
        for (std::uint32_t j = 0; j < num_v; ++j) {
            append_quad(mesh, {index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)},
                        false);
        }
    }
}

void append_copy(mesh::TriangleMesh& mesh, const mesh::TriangleMesh& part, double azimuth_radians,
                 const glm::dvec3& offset) {
    const std::uint32_t first = next_index(mesh);
    const double c = std::cos(azimuth_radians);
    const double s = std::sin(azimuth_radians);
    for (const glm::dvec3 p : part.positions) {
        mesh.positions.emplace_back(glm::dvec3(c * p.x + s * p.z, p.y, c * p.z - s * p.x) + offset);
    }
    for (const auto& [a, b, d] : part.triangles) {
        mesh.triangles.push_back({first + a, first + b, first + d});
    }
}

} // namespace relumine::data_gen
