#include "relumine/out/drawn_mesh.h"

#include <cstdint>
#include <vector>

#include "prt/visibility/twin_triangles.h"

namespace relumine {

mesh::TriangleMesh drawn_mesh(const Scene& scene) {
    constexpr std::uint32_t None = ~std::uint32_t{0};
    mesh::TriangleMesh mesh = scene.mesh;
    if (mesh.triangle_materials.empty()) {
        mesh.materials = {mesh::Material{.name = "surface"}};
        mesh.triangle_materials.assign(mesh.num_triangles(), 0);
    }
    const prt::TwinTriangles twins(mesh);
    std::vector<std::uint32_t> fronts(mesh.materials.size(), None);
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
        std::uint32_t& material = mesh.triangle_materials[i];
        if (!mesh.materials[material].is_double_sided || !twins.other_side({.triangle = i}))
            continue;
        std::uint32_t& front = fronts[material];
        if (front == None) {
            front = static_cast<std::uint32_t>(mesh.materials.size());
            mesh.materials.push_back(mesh.materials[material]);
            mesh.materials.back().is_double_sided = false;
        }
        material = front;
    }
    return mesh;
}

} // namespace relumine
