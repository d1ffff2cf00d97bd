#include "tests/fuzz/mesh_target.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::fuzz {

namespace {

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool all_below(const std::vector<std::uint32_t>& indices, std::size_t count) {
    return std::all_of(indices.begin(), indices.end(), [&](auto i) { return i < count; });
}

template<typename Array>
bool none_or(const Array& array, std::size_t count) {
    return array.empty() || array.size() == count;
}

} // namespace

void require_sound(const mesh::TriangleMesh& mesh) {
    require(!mesh.positions.empty() && !mesh.triangles.empty(),
            "a mesh has vertices and triangles");
    require(std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite),
            "positions are finite");
    for (const mesh::Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle)
            require(vertex < mesh.num_vertices(), "triangles are of vertices");
    require(mesh.normals.size() == mesh.num_vertices(), "every vertex has a normal");
    for (const glm::vec3& normal : mesh.normals) {
        const float length = glm::length(normal);
        require(length == 0.0f || std::abs(length - 1.0f) < 1e-4f,
                "normals are unit vectors or zero");
    }
    require(none_or(mesh.colors, mesh.num_vertices()) && none_or(mesh.uvs, mesh.num_vertices()) &&
                none_or(mesh.corner_uvs, mesh.num_triangles()) &&
                none_or(mesh.triangle_materials, mesh.num_triangles()) &&
                none_or(mesh.triangle_groups, mesh.num_triangles()),
            "arrays have one element for each vertex or triangle");
    require(std::all_of(mesh.colors.begin(), mesh.colors.end(), is_finite), "colours are finite");
    require(all_below(mesh.triangle_materials, mesh.materials.size()) &&
                all_below(mesh.triangle_groups, mesh.groups.size()),
            "triangles have materials and groups of the mesh");
    for (const mesh::Material& material : mesh.materials)
        for (const auto& slot : {material.base_color_texture, material.metallic_roughness_texture,
                                 material.specular_texture})
            require(!slot || slot->texture < mesh.textures.size(),
                    "materials have textures of the mesh");
}

} // namespace relumine::fuzz
