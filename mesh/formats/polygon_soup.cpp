#include "mesh/formats/polygon_soup.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/formats/triangulate.h"
#include "mesh/normals.h"
#include "mesh/tangents.h"

namespace relumine::mesh {

namespace {

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Refuses a soup that no mesh may have, for every format.
void check(const PolygonSoup& soup) {
    const std::size_t num_vertices = soup.positions.size();
    if (num_vertices == 0)
        throw std::runtime_error("expected vertices, got none");
    for (std::size_t i = 0; i < num_vertices; ++i)
        if (!is_finite(soup.positions[i]))
            throw std::runtime_error(fmt::format(
                "expected finite positions, got {} {} {} at vertex {} of {}", soup.positions[i].x,
                soup.positions[i].y, soup.positions[i].z, i, num_vertices));
    for (const std::uint32_t vertex : soup.corners)
        if (vertex >= num_vertices)
            throw std::runtime_error(
                fmt::format("expected vertex indices below {}, got {}", num_vertices, vertex));
}

/// Cuts the faces. A triangle keeps the uvs of its corners, and the material and group of its face.
void triangulate(const PolygonSoup& soup, TriangleMesh& mesh) {
    mesh.triangles.reserve(soup.face_ends.size());
    Triangulator triangulator(soup.positions);
    std::vector<std::array<std::uint32_t, 3>> cut;
    std::size_t begin = 0, num_skipped = 0;
    for (std::size_t face = 0; face < soup.face_ends.size(); ++face) {
        const std::size_t end = soup.face_ends[face];
        cut.clear();
        if (end - begin < 3)
            ++num_skipped;
        else
            triangulator.cut(std::span(soup.corners).subspan(begin, end - begin), cut);
        for (const auto& [a, b, c] : cut) {
            mesh.triangles.push_back(
                {soup.corners[begin + a], soup.corners[begin + b], soup.corners[begin + c]});
            if (!soup.corner_uvs.empty())
                mesh.corner_uvs.push_back({soup.corner_uvs[begin + a], soup.corner_uvs[begin + b],
                                           soup.corner_uvs[begin + c]});
            if (!soup.face_materials.empty())
                mesh.triangle_materials.push_back(soup.face_materials[face]);
            if (!soup.face_groups.empty())
                mesh.triangle_groups.push_back(soup.face_groups[face]);
        }
        begin = end;
    }
    if (mesh.triangles.empty())
        throw std::runtime_error(
            fmt::format("expected faces with three or more corners, got {} vertices and {} faces",
                        soup.positions.size(), soup.face_ends.size()));
    if (num_skipped > 0)
        mesh.warnings.push_back(fmt::format("{} of {} faces have fewer than three corners",
                                            num_skipped, soup.face_ends.size()));
}

/// Brings a tiny mesh to a size of about 1. Products of coordinates below 1e-19 would be lost, and
/// shadows with them. A power of two changes nothing but the size.
void enlarge(PolygonSoup& soup) {
    constexpr float Least = 0x1p-40f;
    float size = 0.0f;
    for (const glm::vec3& p : soup.positions)
        size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (size == 0.0f || size >= Least)
        return;
    const int exponent = -std::ilogb(size);
    for (glm::vec3& p : soup.positions)
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = std::ldexp(p[axis], exponent);
    soup.warnings.push_back(fmt::format(
        "coordinates are at most {:.3g}, too small to compute with; the mesh is read 2^{} times as "
        "large",
        size, exponent));
}

/// Makes the normals unit length. Returns false if a vertex of some face has no usable normal.
bool normalize_normals(TriangleMesh& mesh) {
    std::vector<bool> is_used(mesh.num_vertices(), false);
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            is_used[vertex] = true;
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const glm::dvec3 normal(mesh.normals[i]);
        const double length = is_finite(mesh.normals[i]) ? glm::length(normal) : 0.0;
        if (length == 0.0 && is_used[i])
            return false;
        mesh.normals[i] = length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
    }
    return true;
}

} // namespace

TriangleMesh to_mesh(PolygonSoup soup, NormalSource source) {
    check(soup);
    enlarge(soup);
    TriangleMesh mesh;
    mesh.warnings = std::move(soup.warnings);
    triangulate(soup, mesh);
    mesh.positions = std::move(soup.positions);
    mesh.normals = std::move(soup.normals);
    mesh.colors = std::move(soup.colors);
    mesh.uvs = std::move(soup.uvs);
    mesh.second_uvs = std::move(soup.second_uvs);
    mesh.materials = std::move(soup.materials);
    mesh.groups = std::move(soup.groups);
    mesh.textures = std::move(soup.textures);
    mesh.missing = std::move(soup.missing);
    if (source == NormalSource::Smooth || mesh.normals.empty() || !normalize_normals(mesh))
        mesh.normals = smooth_normals(mesh);
    if (!std::all_of(mesh.colors.begin(), mesh.colors.end(), is_finite))
        mesh.colors.clear();
    const auto is_finite_uv = [](const glm::vec2& uv) {
        return is_finite({uv, 0.0f});
    };
    for (std::vector<glm::vec2>* uvs : {&mesh.uvs, &mesh.second_uvs})
        if (!std::all_of(uvs->begin(), uvs->end(), is_finite_uv))
            uvs->clear();
    if (!std::all_of(mesh.corner_uvs.begin(), mesh.corner_uvs.end(), [&](const auto& uvs) {
            return std::all_of(uvs.begin(), uvs.end(), is_finite_uv);
        }))
        mesh.corner_uvs.clear();
    set_tangents(mesh, soup.tangents);
    return mesh;
}

} // namespace relumine::mesh
