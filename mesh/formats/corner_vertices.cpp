#include "mesh/formats/corner_vertices.h"

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/counted.h"
#include "mesh/edge_uses.h"
#include "mesh/vertex_copies.h"

namespace relumine::mesh {

namespace {

constexpr glm::vec3 NoNormal(0.0f);

/// Returns the normal with length 1, or NoNormal where it has no direction.
glm::vec3 direction_or_none(const glm::vec3& normal) {
    const float length = glm::length(normal);
    return length > 0.0f && std::isfinite(length) ? normal / length : NoNormal;
}

/// Calls visit(face, first corner, number of corners) for each face that has triangles.
template<class Visit>
void for_each_face(const PolygonSoup& soup, const Visit& visit) {
    std::size_t begin = 0;
    for (std::size_t face = 0; face < soup.face_ends.size(); ++face) {
        const std::size_t end = soup.face_ends[face];
        if (end - begin >= 3)
            visit(face, begin, end - begin);
        begin = end;
    }
}

/// Returns the file's normal of each corner, or NoNormal.
std::vector<glm::vec3> normals_of_file(const PolygonSoup& soup) {
    std::vector<glm::vec3> result(soup.corners.size(), NoNormal);
    for (std::size_t i = 0; i < result.size(); ++i) {
        if (!soup.corner_normals.empty())
            result[i] = direction_or_none(soup.corner_normals[i]);
        if (result[i] == NoNormal && !soup.normals.empty())
            result[i] = direction_or_none(soup.normals[soup.corners[i]]);
    }
    return result;
}

/// Returns normals of all corners from the faces: flat, or smooth within each smoothing group.
std::vector<glm::vec3> normals_of_faces(const PolygonSoup& soup,
                                        std::span<const Triangle> triangles,
                                        std::span<const std::uint32_t> smoothing) {
    const auto group_of = [&](std::size_t face) {
        return smoothing.empty() ? 1u : smoothing[face];
    };
    // A mesh whose vertices belong to one smoothing group each.
    TriangleMesh smooth;
    VertexCopies copies(soup.positions.size());
    std::vector<std::uint32_t> groups(soup.positions.size());
    std::vector<std::uint32_t> vertices(soup.corners.size());
    std::vector<glm::vec3> result(soup.corners.size(), NoNormal);
    const Triangle* triangle = triangles.data();
    for_each_face(soup, [&](std::size_t face, std::size_t begin, std::size_t count) {
        const std::span own(triangle, count - 2);
        triangle += count - 2;
        if (const std::uint32_t group = group_of(face); group != 0) {
            for (std::size_t i = begin; i < begin + count; ++i) {
                vertices[i] = copies.find(
                    soup.corners[i], [&](std::uint32_t copy) { return groups[copy] == group; });
                groups.resize(copies.num_vertices());
                groups[vertices[i]] = group;
            }
            for (const auto& [a, b, c] : own)
                smooth.triangles.push_back({vertices[a], vertices[b], vertices[c]});
            return;
        }
        glm::dvec3 sum(0.0);
        for (const auto& [a, b, c] : own)
            sum += area_normal(soup.positions, {soup.corners[a], soup.corners[b], soup.corners[c]});
        const double length = glm::length(sum);
        for (std::size_t i = begin; i < begin + count && length > 0.0; ++i)
            result[i] = glm::vec3(sum / length);
    });
    smooth.positions = soup.positions;
    copies.append_to(smooth.positions);
    const std::vector<glm::vec3> normals = smooth_normals(smooth);
    for_each_face(soup, [&](std::size_t face, std::size_t begin, std::size_t count) {
        for (std::size_t i = begin; i < begin + count && group_of(face) != 0; ++i)
            result[i] = normals[vertices[i]];
    });
    return result;
}

/// Whether some vertex of a face has no normal of the file.
bool lacks_normals(const PolygonSoup& soup) {
    bool result = false;
    for_each_face(soup, [&](std::size_t, std::size_t begin, std::size_t count) {
        for (std::size_t i = begin; i < begin + count && !result; ++i)
            result = direction_or_none(soup.normals[soup.corners[i]]) == NoNormal;
    });
    return result;
}

/// Returns the normals of all corners. Says which the file does not have, if it has some.
std::vector<glm::vec3> complete_normals(PolygonSoup& soup, std::span<const Triangle> triangles,
                                        NormalSource source) {
    if (source == NormalSource::Smooth)
        return normals_of_faces(soup, triangles, {});
    std::vector<glm::vec3> result = normals_of_file(soup);
    std::vector<glm::vec3> computed;
    std::size_t num_missing = 0, num_flat = 0;
    for_each_face(soup, [&](std::size_t face, std::size_t begin, std::size_t count) {
        const bool is_flat = !soup.face_smoothing.empty() && soup.face_smoothing[face] == 0;
        bool is_missing = false;
        for (std::size_t i = begin; i < begin + count; ++i) {
            if (result[i] != NoNormal)
                continue;
            if (computed.empty())
                computed = normals_of_faces(soup, triangles, soup.face_smoothing);
            result[i] = computed[i];
            is_missing = true;
            num_missing += is_flat ? 0 : 1;
        }
        num_flat += is_missing && is_flat ? 1 : 0;
    });
    if (num_flat != 0)
        soup.notes.push_back(fmt::format("{} without normals {} flat; --crease 180 rounds them",
                                         files::counted(num_flat, "face"),
                                         num_flat == 1 ? "is" : "are"));
    if (num_missing != 0 && (!soup.normals.empty() || !soup.corner_normals.empty()))
        soup.notes.push_back(fmt::format("{} without a normal take that of the faces around them",
                                         files::counted(num_missing, "corner")));
    return result;
}

} // namespace

bool are_alike(const glm::vec3& a, const glm::vec3& b) {
    constexpr float Degree = 0.01745f;
    const glm::vec3 between = a - b;
    return glm::dot(between, between) < Degree * Degree;
}

std::size_t set_corner_vertices(PolygonSoup& soup, std::span<const Triangle> triangles,
                                NormalSource source) {
    const bool is_by_corner =
        source == NormalSource::File &&
        (!soup.corner_normals.empty() ||
         (soup.normals.empty() ? !soup.face_smoothing.empty() : lacks_normals(soup)));
    if (!is_by_corner && soup.face_colors.empty())
        return 0;
    const std::vector<glm::vec3> normals = complete_normals(soup, triangles, source);
    VertexCopies copies(soup.positions.size());
    struct Vertex {
        /// That of the first corner that has one.
        glm::vec3 normal = NoNormal;
        glm::vec3 sum = NoNormal, color{1.0f};
    };
    std::vector<Vertex> vertices(soup.positions.size());
    for_each_face(soup, [&](std::size_t face, std::size_t begin, std::size_t count) {
        const glm::vec3 color = soup.face_colors.empty() ? NoNormal : soup.face_colors[face];
        for (std::size_t i = begin; i < begin + count; ++i) {
            const glm::vec3& normal = normals[i];
            soup.corners[i] = copies.find(soup.corners[i], [&](std::uint32_t copy) {
                const Vertex& vertex = vertices[copy];
                return vertex.color == color && (vertex.normal == NoNormal || normal == NoNormal ||
                                                 are_alike(vertex.normal, normal));
            });
            vertices.resize(copies.num_vertices());
            Vertex& vertex = vertices[soup.corners[i]];
            vertex.color = color;
            vertex.sum += normal;
            if (vertex.normal == NoNormal)
                vertex.normal = normal;
        }
    });
    copies.append_to(soup.positions);
    copies.append_to(soup.colors);
    copies.append_to(soup.uvs);
    copies.append_to(soup.second_uvs);
    copies.append_to(soup.tangents);
    soup.normals.assign(vertices.size(), NoNormal);
    if (!soup.face_colors.empty())
        soup.colors.assign(vertices.size(), glm::vec3(1.0f));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        soup.normals[i] = vertices[i].sum;
        if (!soup.face_colors.empty())
            soup.colors[i] = vertices[i].color;
    }
    return copies.num_copies();
}

} // namespace relumine::mesh
