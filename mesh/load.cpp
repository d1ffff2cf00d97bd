#include "mesh/load.h"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>
#include <system_error>

#include <utility>

#include <fmt/format.h>

#include "files/extension.h"
#include "files/hash.h"
#include "files/output_file.h"
#include "mesh/formats/polygon_soup.h"

namespace relumine::mesh {

namespace {

PolygonSoup read_soup(const std::filesystem::path& path, const std::string& extension,
                      std::span<const std::byte> bytes, const std::optional<Pose>& pose) {
    if (extension == ".gltf" || extension == ".glb")
        return read_gltf(bytes, path.parent_path(), pose);
    if (pose)
        throw std::runtime_error(
            fmt::format("expected .glb or .gltf for a pose, got '{}'", extension));
    if (extension == ".obj")
        return read_obj(bytes, path.parent_path());
    if (extension == ".off")
        return read_off(bytes);
    if (extension == ".ply")
        return read_ply(bytes);
    return read_stl(bytes);
}

} // namespace

bool has_mesh_extension(const std::filesystem::path& path) {
    constexpr std::array<std::string_view, 6> Extensions = {".glb", ".gltf", ".obj",
                                                            ".off", ".ply",  ".stl"};
    return std::find(Extensions.begin(), Extensions.end(), files::extension_of(path)) !=
           Extensions.end();
}

TriangleMesh load(const std::filesystem::path& path, NormalSource normals, std::uint64_t* hash,
                  std::optional<Camera>* camera, const std::optional<Pose>& pose) {
    const std::string extension = files::extension_of(path);
    // A name that is not there says so first.
    static_cast<void>(files::size(path));
    if (!has_mesh_extension(path))
        throw std::runtime_error(fmt::format(
            "{}: expected a mesh file (.glb, .gltf, .obj, .off, .ply or .stl), got '{}'",
            path.string(), extension));
    const std::vector<std::byte> bytes = files::read(path);
    if (hash != nullptr)
        *hash = files::hash_of(bytes);
    try {
        PolygonSoup soup = read_soup(path, extension, bytes, pose);
        if (camera != nullptr)
            *camera = soup.camera;
        return to_mesh(std::move(soup), normals);
    } catch (const std::bad_alloc&) {
        throw std::runtime_error(
            fmt::format("{}: expected a mesh that fits into memory, got {} bytes", path.string(),
                        bytes.size()));
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), reason.what()));
    }
}

std::vector<glm::vec3> load_points(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    try {
        return read_ply(bytes).positions;
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), reason.what()));
    }
}

} // namespace relumine::mesh
