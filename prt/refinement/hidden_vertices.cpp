#include "prt/refinement/hidden_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "prt/receivers/mesh_point.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

using mesh::SplitMesh;
using Bits = CoarseDirections::Bits;

} // namespace

void HiddenVertices::find_movable() {
    constexpr float LeastCosine = 0.99999f;
    constexpr double LargestGap = 1e-3;
    const mesh::TriangleMesh& mesh = surface_.mesh();
    std::vector<double> angles(mesh.num_vertices(), 0.0);
    std::vector<glm::vec3> faces(mesh.num_vertices(), glm::vec3(0.0f));
    is_movable_.resize(mesh.num_vertices());
    for (const std::uint32_t triangle : surface_.split().changed_triangles()) {
        const glm::vec3 face = face_normal(mesh, triangle);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.triangles[triangle][k];
            const glm::dvec3 at(mesh.positions[vertex]);
            const auto way = [&](std::size_t other) {
                return glm::normalize(
                    glm::dvec3(mesh.positions[mesh.triangles[triangle][other % 3]]) - at);
            };
            angles[vertex] += std::acos(std::clamp(glm::dot(way(k + 1), way(k + 2)), -1.0, 1.0));
            if (faces[vertex] == glm::vec3(0.0f))
                faces[vertex] = face;
            else if (!(glm::dot(faces[vertex], face) > LeastCosine))
                angles[vertex] = std::numeric_limits<double>::infinity();
        }
    }
    // Where an edge has vertices of its own on both sides of a surface, or of a seam, the others
    // would stay behind.
    const std::span<const SplitMesh::Middle> middles = surface_.split().new_vertices();
    std::vector<bool> is_alone(middles.size(), true);
    for (std::size_t i = 0; i < middles.size(); ++i)
        if (middles[i].next != SplitMesh::None)
            is_alone[i] = is_alone[middles[i].next] = false;
    for (std::size_t i = 0; i < middles.size(); ++i)
        is_movable_[middles[i].vertex] =
            is_alone[i] &&
            std::abs(angles[middles[i].vertex] - 2.0 * std::numbers::pi) < LargestGap;
}

bool HiddenVertices::moves_to(std::uint32_t hidden, std::uint32_t lit) const {
    return is_movable_[hidden] && is_hidden(hidden) && !is_hidden(lit);
}

bool HiddenVertices::hides_ends(std::span<const SplitMesh::Ends> edge) const {
    return std::any_of(edge.begin(), edge.end(), [this](const SplitMesh::Ends& ends) {
        return is_hidden(ends.low) && is_hidden(ends.high);
    });
}

/// Returns the ways along which hidden vertices may leave, by bisection.
std::vector<HiddenVertices::Way> HiddenVertices::ways_out() {
    constexpr int Bisections = 6;
    const mesh::TriangleMesh& mesh = surface_.mesh();
    is_movable_.resize(mesh.num_vertices());
    std::vector<Way> ways;
    for (const mesh::Triangle& triangle : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangle[k];
            const auto add = [&](std::uint32_t b) {
                if (surface_.is_traced(a) && surface_.is_traced(b) && is_hidden(a) && !is_hidden(b))
                    ways.push_back({.vertex = a,
                                    .towards = b,
                                    .num_hidden = CoarseDirections::num_lit(surface_.bits(a)),
                                    .num_lit = CoarseDirections::num_lit(surface_.bits(b))});
            };
            add(triangle[(k + 1) % 3]);
            // Around a vertex that may move, each edge leaves in one triangle.
            if (!is_movable_[a])
                add(triangle[(k + 2) % 3]);
        }
    std::vector<float> parts(ways.size());
    for (int i = 0; i < Bisections; ++i) {
        for (std::size_t j = 0; j < ways.size(); ++j)
            parts[j] = 0.5f * (ways[j].hidden + ways[j].lit);
        const std::vector<int> counts = num_lit_at(ways, parts);
        for (std::size_t j = 0; j < ways.size(); ++j) {
            // Beside a solid half of the light is left. Gaps between solids let in little.
            const int least =
                std::max(CoarseDirections::FewestDirections,
                         CoarseDirections::num_lit(surface_.bits(ways[j].towards)) / 4);
            const bool is_dark = counts[j] < least;
            (is_dark ? ways[j].hidden : ways[j].lit) = parts[j];
            (is_dark ? ways[j].num_hidden : ways[j].num_lit) = counts[j];
        }
    }
    leave_gaps(ways);
    std::erase_if(ways, [this](const Way& way) { return passes_a_sheet(way); });
    return ways;
}

/// Returns how many directions light each way at some part of it.
std::vector<int> HiddenVertices::num_lit_at(std::span<const Way> ways,
                                            std::span<const float> parts) {
    Receivers receivers;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        surface_.add_mean(std::array{ways[i].vertex, ways[i].towards},
                          std::array{1.0f - parts[i], parts[i]}, receivers);
        receivers.positions.back() += (1.0f - parts[i]) * surface_.lift(ways[i].vertex) +
                                      parts[i] * surface_.lift(ways[i].towards);
    }
    std::vector<int> counts;
    for (const Bits& bits : surface_.trace(receivers))
        counts.push_back(CoarseDirections::num_lit(bits));
    return counts;
}

/// Under a solid that stands a hair above the surface, light ends within some hairs, not at once.
/// Where there is more light a little farther along a way, it ends there.
void HiddenVertices::leave_gaps(std::vector<Way>& ways) {
    constexpr float Hairs = 8.0f; // of the bias; an added floor lies two below
    const std::vector<glm::vec3>& positions = surface_.mesh().positions;
    std::vector<float> parts(ways.size());
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const float length = glm::distance(positions[ways[i].vertex], positions[ways[i].towards]);
        parts[i] = std::min(ways[i].lit + Hairs * surface_.bias() / length, 1.0f);
    }
    const std::vector<int> counts = num_lit_at(ways, parts);
    for (std::size_t i = 0; i < ways.size(); ++i)
        if (8 * counts[i] > 9 * ways[i].num_lit) {
            ways[i].lit = parts[i];
            ways[i].num_lit = counts[i];
        }
}

/// Whether the lit end lies beyond a sheet: from the lit end, the first surface on the way is met
/// from its back. A way out of a solid leaves it through its front.
bool HiddenVertices::passes_a_sheet(const Way& way) const {
    const RayScene* const rays = surface_.blockers().ray_scene();
    if (rays == nullptr)
        return false;
    Receivers ends;
    for (const float part : {0.0f, way.lit}) {
        surface_.add_mean(std::array{way.vertex, way.towards}, std::array{1.0f - part, part}, ends);
        ends.positions.back() =
            ray_origin(ends.positions.back() + (1.0f - part) * surface_.lift(way.vertex) +
                           part * surface_.lift(way.towards),
                       ends.normals.back(), surface_.bias());
    }
    std::vector<RayScene::Crossing> crossings;
    rays->crossings(ends.positions[0], ends.positions[1], crossings);
    const auto last =
        std::max_element(crossings.begin(), crossings.end(),
                         [](const auto& a, const auto& b) { return a.part < b.part; });
    return last != crossings.end() && last->is_front;
}

mesh::TriangleMesh HiddenVertices::moved_out() {
    const std::vector<Way> ways = ways_out();
    mesh::TriangleMesh mesh = surface_.take();
    const auto length = [&](const Way& way) {
        return way.lit * glm::distance(mesh.positions[way.vertex], mesh.positions[way.towards]);
    };
    std::vector<std::pair<float, Way>> sorted;
    sorted.reserve(ways.size());
    for (const Way& way : ways)
        sorted.emplace_back(length(way), way);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::vector<std::uint32_t>> around(ways.empty() ? 0 : mesh.num_vertices());
    std::vector<bool> is_done(around.size());
    for (const Way& way : ways)
        is_done[way.vertex] = true;
    if (!ways.empty())
        for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
            for (const std::uint32_t vertex : mesh.triangles[i])
                if (is_done[vertex])
                    around[vertex].push_back(i);
    is_done.assign(around.size(), false);
    for (const auto& [distance, way] : sorted)
        if (is_movable_[way.vertex] && !is_done[way.vertex])
            is_done[way.vertex] = move(mesh, way, around[way.vertex]);
    for (const auto& [distance, way] : sorted)
        if (!is_done[way.vertex] && way.leaves_a_solid()) {
            is_done[way.vertex] = true;
            look_from_the_end(mesh, way);
        }
    return mesh;
}

/// The vertex stays, and its rays start at the end of the way.
void HiddenVertices::look_from_the_end(mesh::TriangleMesh& mesh, const Way& way) {
    mesh.lifts.resize(mesh.num_vertices(), glm::vec3(0.0f));
    const glm::vec3 own = mesh.lifts[way.vertex], other = mesh.lifts[way.towards];
    mesh.lifts[way.vertex] =
        own + way.lit * (mesh.positions[way.towards] + other - mesh.positions[way.vertex] - own);
}

/// Moves a vertex of a flat surface, with all that it carries. Returns false where a triangle
/// would turn over.
bool HiddenVertices::move(mesh::TriangleMesh& mesh, const Way& way,
                          const std::vector<std::uint32_t>& triangles) {
    const glm::vec3 before = mesh.positions[way.vertex];
    const glm::vec3 after = before + way.lit * (mesh.positions[way.towards] - before);
    const auto cross = [&](std::uint32_t triangle, const glm::vec3& at) {
        std::array<glm::dvec3, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.triangles[triangle][k];
            corners[k] = glm::dvec3(vertex == way.vertex ? at : mesh.positions[vertex]);
        }
        return glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    };
    constexpr double LeastPart = 1e-3;
    for (const std::uint32_t triangle : triangles) {
        const glm::dvec3 old = cross(triangle, before);
        if (!(glm::dot(cross(triangle, after), old) > LeastPart * glm::dot(old, old)))
            return false;
    }
    // A triangle's uvs go on evenly beyond its corner.
    if (!mesh.corner_uvs.empty())
        for (const std::uint32_t triangle : triangles) {
            const mesh::Triangle corners = mesh.triangles[triangle];
            const auto k = static_cast<std::size_t>(
                std::find(corners.begin(), corners.end(), way.vertex) - corners.begin());
            const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
            const glm::dvec3 normal = cross(triangle, before);
            const glm::dvec3 origin(before), to(after);
            const glm::dvec3 u = glm::dvec3(mesh.positions[corners[next]]) - origin;
            const glm::dvec3 v = glm::dvec3(mesh.positions[corners[last]]) - origin;
            const double square = glm::dot(normal, normal);
            const auto part_u =
                static_cast<float>(glm::dot(glm::cross(to - origin, v), normal) / square);
            const auto part_v =
                static_cast<float>(glm::dot(glm::cross(u, to - origin), normal) / square);
            auto& uvs = mesh.corner_uvs[triangle];
            uvs[k] += part_u * (uvs[next] - uvs[k]) + part_v * (uvs[last] - uvs[k]);
        }
    const auto follow = [&](auto& values) {
        if (!values.empty())
            values[way.vertex] += way.lit * (values[way.towards] - values[way.vertex]);
    };
    follow(mesh.uvs);
    follow(mesh.second_uvs);
    follow(mesh.colors);
    follow(mesh.lifts);
    mesh.positions[way.vertex] = after;
    return true;
}

} // namespace relumine::prt
