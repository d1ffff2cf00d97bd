#include "mesh/load.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <new>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "files/output_file.h"
#include "mesh/formats/polygon_soup.h"

namespace relumine::mesh {

namespace {

PolygonSoup read_soup(const std::filesystem::path& path, const std::string& extension,
                      std::span<const std::byte> bytes) {
    if (extension == ".obj")
        return read_obj(bytes, path.parent_path());
    if (extension == ".gltf" || extension == ".glb")
        return read_gltf(bytes, path.parent_path());
    if (extension == ".off")
        return read_off(bytes);
    if (extension == ".ply")
        return read_ply(bytes);
    return read_stl(bytes);
}

/// Returns the extension in small letters, with the dot.
std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    return extension;
}

} // namespace

bool has_mesh_extension(const std::filesystem::path& path) {
    constexpr std::array<std::string_view, 6> Extensions = {".glb", ".gltf", ".obj",
                                                            ".off", ".ply",  ".stl"};
    return std::find(Extensions.begin(), Extensions.end(), extension_of(path)) != Extensions.end();
}

TriangleMesh load(const std::filesystem::path& path, NormalSource normals) {
    const std::string extension = extension_of(path);
    // A name that is not there says so first.
    static_cast<void>(files::size(path));
    if (!has_mesh_extension(path))
        throw std::runtime_error(fmt::format(
            "{}: expected a mesh file (.glb, .gltf, .obj, .off, .ply or .stl), got '{}'",
            path.string(), extension));
    const std::vector<std::byte> bytes = files::read(path);
    try {
        return to_mesh(read_soup(path, extension, bytes), normals);
    } catch (const std::bad_alloc&) {
        throw std::runtime_error(
            fmt::format("{}: expected a mesh that fits into memory, got {} bytes", path.string(),
                        bytes.size()));
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), reason.what()));
    }
}

} // namespace relumine::mesh
