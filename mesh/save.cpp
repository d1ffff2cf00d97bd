#include "mesh/save.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/output_file.h"
#include "files/pixel_values.h"
#include "mesh/formats/glb_writer.h"
#include "mesh/formats/obj_writer.h"

namespace relumine::mesh {

namespace {

static_assert(std::endian::native == std::endian::little,
              "binary_little_endian is written from memory as it is");

/// What a .ply file holds of a vertex beside its position and normal. Empty arrays are left out.
struct PlyVertices {
    /// Linear colours, as they are
    std::span<const glm::vec3> colors = {};
    std::span<const glm::vec2> uvs = {};
    /// Radiance, and the colours in which viewers show it
    std::span<const glm::vec3> radiance = {};
};

std::uint8_t srgb_byte(float linear) {
    return static_cast<std::uint8_t>(
        std::lround(255.0f * files::srgb_of_linear(std::clamp(linear, 0.0f, 1.0f))));
}

std::string ply(const TriangleMesh& mesh, const std::string& comment, const PlyVertices& vertices) {
    const auto& [colors, uvs, radiance] = vertices;
    const bool is_far = mesh.offset != glm::dvec3(0.0);
    std::string content = fmt::format(
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment {1}\n"
        "element vertex {2}\n"
        "property {0} x\nproperty {0} y\nproperty {0} z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "{3}{4}{5}"
        "element face {6}\n"
        "property list uchar uint vertex_indices\n"
        "end_header\n",
        is_far ? "double" : "float", comment, mesh.num_vertices(),
        colors.empty() ? "" : "property float red\nproperty float green\nproperty float blue\n",
        uvs.empty() ? "" : "property float s\nproperty float t\n",
        radiance.empty() ? ""
                         : "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                           "property float radiance_red\nproperty float radiance_green\n"
                           "property float radiance_blue\n",
        mesh.num_triangles());
    const auto append = [&content](const auto& value) {
        content.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    content.reserve(content.size() + mesh.num_vertices() * 48 + mesh.num_triangles() * 13);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        if (is_far)
            append(mesh.offset + glm::dvec3(mesh.positions[i]));
        else
            append(mesh.positions[i]);
        append(i < mesh.normals.size() ? mesh.normals[i] : glm::vec3(0.0f));
        if (!colors.empty())
            append(colors[i]);
        if (!uvs.empty())
            append(uvs[i]);
        if (!radiance.empty()) {
            for (int channel = 0; channel < 3; ++channel)
                append(srgb_byte(radiance[i][channel]));
            append(radiance[i]);
        }
    }
    for (const Triangle& triangle : mesh.triangles) {
        content += '\3';
        append(triangle);
    }
    return content;
}

void write(const std::filesystem::path& path, const std::string& content) {
    files::OutputFile file(path);
    file.write(std::as_bytes(std::span(content)));
    file.commit();
}

/// Refuses a mesh that neither format can hold.
void check(const TriangleMesh& mesh, std::span<const glm::vec3> colors) {
    if (colors.size() != mesh.num_vertices())
        throw std::runtime_error(
            fmt::format("expected {} colours, got {}", mesh.num_vertices(), colors.size()));
    if (mesh.triangles.empty())
        throw std::runtime_error("expected triangles to save, got none");
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (!std::isfinite(colors[i].x) || !std::isfinite(colors[i].y) ||
            !std::isfinite(colors[i].z))
            throw std::runtime_error(
                fmt::format("expected finite colours, got {} {} {} at vertex {}", colors[i].x,
                            colors[i].y, colors[i].z, i));
}

} // namespace

void save_lit(const std::filesystem::path& path, const TriangleMesh& mesh,
              std::span<const glm::vec3> radiance) {
    const std::string extension = files::extension_of(path);
    if (extension != ".ply" && extension != ".glb")
        throw std::runtime_error(
            fmt::format("{}: expected a mesh file to write (.ply or .glb), got '{}'", path.string(),
                        extension));
    std::string content;
    try {
        check(mesh, radiance);
        content = extension == ".ply"
                      ? ply(mesh, "Relumine: sRGB colours and linear radiance of vertices",
                            {.radiance = radiance})
                      : lit_glb(mesh, radiance);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
    write(path, content);
}

std::vector<std::string> save(const std::filesystem::path& path, const TriangleMesh& mesh) {
    const std::string extension = files::extension_of(path);
    std::vector<std::string> left_out;
    if (!mesh.textures.empty() && extension != ".glb")
        left_out.emplace_back("images of textures");
    if (!mesh.lights.empty())
        left_out.emplace_back("lights");
    if (extension == ".ply") {
        const auto leave_out = [&](bool has, const char* what) {
            if (has)
                left_out.push_back(
                    fmt::format("{}, which a .ply file of ours does not hold", what));
        };
        leave_out(!mesh.corner_uvs.empty(), "uvs of corners");
        leave_out(!mesh.triangle_materials.empty(), "materials");
        leave_out(!mesh.triangle_groups.empty(), "groups");
        write(path, ply(mesh, "Relumine", {.colors = mesh.colors, .uvs = mesh.uvs}));
    } else if (extension == ".glb") {
        std::string content;
        try {
            check(mesh, mesh.colors.empty() ? mesh.positions : mesh.colors);
            content = glb(mesh, left_out);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
        }
        write(path, content);
    } else if (extension == ".obj") {
        std::filesystem::path library;
        if (!mesh.triangle_materials.empty()) {
            library = path;
            library.replace_extension(".mtl");
            write(library, mtl(mesh));
        }
        write(path, obj(mesh, library.filename().string()));
    } else {
        throw std::runtime_error(
            fmt::format("{}: expected a mesh file to write (.ply, .glb or .obj), got '{}'",
                        path.string(), extension));
    }
    return left_out;
}

} // namespace relumine::mesh
