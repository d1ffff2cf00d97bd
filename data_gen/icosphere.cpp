#include "data_gen/icosphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::data_gen {
namespace {

constexpr std::uint32_t NumCorners = 12;
constexpr std::uint32_t NumEdges = 30;

constexpr std::array<mesh::Triangle, 20> Faces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

// The corners of three golden rectangles.
std::array<glm::dvec3, NumCorners> corners() {
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;
    return {{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}}};
}

// Numbers the edges between two corners, in the order in which the faces first meet them.
class EdgeNumbers {
public:
    EdgeNumbers() {
        for (const mesh::Triangle& face : Faces) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto edge = std::minmax({face[k], face[(k + 1) % 3]});
                if (std::find(edges_.begin(), edges_.begin() + count_, edge) ==
                    edges_.begin() + count_) {
                    edges_[static_cast<std::size_t>(count_++)] = edge;
                }
            }
        }
    }
    [[nodiscard]] std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const {
        const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(a, b);
        return static_cast<std::uint32_t>(std::find(edges_.begin(), edges_.end(), edge) -
                                          edges_.begin());
    }
    [[nodiscard]] const auto& edges() const { return edges_; }

private:
    std::array<std::pair<std::uint32_t, std::uint32_t>, NumEdges> edges_;
    std::ptrdiff_t count_ = 0;
};

/// Numbers the vertices of a sphere whose edges are cut into `f` parts: the corners, then the inner
/// points of each edge (from its lower corner), then the inner points of each face, row by row.
class VertexNumbers {
public:
    VertexNumbers(const EdgeNumbers& edges, std::uint32_t f) : edges_(edges), f_(f) {}

    /// Returns the vertex i steps towards the face's second corner and j steps towards its third.
    [[nodiscard]] std::uint32_t operator()(std::uint32_t face, std::uint32_t i,
                                           std::uint32_t j) const {
        const auto [a, b, c] = Faces[face];
        if (i == 0 && j == 0)
            return a;
        if (i == f_)
            return b;
        if (j == f_)
            return c;
        if (j == 0)
            return on_edge(a, b, i);
        if (i == 0)
            return on_edge(a, c, j);
        if (i + j == f_)
            return on_edge(b, c, j);
        const std::uint32_t first_inner = NumCorners + NumEdges * (f_ - 1);
        const std::uint32_t inner_per_face = (f_ - 1) * (f_ - 2) / 2;
        const std::uint32_t rows_before = (i - 1) * (f_ - 1) - (i - 1) * i / 2;
        return first_inner + face * inner_per_face + rows_before + j - 1;
    }

private:
    [[nodiscard]] std::uint32_t on_edge(std::uint32_t a, std::uint32_t b,
                                        std::uint32_t steps_from_a) const {
        const std::uint32_t steps = a < b ? steps_from_a : f_ - steps_from_a;
        return NumCorners + edges_(a, b) * (f_ - 1) + steps - 1;
    }

    const EdgeNumbers& edges_;
    std::uint32_t f_;
};

/// In the order of VertexNumbers.
std::vector<glm::vec3> points_of(const EdgeNumbers& edge_number, std::uint32_t f) {
    const auto corner = corners();
    std::vector<glm::vec3> positions;
    positions.reserve(10 * std::size_t{f} * f + 2);
    const auto add = [&](const glm::dvec3& point) {
        positions.emplace_back(glm::normalize(point));
    };
    for (const glm::dvec3& point : corner)
        add(point);
    for (const auto& [a, b] : edge_number.edges())
        for (std::uint32_t i = 1; i < f; ++i)
            add(corner[a] * double(f - i) + corner[b] * double(i));
    for (const auto& [a, b, c] : Faces)
        for (std::uint32_t i = 1; i + 1 < f; ++i)
            for (std::uint32_t j = 1; i + j < f; ++j)
                add(corner[a] * double(f - i - j) + corner[b] * double(i) + corner[c] * double(j));
    return positions;
}

} // namespace

mesh::TriangleMesh icosphere(std::uint32_t frequency) {
    if (frequency < 1 || frequency > 10'000)
        throw std::invalid_argument(
            fmt::format("icosphere: expected a frequency in [1, 10000], got {}", frequency));
    const std::uint32_t f = frequency;
    const EdgeNumbers edge_number;
    const VertexNumbers vertex(edge_number, f);
    mesh::TriangleMesh sphere;
    sphere.positions = points_of(edge_number, f);
    sphere.triangles.reserve(20 * std::size_t{f} * f);
    for (std::uint32_t face = 0; face < Faces.size(); ++face)
        for (std::uint32_t i = 0; i < f; ++i)
            for (std::uint32_t j = 0; i + j < f; ++j) {
                sphere.triangles.push_back(
                    {vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1)});
                if (i + j + 1 < f)
                    sphere.triangles.push_back({vertex(face, i + 1, j), vertex(face, i + 1, j + 1),
                                                vertex(face, i, j + 1)});
            }
    return sphere;
}

std::uint32_t icosphere_frequency(std::size_t num_vertices) {
    const double squared = (static_cast<double>(num_vertices) - 2.0) / 10.0;
    return squared < 1.0 ? 1 : static_cast<std::uint32_t>(std::lround(std::sqrt(squared)));
}

} // namespace relumine::data_gen
