#include "mesh/load.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/hash.h"
#include "files/joined.h"
#include "files/output_file.h"
#include "mesh/formats/mesh_format.h"
#include "mesh/stage_hint.h"

namespace relumine::mesh {

std::string mesh_extensions() {
    std::vector<std::string_view> names;
    for (const MeshFormat& format : mesh_formats())
        names.push_back(format.extension);
    return files::joined_by_or(names);
}

bool has_mesh_extension(const std::filesystem::path& path) {
    return format_of(path) != nullptr;
}

std::string hint_of_stage(const std::filesystem::path& path) {
    for (const char* extension : {".usd", ".usda", ".usdc", ".usdz"})
        if (files::extension_of(path) == extension)
            return ": `python3 -m relumine` reads USD after pip install relumine[usd]";
    return "";
}

namespace {

bool has_normals(const PolygonSoup& soup) {
    const auto is_one = [](const glm::vec3& normal) {
        return normal != glm::vec3(0.0f);
    };
    return !soup.corner_normals.empty() ||
           std::any_of(soup.normals.begin(), soup.normals.end(), is_one);
}

} // namespace

LoadedMesh load(const std::filesystem::path& path, const LoadOptions& options) {
    // A name that is not there says so first.
    static_cast<void>(files::size(path));
    const MeshFormat* format = format_of(path);
    if (format == nullptr)
        throw std::runtime_error(fmt::format("{}: expected a mesh file ({}), got '{}'{}",
                                             path.string(), mesh_extensions(),
                                             files::extension_of(path), hint_of_stage(path)));
    const std::vector<std::byte> bytes = files::read(path);
    try {
        if ((options.pose || options.variant) && !format->has_animations)
            throw std::runtime_error(fmt::format("expected .glb or .gltf for a {}, got '{}'",
                                                 options.pose ? "pose" : "variant",
                                                 format->extension));
        PolygonSoup soup = format->read({bytes,
                                         path.parent_path(),
                                         {.pose = options.pose,
                                          .variant = options.variant,
                                          .lightmap_uvs = options.lightmap_uvs}});
        LoadedMesh result;
        result.hash = files::hash_of(bytes);
        result.camera = soup.camera;
        result.variants = soup.variants;
        result.has_normals = options.normals == NormalSource::File && has_normals(soup);
        static_cast<TriangleMesh&>(result) =
            to_mesh(std::move(soup), options.normals, options.colors);
        return result;
    } catch (const std::bad_alloc&) {
        throw std::runtime_error(
            fmt::format("{}: expected a mesh that fits into memory, got {} bytes", path.string(),
                        bytes.size()));
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), reason.what()));
    }
}

std::vector<glm::vec3> load_points(const std::filesystem::path& path, const glm::dvec3& offset) {
    const std::vector<std::byte> bytes = files::read(path);
    try {
        PolygonSoup soup = read_ply(bytes);
        if (offset != glm::dvec3(0.0))
            soup.move_back(offset);
        return std::move(soup.positions);
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), reason.what()));
    }
}

} // namespace relumine::mesh
