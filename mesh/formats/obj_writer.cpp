#include "mesh/formats/obj_writer.h"

#include <algorithm>

#include <fmt/format.h>

#include "files/pixel_values.h"

namespace relumine::mesh {

std::string obj(const TriangleMesh& mesh, const std::string& library) {
    // The shortest text that reads back to the same float.
    std::string text = "# Relumine\n";
    if (!library.empty())
        text += fmt::format("mtllib {}\n", library);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const glm::vec3& p = mesh.positions[i];
        if (mesh.offset == glm::dvec3(0.0)) {
            text += fmt::format("v {} {} {}", p.x, p.y, p.z);
        } else {
            const glm::dvec3 far = mesh.offset + glm::dvec3(p);
            text += fmt::format("v {} {} {}", far.x, far.y, far.z);
        }
        if (!mesh.colors.empty()) // other programs have them as sRGB
            for (int k = 0; k < 3; ++k)
                text +=
                    fmt::format(" {}", files::srgb_of_linear(std::max(mesh.colors[i][k], 0.0f)));
        text += '\n';
    }
    for (const glm::vec3& n : mesh.normals)
        text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
    for (const glm::vec2& uv : mesh.uvs)
        text += fmt::format("vt {} {}\n", uv.x, uv.y);
    for (const auto& corners : mesh.corner_uvs)
        for (const glm::vec2& uv : corners)
            text += fmt::format("vt {} {}\n", uv.x, uv.y);
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        const auto changes = [&](const std::vector<std::uint32_t>& values) {
            return !values.empty() && (i == 0 || values[i] != values[i - 1]);
        };
        if (changes(mesh.triangle_groups))
            text += fmt::format("g {}\n", mesh.groups[mesh.triangle_groups[i]]);
        if (changes(mesh.triangle_materials))
            text += fmt::format("usemtl {}\n", mesh.materials[mesh.triangle_materials[i]].name);
        text += 'f';
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t vertex = mesh.triangles[i][k] + std::size_t{1};
            const std::size_t uv = mesh.uvs.empty() ? 3 * i + k + 1 : vertex;
            const bool has_uv = !mesh.uvs.empty() || !mesh.corner_uvs.empty();
            text += fmt::format(" {}", vertex);
            if (has_uv || !mesh.normals.empty())
                text += '/';
            if (has_uv)
                text += fmt::format("{}", uv);
            if (!mesh.normals.empty())
                text += fmt::format("/{}", vertex);
        }
        text += '\n';
    }
    return text;
}

std::string mtl(const TriangleMesh& mesh) {
    std::string text = "# Relumine\n";
    for (const Material& material : mesh.materials) {
        const auto color = [&](const char* key, const glm::vec3& value) {
            text += fmt::format("{} {} {} {}\n", key, value.r, value.g, value.b);
        };
        text += fmt::format("newmtl {}\n", material.name);
        color("Kd", material.base_color);
        if (material.model == MaterialModel::Phong) {
            color("Ks", material.specular);
            text += fmt::format("Ns {}\n", material.exponent);
        } else {
            text += fmt::format("Pr {}\nPm {}\n", material.roughness, material.metallic);
        }
    }
    return text;
}

} // namespace relumine::mesh
