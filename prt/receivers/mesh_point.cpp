#include "prt/receivers/mesh_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>

#include "cubemap/split_mix64.h"
#include "mesh/opacity.h"
#include "mesh/tangents.h"
#include "prt/receivers/texture_view.h"

namespace relumine::prt {

namespace {

/// Computes in double: products of a small triangle's edges would vanish in float.
glm::vec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? glm::vec3(v / length) : glm::vec3(0.0f);
}

/// The least cosine between a normal and a lift that leads outwards or inwards.
constexpr float CosineOfLift = 0.8f;

/// Whether a lift leads to the smooth surface. Points beside a vertex do not follow other lifts.
bool leads_outwards(const glm::vec3& lift, const glm::vec3& normal) {
    return glm::dot(lift, normal) > CosineOfLift * glm::length(lift);
}

} // namespace

glm::vec3 value_at(const mesh::TriangleMesh& mesh, std::span<const glm::vec3> values,
                   const MeshPoint& point) {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const float first = 1.0f - point.barycentric.x - point.barycentric.y;
    return first * values[triangle[0]] + point.barycentric.x * values[triangle[1]] +
           point.barycentric.y * values[triangle[2]];
}

namespace {

using Barycentric = std::array<double, 3>;

Barycentric weights_of(const MeshPoint& point) {
    const glm::dvec2 at(point.barycentric);
    return {1.0 - at.x - at.y, at.x, at.y};
}

/// Returns the heights of a triangle over its sides, each across from its corner.
Barycentric heights(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    std::array<glm::dvec3, 3> at{};
    for (std::size_t k = 0; k < 3; ++k)
        at[k] = glm::dvec3(mesh.positions[mesh.triangles[triangle][k]]);
    const double area = glm::length(glm::cross(at[1] - at[0], at[2] - at[0]));
    return {area / glm::distance(at[1], at[2]), area / glm::distance(at[2], at[0]),
            area / glm::distance(at[0], at[1])};
}

} // namespace

unsigned sides_at(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    constexpr double Roundings = 4.0 * std::numeric_limits<float>::epsilon();
    const Barycentric weights = weights_of(point), over = heights(mesh, point.triangle);
    double largest = 0.0;
    for (const std::uint32_t corner : mesh.triangles[point.triangle])
        largest = std::max(largest, glm::length(glm::dvec3(mesh.positions[corner])));
    unsigned sides = 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (weights[k] * over[k] <= Roundings * largest)
            sides |= 1u << k;
    return sides;
}

MeshPoint off_sides(const mesh::TriangleMesh& mesh, const MeshPoint& point, unsigned sides,
                    float step) {
    constexpr double LargestPart = 1.0 / 12.0; // of a height: a quarter of the way to the centre
    const Barycentric over = heights(mesh, point.triangle);
    Barycentric weights = weights_of(point);
    for (std::size_t k = 0; k < 3; ++k)
        if ((sides >> k & 1u) != 0 && over[k] > 0.0)
            weights[k] = std::min(double{step} / over[k], LargestPart);
    const double sum = weights[0] + weights[1] + weights[2];
    return {.triangle = point.triangle, .barycentric = {weights[1] / sum, weights[2] / sum}};
}

glm::vec2 uv_at(const mesh::TriangleMesh& mesh, const MeshPoint& point, std::uint32_t uv_set) {
    return mesh::uv_at(mesh, point.triangle, point.barycentric, uv_set);
}

glm::vec3 face_normal(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const glm::dvec3 origin(mesh.positions[a]);
    return unit_or_zero(
        glm::cross(glm::dvec3(mesh.positions[b]) - origin, glm::dvec3(mesh.positions[c]) - origin));
}

glm::vec4 tangent_at(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    if (mesh.corner_tangents.empty())
        return glm::vec4(0.0f);
    const glm::dvec3 normal(shading_normal(mesh, point));
    const std::array<glm::vec4, 3>& corners = mesh.corner_tangents[point.triangle];
    const glm::vec2& w = point.barycentric;
    const glm::vec4 between = (1.0f - w.x - w.y) * corners[0] + w.x * corners[1] + w.y * corners[2];
    return {unit_or_zero(glm::dvec3(between) - glm::dot(glm::dvec3(between), normal) * normal),
            between.w < 0.0f ? -1.0f : 1.0f};
}

glm::vec3 shading_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    const glm::vec3 interpolated = value_at(mesh, mesh.normals, point);
    // A shorter vector is the rounding of normals that cancel, not a direction.
    constexpr float Shortest = 1e-4f;
    return glm::length(interpolated) > Shortest ? glm::normalize(interpolated)
                                                : face_normal(mesh, point.triangle);
}

namespace {

/// A map of a material, and the factor on its tilt.
struct NormalMap {
    std::optional<mesh::TextureSlot> mesh::Material::* texture;
    float mesh::Material::* scale;
};

/// Returns the normal of a texture, in tangent space and not of unit length, over what a sample of
/// a view sees of it.
glm::vec3 tangent_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                         const mesh::TextureSlot& slot, const TextureView* view) {
    const glm::vec2 uv = uv_at(mesh, point, slot.uv_set);
    if (view != nullptr)
        return view->maps->normal(slot, uv, view->footprint(mesh, point, slot.uv_set));
    return mesh::tangent_vector(mesh::sample(mesh.textures[slot.texture], slot, uv));
}

MappedNormal normal_of(const mesh::TriangleMesh& mesh, const MeshPoint& point, const NormalMap& map,
                       const TextureView* view) {
    const glm::vec3 normal = shading_normal(mesh, point);
    if (mesh.corner_tangents.empty())
        return {normal};
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[point.triangle]];
    if (!(material.*map.texture))
        return {normal};
    if (view != nullptr && view->maps == nullptr)
        view = nullptr;
    const glm::vec3 mean = tangent_normal(mesh, point, *(material.*map.texture), view);
    const float scale = material.*map.scale;
    const glm::vec2 tilt = scale * glm::vec2(mean);
    // What roundings make of equal normals is no spread.
    constexpr float LeastSpread = 1e-3f;
    const float found =
        view != nullptr ? std::min(scale * scale * (1.0f - glm::dot(mean, mean)), 1.0f) : 0.0f;
    const float spread = found > LeastSpread ? found : 0.0f;
    const glm::vec4 tangent = tangent_at(mesh, point);
    const glm::vec3 along(tangent);
    if (tilt == glm::vec2(0.0f) || along == glm::vec3(0.0f))
        return {normal, spread};
    const glm::vec3 bitangent = tangent.w * glm::cross(normal, along);
    const glm::vec3 mapped = unit_or_zero(glm::dvec3(tilt.x * along + tilt.y * bitangent) +
                                          double{mean.z} * glm::dvec3(normal));
    return {mapped == glm::vec3(0.0f) ? normal : mapped, spread};
}

} // namespace

MappedNormal seen_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                         const TextureView* view) {
    return normal_of(mesh, point, {&mesh::Material::normal_texture, &mesh::Material::normal_scale},
                     view);
}

MappedNormal seen_coat_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                              const TextureView* view) {
    return normal_of(mesh, point,
                     {&mesh::Material::coat_normal_texture, &mesh::Material::coat_normal_scale},
                     view);
}

glm::vec3 mapped_normal(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    return seen_normal(mesh, point, nullptr).direction;
}

glm::vec3 smooth_position(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    const mesh::Triangle& triangle = mesh.triangles[point.triangle];
    const std::array<float, 3> weights = {1.0f - point.barycentric.x - point.barycentric.y,
                                          point.barycentric.x, point.barycentric.y};
    const glm::vec3 facing = face_normal(mesh, point.triangle);
    // Hanika's points lie twice as high as the surface that has the normals: half of a lift leads
    // there. From it, the triangles between lifted vertices get what they would get unsplit.
    std::array<glm::vec3, 3> corners{};
    glm::vec3 position(0.0f), lift(0.0f);
    float least_cosine = 1.0f;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t vertex = triangle[i];
        corners[i] = mesh.positions[vertex];
        if (!mesh.lifts.empty() && leads_outwards(mesh.lifts[vertex], mesh.normals[vertex])) {
            corners[i] += 0.5f * mesh.lifts[vertex];
            lift += weights[i] * mesh.lifts[vertex];
        }
        position += weights[i] * corners[i];
        least_cosine = std::min(least_cosine, std::abs(glm::dot(mesh.normals[vertex], facing)));
    }
    glm::vec3 moved(0.0f);
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec3& normal = mesh.normals[triangle[i]];
        // Onto the plane through the corner, where the point lies below it.
        moved -= weights[i] * std::min(0.0f, glm::dot(position - corners[i], normal)) * normal;
    }
    // A normal far from the face's is that of an edge, not of a smooth surface: those of a cube's
    // corners are 55 degrees off. Between the bounds neighbours differ little.
    constexpr float Edge = 0.6f, Smooth = 0.75f;
    const float part = std::clamp((least_cosine - Edge) / (Smooth - Edge), 0.0f, 1.0f);
    return value_at(mesh, mesh.positions, point) + lift + part * moved;
}

bool leads_along(const glm::vec3& lift, const glm::vec3& normal) {
    return !(std::abs(glm::dot(lift, normal)) >= CosineOfLift * glm::length(lift));
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
        return cubemap::unit_interval(random.next());
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
