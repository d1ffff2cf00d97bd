#include "mesh/formats/mesh_format.h"

#include <algorithm>

#include "files/extension.h"

namespace relumine::mesh {

namespace {

PolygonSoup gltf(const MeshFile& file) {
    return read_gltf(file.bytes, file.folder, file.gltf);
}
PolygonSoup obj(const MeshFile& file) {
    return read_obj(file.bytes, file.folder);
}
PolygonSoup off(const MeshFile& file) {
    return read_off(file.bytes);
}
PolygonSoup ply(const MeshFile& file) {
    return read_ply(file.bytes);
}
PolygonSoup stl(const MeshFile& file) {
    return read_stl(file.bytes);
}

constexpr MeshFormat Formats[] = {
    {.extension = ".glb", .read = gltf, .has_animations = true},
    {.extension = ".gltf", .read = gltf, .has_animations = true},
    {.extension = ".obj", .read = obj},
    {.extension = ".off", .read = off},
    {.extension = ".ply", .read = ply},
    // From CAD and printing.
    {.extension = ".stl", .read = stl, .up = UpAxis::Z, .crease = 40.0f},
};

} // namespace

std::span<const MeshFormat> mesh_formats() {
    return Formats;
}

const MeshFormat* format_of(const std::filesystem::path& path) {
    const auto* found =
        std::ranges::find(Formats, files::extension_of(path), &MeshFormat::extension);
    return found != std::end(Formats) ? found : nullptr;
}

} // namespace relumine::mesh
