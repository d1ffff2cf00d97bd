#include "relumine/in/mesh_remarks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "files/extension.h"
#include "mesh/subject.h"
#include "relumine/in/mesh_files.h"

namespace relumine {

namespace {

/// Whether a mesh lies far along Y, not along Z, and is flat along Z: eastings, northings, heights.
bool is_like_a_map(const mesh::TriangleMesh& mesh) {
    constexpr float Flat = 0.5f;
    const glm::vec3 size = mesh::extent(mesh).box.size();
    return mesh.offset.y != 0.0 && mesh.offset.z == 0.0 && size.z < Flat * std::min(size.x, size.y);
}

/// Says which way is up where the file does not.
void add_up_axis(const Mesh& mesh, const MeshOptions& options, std::vector<std::string>& notes) {
    if (options.up)
        return;
    const std::size_t num_own =
        mesh.geometry.num_vertices() - std::size_t{mesh.floor_vertices} * mesh.floor_vertices;
    if (mesh::customary_up(mesh.source) == mesh::UpAxis::Z)
        notes.push_back(fmt::format("+Z is up, by the custom of {}; --up y where it is not",
                                    files::extension_of(mesh.source)));
    else if (is_like_a_map(mesh.geometry))
        notes.emplace_back("+Y is taken as up, but coordinates are those of a map, with heights "
                           "along Z; --up z turns it");
    else if (mesh::stands_on_z(mesh.geometry, num_own))
        notes.emplace_back("+Y is taken as up, but the mesh stands flat on its side towards -Z; "
                           "--up z turns it if it lies on its back");
}

void add_creases(const Mesh& mesh, const MeshOptions& options, std::vector<std::string>& notes) {
    const auto crease = mesh::customary_crease(mesh.source);
    if (crease && !options.crease && options.normals == mesh::NormalSource::File)
        notes.push_back(fmt::format("edges over {} degrees are sharp, by the custom of {}; "
                                    "--crease 180 where they are not",
                                    *crease, files::extension_of(mesh.source)));
}

/// Triangles that are wound the wrong way round look inwards, where it is dark, unless the file's
/// normals say otherwise.
void add_winding(const mesh::TriangleMesh& mesh, std::vector<std::string>& doubts) {
    const mesh::Winding winding = mesh::find_winding(mesh);
    std::size_t num_black = 0;
    std::uint32_t first = 0;
    for (std::uint32_t i = static_cast<std::uint32_t>(mesh.num_triangles()); i-- > 0;)
        if (winding.is_wrong[i] && mesh::faces_with_normals(mesh, i)) {
            ++num_black;
            first = i;
        }
    if (num_black == mesh.num_triangles() && num_black != 0)
        doubts.push_back(fmt::format("all {} triangles look inwards, as those of a room do: seen "
                                     "from outside they stay dark, and `relumine mesh repair` "
                                     "turns them",
                                     num_black));
    else if (num_black != 0)
        doubts.push_back(fmt::format(
            "{} of {} triangles are wound the wrong way round, the first is triangle {}: they "
            "look inwards and stay dark; `relumine mesh repair` turns them",
            num_black, mesh.num_triangles(), first));
}

} // namespace

MeshRemarks remarks_on(const Mesh& mesh, const MeshOptions& options) {
    MeshRemarks result;
    add_up_axis(mesh, options, result.notes);
    add_creases(mesh, options, result.notes);
    const mesh::TriangleMesh& geometry = mesh.geometry;
    result.notes.insert(result.notes.end(), geometry.notes.begin(), geometry.notes.end());
    result.left_out = geometry.warnings;
    result.missing = geometry.missing;
    add_winding(geometry, result.doubts);
    return result;
}

} // namespace relumine
