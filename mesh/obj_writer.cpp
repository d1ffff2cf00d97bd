#include "mesh/obj_writer.h"

#include <iterator>

#include <fmt/format.h>

namespace relumine::mesh {

std::string obj(const TriangleMesh& mesh, const std::string& library) {
    // The shortest text that reads back to the same float.
    std::string text = "# Relumine\n";
    const auto out = std::back_inserter(text);
    if (!library.empty())
        fmt::format_to(out, "mtllib {}\n", library);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        const glm::vec3& p = mesh.positions[i];
        fmt::format_to(out, "v {} {} {}", p.x, p.y, p.z);
        if (!mesh.colors.empty())
            fmt::format_to(out, " {} {} {}", mesh.colors[i].r, mesh.colors[i].g, mesh.colors[i].b);
        text += '\n';
    }
    for (const glm::vec3& n : mesh.normals)
        fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);
    for (const glm::vec2& uv : mesh.uvs)
        fmt::format_to(out, "vt {} {}\n", uv.x, uv.y);
    for (const auto& corners : mesh.corner_uvs)
        for (const glm::vec2& uv : corners)
            fmt::format_to(out, "vt {} {}\n", uv.x, uv.y);
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
        const auto changes = [&](const std::vector<std::uint32_t>& values) {
            return !values.empty() && (i == 0 || values[i] != values[i - 1]);
        };
        if (changes(mesh.triangle_groups))
            fmt::format_to(out, "g {}\n", mesh.groups[mesh.triangle_groups[i]]);
        if (changes(mesh.triangle_materials))
            fmt::format_to(out, "usemtl {}\n", mesh.materials[mesh.triangle_materials[i]].name);
        text += 'f';
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t vertex = mesh.triangles[i][k] + std::size_t{1};
            const std::size_t uv = mesh.uvs.empty() ? 3 * i + k + 1 : vertex;
            const bool has_uv = !mesh.uvs.empty() || !mesh.corner_uvs.empty();
            fmt::format_to(out, " {}", vertex);
            if (has_uv || !mesh.normals.empty())
                text += '/';
            if (has_uv)
                fmt::format_to(out, "{}", uv);
            if (!mesh.normals.empty())
                fmt::format_to(out, "/{}", vertex);
        }
        text += '\n';
    }
    return text;
}

std::string mtl(const TriangleMesh& mesh) {
    std::string text = "# Relumine\n";
    const auto out = std::back_inserter(text);
    for (const Material& material : mesh.materials) {
        const auto color = [&](const char* key, const glm::vec3& value) {
            fmt::format_to(out, "{} {} {} {}\n", key, value.r, value.g, value.b);
        };
        fmt::format_to(out, "newmtl {}\n", material.name);
        color("Kd", material.base_color);
        if (material.model == MaterialModel::Phong) {
            color("Ks", material.specular);
            fmt::format_to(out, "Ns {}\n", material.exponent);
        } else {
            fmt::format_to(out, "Pr {}\nPm {}\n", material.roughness, material.metallic);
        }
    }
    return text;
}

} // namespace relumine::mesh
