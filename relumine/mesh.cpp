#include "relumine/mesh.h"

#include "mesh/floor.h"
#include "prt/scene/scene_file.h"

namespace relumine {

Mesh load_mesh(const std::filesystem::path& path, const MeshOptions& options) {
    Mesh mesh(mesh::load(path, options.normals));
    mesh.source = path.string();
    mesh.source_hash = prt::file_hash(path);
    mesh::turn_up(mesh.geometry, options.up.value_or(mesh::customary_up(path)));
    if (options.floor_vertices) {
        mesh::append_floor(mesh.geometry, *options.floor_vertices, options.floor_scale);
        mesh.floor_vertices = *options.floor_vertices;
    }
    return mesh;
}

} // namespace relumine
