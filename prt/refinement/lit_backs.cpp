#include "prt/refinement/lit_backs.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"
#include "prt/receivers/mesh_point.h"
#include "prt/refinement/coarse_transfer.h"
#include "prt/visibility/twin_triangles.h"

namespace relumine::prt {

namespace {

/// Returns the triangles of surfaces with a rim that have no twin.
std::vector<std::uint32_t> open_triangles(const mesh::TriangleMesh& mesh) {
    const std::vector<mesh::Triangle> joined =
        mesh::renamed(mesh.triangles, mesh::first_at_place(mesh.positions));
    mesh::DisjointSets surfaces(mesh.num_vertices());
    std::vector<std::uint32_t> rims;
    mesh::for_each_edge(mesh::edge_uses(joined), [&](const auto& uses) {
        surfaces.join(uses[0].low, uses[0].high);
        if (uses.size() == 1)
            rims.push_back(uses[0].low);
    });
    std::vector<bool> is_open(mesh.num_vertices());
    for (const std::uint32_t rim : rims)
        is_open[surfaces.first(rim)] = true;
    const TwinTriangles twins(mesh);
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
        if (const glm::vec3 normal = face_normal(mesh, i);
            is_open[surfaces.first(joined[i][0])] && normal != glm::vec3(0.0f) &&
            twins.facing({.triangle = i}, normal).triangle == i)
            result.push_back(i);
    return result;
}

} // namespace

mesh::TriangleMesh with_lit_backs(const mesh::TriangleMesh& mesh, const Blockers& blockers,
                                  float bias, const Work& work) {
    constexpr std::array<glm::vec2, 4> Points = {
        {{0.33f, 0.33f}, {0.1f, 0.1f}, {0.8f, 0.1f}, {0.1f, 0.8f}}};
    const std::vector<std::uint32_t> open = open_triangles(mesh);
    Receivers receivers;
    for (const std::uint32_t triangle : open)
        for (const glm::vec2& at : Points) {
            const glm::vec3 face = face_normal(mesh, triangle);
            const bool is_turned =
                glm::dot(face, value_at(mesh, mesh.normals, {triangle, at})) < 0.0f;
            receivers.positions.push_back(value_at(mesh, mesh.positions, {triangle, at}));
            receivers.normals.push_back(is_turned ? face : -face);
        }
    const auto bits = CoarseDirections().trace(receivers, blockers, bias, Progress(work));
    mesh::TriangleMesh result = mesh;
    const auto repeat = [](auto& values, std::uint32_t index) {
        if (!values.empty()) {
            const auto value = values[index];
            values.push_back(value);
        }
    };
    constexpr std::uint32_t None = ~std::uint32_t{0};
    std::vector<std::uint32_t> back_of(mesh.num_vertices(), None);
    for (std::size_t i = 0; i < bits.size(); i += Points.size()) {
        const auto first = bits.begin() + static_cast<std::ptrdiff_t>(i);
        if (std::all_of(first, first + Points.size(), CoarseDirections::is_hidden))
            continue;
        const std::uint32_t triangle = open[i / Points.size()];
        mesh::Triangle corners = mesh.triangles[triangle];
        for (std::uint32_t& corner : corners) {
            if (back_of[corner] == None) {
                back_of[corner] = static_cast<std::uint32_t>(result.num_vertices());
                repeat(result.positions, corner);
                repeat(result.normals, corner);
                result.normals.back() = -result.normals.back();
                repeat(result.colors, corner);
                repeat(result.uvs, corner);
                repeat(result.lifts, corner);
            }
            corner = back_of[corner];
        }
        std::swap(corners[1], corners[2]);
        result.triangles.push_back(corners);
        repeat(result.corner_uvs, triangle);
        if (!result.corner_uvs.empty())
            std::swap(result.corner_uvs.back()[1], result.corner_uvs.back()[2]);
        repeat(result.triangle_materials, triangle);
        repeat(result.triangle_groups, triangle);
    }
    return result;
}

} // namespace relumine::prt
