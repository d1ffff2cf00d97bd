#include "mesh/floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "mesh/opacity.h"
#include "mesh/subject.h"

namespace relumine::mesh {

namespace {

/// Fills an attribute up to `num_vertices` if the mesh has it.
template<class Value>
void extend(std::vector<Value>& attribute, std::size_t num_vertices, const Value& value) {
    if (!attribute.empty())
        attribute.resize(num_vertices, value);
}

/// Returns where row i of n lies between -1 and 1, ever sparser from the middle to the edge.
double row_place(std::uint32_t i, std::uint32_t n) {
    constexpr double SpacingInside = 0.4; // of an even grid's
    const double even = 2.0 * static_cast<double>(i) / (n - 1) - 1.0;
    return even * (SpacingInside + (1.0 - SpacingInside) * even * even);
}

/// Returns the height of the floor under a mesh.
double height_below(const Bounds& box, const glm::dvec3& center, double side) {
    constexpr double Hair = 2e-4;
    const double depth = double{box.max.y} - double{box.min.y};
    const double diagonal = std::sqrt(2.0 * side * side + depth * depth);
    double largest = std::max(std::abs(center.x), std::abs(center.z)) + 0.5 * side;
    largest = std::max({largest, std::abs(double{box.min.y}), std::abs(double{box.max.y})});
    const double spacing = double{std::numeric_limits<float>::epsilon()} * largest;
    return double{box.min.y} - std::max(Hair * diagonal, 8.0 * spacing);
}

/// Appends n x n vertices around a centre, all attributes included.
void append_floor_vertices(TriangleMesh& mesh, std::uint32_t n, const glm::dvec3& center,
                           double side, float height) {
    mesh.positions.reserve(mesh.num_vertices() + std::size_t{n} * n);
    for (std::uint32_t row = 0; row < n; ++row)
        for (std::uint32_t column = 0; column < n; ++column)
            mesh.positions.emplace_back(
                static_cast<float>(center.x + 0.5 * side * row_place(column, n)), height,
                static_cast<float>(center.z + 0.5 * side * row_place(row, n)));
    extend(mesh.normals, mesh.num_vertices(), glm::vec3(0.0f, 1.0f, 0.0f));
    extend(mesh.colors, mesh.num_vertices(), glm::vec3(1.0f));
    extend(mesh.uvs, mesh.num_vertices(), glm::vec2(0.0f));
    extend(mesh.second_uvs, mesh.num_vertices(), glm::vec2(0.0f));
}

/// Appends the triangles between n x n vertices, with a material and a group of their own.
void append_floor_triangles(TriangleMesh& mesh, std::uint32_t n, std::size_t first) {
    const std::size_t first_triangle = mesh.num_triangles();
    mesh.triangles.reserve(first_triangle + 2 * std::size_t{n - 1} * (n - 1));
    for (std::uint32_t row = 0; row + 1 < n; ++row)
        for (std::uint32_t column = 0; column + 1 < n; ++column) {
            // a b   +X to the right, +Z down. Seen from above, a c b is counter-clockwise.
            // c d
            const std::uint32_t a = static_cast<std::uint32_t>(first) + row * n + column;
            const std::uint32_t b = a + 1, c = a + n, d = c + 1;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    extend(mesh.corner_uvs, mesh.num_triangles(), {});
    extend(mesh.corner_tangents, mesh.num_triangles(), {});
    if (!mesh.triangle_materials.empty()) {
        mesh.triangle_materials.resize(mesh.num_triangles(),
                                       static_cast<std::uint32_t>(mesh.materials.size()));
        mesh.materials.push_back({.name = "floor"});
    }
    if (mesh.triangle_groups.empty()) {
        mesh.groups = {"mesh"};
        mesh.triangle_groups.assign(first_triangle, 0);
    }
    const auto group =
        std::find(mesh.groups.begin(), mesh.groups.end(), "floor") - mesh.groups.begin();
    if (static_cast<std::size_t>(group) == mesh.groups.size())
        mesh.groups.emplace_back("floor");
    mesh.triangle_groups.resize(mesh.num_triangles(), static_cast<std::uint32_t>(group));
}

} // namespace

void append_floor(TriangleMesh& mesh, std::uint32_t n, float scale) {
    constexpr std::uint64_t MaxVertices = std::numeric_limits<std::uint32_t>::max();
    const std::size_t first = mesh.num_vertices();
    const std::uint64_t num_vertices = std::uint64_t{n} * n;
    if (n < 2)
        throw std::invalid_argument(
            fmt::format("floor: expected at least 2 x 2 vertices, got {} x {}", n, n));
    if (num_vertices + first > MaxVertices)
        throw std::invalid_argument(
            fmt::format("floor: expected at most {} vertices in all, got {}", MaxVertices,
                        num_vertices + first));

    const Bounds box = extent(mesh).box;
    const double horizontal =
        std::max(double{box.max.x} - box.min.x, double{box.max.z} - box.min.z);
    // Twice as high as wide, and a low sun's shadow would leave the floor.
    const double size = std::max(horizontal, 0.5 * (double{box.max.y} - box.min.y));
    const double side = scale * (horizontal > 0.0 ? size : double{box.diagonal()});
    const glm::dvec3 center = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
    const double farthest = std::max(std::abs(center.x), std::abs(center.z)) + 0.5 * side;
    if (!(side > 0.0) || !(farthest <= double{std::numeric_limits<float>::max()}))
        throw std::invalid_argument(fmt::format(
            "floor: expected a positive, finite side, got {} times the mesh's size", scale));

    append_floor_vertices(mesh, n, center, side,
                          static_cast<float>(height_below(box, center, side)));
    append_floor_triangles(mesh, n, first);
}

float floor_gap(const TriangleMesh& mesh, std::size_t first) {
    constexpr float PartOfGap = 0.25f; // floats are sparse far from the origin
    if (first >= mesh.num_vertices())
        return 0.0f;
    float lowest = std::numeric_limits<float>::infinity();
    for (const Triangle& triangle : mesh.triangles)
        if (triangle[0] < first)
            for (const std::uint32_t vertex : triangle)
                lowest = std::min(lowest, mesh.positions[vertex].y);
    const float gap = lowest - mesh.positions[first].y;
    const bool stands_flat =
        gap > 0.0f &&
        std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& triangle) {
            return triangle[0] < first &&
                   std::all_of(
                       triangle.begin(), triangle.end(),
                       [&](std::uint32_t vertex) {
                           return mesh.positions[vertex].y <= lowest + PartOfGap * gap;
                       });
        });
    return stands_flat && std::isfinite(gap) ? gap : 0.0f;
}

TriangleMesh with_raised_floor(const TriangleMesh& mesh, std::size_t first, float gap) {
    TriangleMesh raised = blockers_of(mesh);
    if (raised.materials.empty()) { // backs that are not shown
        raised.triangle_materials = mesh.triangle_materials;
        for (const Material& material : mesh.materials)
            raised.materials.push_back(without_colors(material));
    }
    for (glm::vec3& position : std::span(raised.positions).subspan(first))
        position.y += gap;
    return raised;
}

FloorPlace floor_place(std::span<const glm::vec3> positions, std::uint32_t n) {
    const glm::vec3 first = positions.front(), last = positions[std::size_t{n} * n - 1];
    const auto gap_after = [&](std::uint32_t column) {
        return positions[column + 1].x - positions[column].x;
    };
    return {.center = 0.5f * (glm::vec2(first.x, first.z) + glm::vec2(last.x, last.z)),
            .half_side = 0.5f * (last.x - first.x),
            .spacing_inside = gap_after((n - 1) / 2),
            .spacing_outside = gap_after(0)};
}

} // namespace relumine::mesh
