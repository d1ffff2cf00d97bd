#include "prt/receivers/mesh_point.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "cubemap/split_mix64.h"

namespace relumine::prt {

namespace {

/// Computes in double: products of a small triangle's edges would vanish in float.
glm::vec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? glm::vec3(v / length) : glm::vec3(0.0f);
}

} // namespace

glm::vec3 value_at(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> values,
                   const MeshPoint& point) {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const float first = 1.0f - point.barycentric.x - point.barycentric.y;
    return first * values[triangle[0]] + point.barycentric.x * values[triangle[1]] +
           point.barycentric.y * values[triangle[2]];
}

glm::vec3 face_normal(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const glm::dvec3 origin(mesh.positions[a]);
    return unit_or_zero(
        glm::cross(glm::dvec3(mesh.positions[b]) - origin, glm::dvec3(mesh.positions[c]) - origin));
}

glm::vec3 shading_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    const glm::vec3 interpolated = value_at(mesh, mesh.normals, point);
    // A shorter vector is the rounding of normals that cancel, not a direction.
    constexpr float Shortest = 1e-4f;
    return glm::length(interpolated) > Shortest ? glm::normalize(interpolated)
                                                : face_normal(mesh, point.triangle);
}

glm::vec3 smooth_position(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const glm::vec3 flat = value_at(mesh, mesh.positions, point);
    const glm::vec3 lifted = mesh.lifts.empty() ? flat : flat + value_at(mesh, mesh.lifts, point);
    const glm::vec3 weights(1.0f - point.barycentric.x - point.barycentric.y, point.barycentric.x,
                            point.barycentric.y);
    const glm::vec3 facing = face_normal(mesh, point.triangle);
    glm::vec3 moved(0.0f);
    for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = triangle[static_cast<std::size_t>(corner)];
        const glm::vec3& normal = mesh.normals[vertex];
        // A normal so far from the face's is that of an edge, not of a smooth surface.
        constexpr float Smooth = 0.7f;
        if (std::abs(glm::dot(normal, facing)) < Smooth)
            return lifted;
        // Onto the plane through the corner, where the point lies below it.
        const float below = std::min(0.0f, glm::dot(flat - mesh.positions[vertex], normal));
        moved -= weights[corner] * below * normal;
    }
    return lifted + moved;
}

std::vector<MeshPoint> random_points(const mesh::TriangleMesh& mesh, std::size_t count,
                                     std::uint64_t seed) {
    std::vector<double> areas; // of all triangles up to each
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const glm::dvec3 origin(mesh.positions[a]);
        sum += glm::length(glm::cross(glm::dvec3(mesh.positions[b]) - origin,
                                      glm::dvec3(mesh.positions[c]) - origin));
        areas.push_back(sum);
    }
    if (!(sum > 0.0))
        return {};
    cubemap::SplitMix64 random(seed);
    const auto uniform = [&random] {
        return static_cast<double>(random.next() >> 11u) * 0x1p-53;
    };
    std::vector<MeshPoint> points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = std::upper_bound(areas.begin(), areas.end() - 1, uniform() * sum);
        // The square root makes even density in the triangle (G. Turk, Graphics Gems, 1990).
        const double root = std::sqrt(uniform()), part = uniform();
        points.push_back(
            {static_cast<std::uint32_t>(place - areas.begin()),
             {static_cast<float>(root * (1.0 - part)), static_cast<float>(root * part)}});
    }
    std::stable_sort(points.begin(), points.end(), [](const MeshPoint& a, const MeshPoint& b) {
        return a.triangle < b.triangle;
    });
    return points;
}

bool meets_front(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                 const glm::vec3& direction) {
    const glm::vec3 face = face_normal(mesh, point.triangle);
    const float side = glm::dot(face, value_at(mesh, mesh.normals, point));
    const float towards = glm::dot(face, direction);
    return side < 0.0f ? towards > 0.0f : towards < 0.0f;
}

} // namespace relumine::prt
