#include "mesh/save.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "files/output_file.h"
#include "mesh/glb_writer.h"

namespace relumine::mesh {

namespace {

static_assert(std::endian::native == std::endian::little,
              "binary_little_endian is written from memory as it is");

std::string ply(const TriangleMesh& mesh, std::span<const glm::vec3> colors) {
    std::string content =
        fmt::format("ply\n"
                    "format binary_little_endian 1.0\n"
                    "comment Relumine: linear RGB radiance per vertex\n"
                    "element vertex {}\n"
                    "property float x\nproperty float y\nproperty float z\n"
                    "property float nx\nproperty float ny\nproperty float nz\n"
                    "property float red\nproperty float green\nproperty float blue\n"
                    "element face {}\n"
                    "property list uchar uint vertex_indices\n"
                    "end_header\n",
                    mesh.num_vertices(), mesh.num_triangles());
    const auto append = [&content](const auto& value) {
        content.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    content.reserve(content.size() + mesh.num_vertices() * 36 + mesh.num_triangles() * 13);
    for (std::size_t i = 0; i < mesh.num_vertices(); ++i) {
        append(mesh.positions[i]);
        append(i < mesh.normals.size() ? mesh.normals[i] : glm::vec3(0.0f));
        append(colors[i]);
    }
    for (const Triangle& triangle : mesh.triangles) {
        content += '\3';
        append(triangle);
    }
    return content;
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

void save(const std::filesystem::path& path, const TriangleMesh& mesh,
          std::span<const glm::vec3> colors) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    if (extension != ".ply" && extension != ".glb")
        throw std::runtime_error(
            fmt::format("{}: expected a mesh file to write (.ply or .glb), got '{}'", path.string(),
                        extension));
    std::string content;
    try {
        check(mesh, colors);
        content = extension == ".ply" ? ply(mesh, colors) : glb(mesh, colors);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
    files::OutputFile file(path);
    file.write(std::as_bytes(std::span(content)));
    file.commit();
}

} // namespace relumine::mesh
