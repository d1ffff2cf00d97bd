#include "mesh/triangle_mesh.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::mesh {

float Bounds::diagonal() const {
    return static_cast<float>(glm::length(glm::dvec3(max) - glm::dvec3(min)));
}

Bounds bounds(const TriangleMesh& mesh) {
    if (mesh.triangles.empty())
        return bounds(mesh.positions);
    const glm::vec3 first = mesh.positions[mesh.triangles.front()[0]];
    Bounds box{first, first};
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle) {
            box.min = glm::min(box.min, mesh.positions[vertex]);
            box.max = glm::max(box.max, mesh.positions[vertex]);
        }
    return box;
}

Bounds bounds(std::span<const glm::vec3> points) {
    if (points.empty())
        return {};
    Bounds box{points.front(), points.front()};
    for (const glm::vec3& point : points) {
        box.min = glm::min(box.min, point);
        box.max = glm::max(box.max, point);
    }
    return box;
}

namespace {

void require_size(std::size_t size, std::size_t expected, const char* what) {
    if (size != 0 && size != expected)
        throw std::invalid_argument(
            fmt::format("expected none or {} {}, got {}", expected, what, size));
}

/// Throws where an index is not below the number of what it points at.
void require_indices(std::span<const std::uint32_t> indices, std::size_t count, const char* what) {
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= count)
            throw std::invalid_argument(fmt::format("expected {} below {}, got {} of triangle {}",
                                                    what, count, indices[i], i));
}

void require_vertices(const TriangleMesh& mesh) {
    if (mesh.normals.size() != mesh.num_vertices())
        throw std::invalid_argument(fmt::format("expected a normal for each of {} vertices, got {}",
                                                mesh.num_vertices(), mesh.normals.size()));
    constexpr float UnitTolerance = 1e-3f;
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const glm::vec3& p = mesh.positions[i];
        const float length = glm::length(mesh.normals[i]);
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            throw std::invalid_argument(
                fmt::format("expected finite positions, got another at vertex {}", i));
        if (!(length == 0.0f || std::abs(length - 1.0f) <= UnitTolerance))
            throw std::invalid_argument(
                fmt::format("expected normals of length 1 or 0, got {} at vertex {}", length, i));
    }
}

} // namespace

void require_triangles(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i])
            if (vertex >= mesh.num_vertices())
                throw std::invalid_argument(
                    fmt::format("expected vertices below {}, got {} of triangle {}",
                                mesh.num_vertices(), vertex, i));
}

void require_consistent(const TriangleMesh& mesh) {
    require_vertices(mesh);
    const std::size_t num_vertices = mesh.num_vertices(), num_triangles = mesh.num_triangles();
    require_size(mesh.colors.size(), num_vertices, "colours of vertices");
    require_size(mesh.uvs.size(), num_vertices, "uvs of vertices");
    require_size(mesh.second_uvs.size(), num_vertices, "second uvs of vertices");
    require_size(mesh.lifts.size(), num_vertices, "lifts of vertices");
    require_size(mesh.corner_uvs.size(), num_triangles, "uvs of triangles");
    require_size(mesh.corner_tangents.size(), num_triangles, "tangents of triangles");
    require_size(mesh.triangle_materials.size(), num_triangles, "materials of triangles");
    require_size(mesh.triangle_groups.size(), num_triangles, "groups of triangles");
    require_triangles(mesh);
    require_indices(mesh.triangle_materials, mesh.materials.size(), "materials");
    require_indices(mesh.triangle_groups, mesh.groups.size(), "groups");
}

std::vector<std::string> left_out(const TriangleMesh& mesh) {
    std::vector<std::string> lines = mesh.warnings;
    for (const std::string& name : mesh.missing)
        lines.push_back("no " + name + " is found");
    return lines;
}

} // namespace relumine::mesh
