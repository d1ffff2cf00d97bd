#include "prt/refinement/lit_backs.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/opacity.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/mesh_point.h"
#include "prt/refinement/coarse_transfer.h"
#include "prt/visibility/twin_triangles.h"

namespace relumine::prt {

namespace {

/// Returns the triangles with an area that the mesh has for one side only.
std::vector<std::uint32_t> triangles_without_twin(const mesh::TriangleMesh& mesh) {
    const TwinTriangles twins(mesh);
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
        if (const glm::vec3 normal = face_normal(mesh, i);
            normal != glm::vec3(0.0f) && twins.facing({.triangle = i}, normal).triangle == i)
            result.push_back(i);
    return result;
}

/// The backs of single triangles, seen at several points each.
struct Backs {
    Receivers receivers;
    /// Those of each triangle end here.
    std::vector<std::size_t> ends;
};

Backs backs_of(const mesh::TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
    const float large = large_side(mesh);
    Backs backs;
    for (const std::uint32_t triangle : triangles) {
        const glm::vec3 face = face_normal(mesh, triangle);
        const auto add = [&](const glm::vec2& at) {
            const bool is_turned =
                glm::dot(face, value_at(mesh, mesh.normals, {triangle, at})) < 0.0f;
            backs.receivers.positions.push_back(value_at(mesh, mesh.positions, {triangle, at}));
            backs.receivers.normals.push_back(is_turned ? face : -face);
        };
        for (const glm::vec2& near_corner :
             {glm::vec2(0.1f, 0.1f), glm::vec2(0.8f, 0.1f), glm::vec2(0.1f, 0.8f)})
            add(near_corner);
        for (const glm::vec2& at :
             points_inside(longest_side(mesh, mesh.triangles[triangle]) / large))
            add(at);
        backs.ends.push_back(backs.receivers.size());
    }
    return backs;
}

/// Null where the mesh has none.
const mesh::Material* material_of(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    return mesh.triangle_materials.empty() ? nullptr
                                           : &mesh.materials[mesh.triangle_materials[triangle]];
}

/// Pictures do not show the backs of single-sided faces, nor light on some. What passes light on
/// gets its back later. The surface of a body of glass has the other side within the body.
bool needs_no_back(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const mesh::Material* const material = material_of(mesh, triangle);
    return !shows_light(mesh, triangle) || passes_light_on(mesh, triangle) ||
           (material != nullptr && (!material->is_double_sided ||
                                    (material->transmission > 0.0f && material->thickness > 0.0f)));
}

/// Appends the backs of some triangles.
mesh::TriangleMesh with_backs(const mesh::TriangleMesh& mesh,
                              const std::vector<std::uint32_t>& triangles) {
    mesh::TriangleMesh result = mesh;
    const auto repeat = [](auto& values, std::uint32_t index) {
        if (!values.empty()) {
            const auto value = values[index];
            values.push_back(value);
        }
    };
    constexpr std::uint32_t None = ~std::uint32_t{0};
    std::vector<std::uint32_t> back_of(mesh.num_vertices(), None);
    for (const std::uint32_t triangle : triangles) {
        mesh::Triangle corners = mesh.triangles[triangle];
        for (std::uint32_t& corner : corners) {
            if (back_of[corner] == None) {
                back_of[corner] = static_cast<std::uint32_t>(result.num_vertices());
                mesh::for_each_vertex_array(result, [&](auto& values) { repeat(values, corner); });
                result.normals.back() = -result.normals.back();
                if (!result.lifts.empty()) // to the front's side
                    result.lifts.back() = glm::vec3(0.0f);
            }
            corner = back_of[corner];
        }
        std::swap(corners[1], corners[2]);
        result.triangles.push_back(corners);
        repeat(result.corner_uvs, triangle);
        if (!result.corner_uvs.empty())
            std::swap(result.corner_uvs.back()[1], result.corner_uvs.back()[2]);
        repeat(result.corner_tangents, triangle);
        if (!result.corner_tangents.empty()) {
            // The mapped normal is that of the front, reversed.
            for (glm::vec4& tangent : result.corner_tangents.back())
                tangent = -tangent;
            std::swap(result.corner_tangents.back()[1], result.corner_tangents.back()[2]);
        }
        repeat(result.triangle_materials, triangle);
        repeat(result.triangle_groups, triangle);
    }
    return result;
}

} // namespace

mesh::TriangleMesh with_lit_backs(const mesh::TriangleMesh& mesh, const Blockers& blockers,
                                  float bias, const Work& work) {
    std::vector<std::uint32_t> single = triangles_without_twin(mesh);
    std::erase_if(single, [&](std::uint32_t triangle) { return needs_no_back(mesh, triangle); });
    const auto [receivers, ends] = backs_of(mesh, single);
    const auto bits = CoarseDirections().trace(receivers, blockers, bias, Progress(work));
    std::vector<bool> is_lit(single.size()), is_parted(mesh.materials.size());
    for (std::size_t i = 0; i < single.size(); ++i) {
        const auto at = [&](std::size_t place) {
            return bits.begin() + static_cast<std::ptrdiff_t>(place);
        };
        is_lit[i] =
            !std::all_of(at(i == 0 ? 0 : ends[i - 1]), at(ends[i]), CoarseDirections::is_hidden);
        const mesh::Material* const material = material_of(mesh, single[i]);
        if (is_lit[i] && material != nullptr && mesh::lets_light_pass(*material))
            is_parted[mesh.triangle_materials[single[i]]] = true;
    }
    // An eye that sees through a surface would meet both sides of it, one behind the other.
    std::vector<std::uint32_t> backs;
    for (std::size_t i = 0; i < single.size(); ++i)
        if (is_lit[i] || (material_of(mesh, single[i]) != nullptr &&
                          is_parted[mesh.triangle_materials[single[i]]]))
            backs.push_back(single[i]);
    mesh::TriangleMesh result = with_backs(mesh, backs);
    for (std::size_t i = 0; i < is_parted.size(); ++i)
        if (is_parted[i])
            result.materials[i].is_double_sided = false;
    return result;
}

mesh::TriangleMesh with_backs_of_sheets(const mesh::TriangleMesh& mesh) {
    std::vector<std::uint32_t> sheets = triangles_without_twin(mesh);
    std::erase_if(sheets, [&](std::uint32_t triangle) { return !passes_light_on(mesh, triangle); });
    mesh::TriangleMesh result = with_backs(mesh, sheets);
    for (mesh::Material& material : result.materials)
        if (material.diffuse_transmission > 0.0f)
            material.is_double_sided = false;
    return result;
}

} // namespace relumine::prt
