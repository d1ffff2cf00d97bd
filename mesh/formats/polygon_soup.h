// Vertices and polygons as a file has them: the readers make them for load().
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "files/free_memory.h"
#include "mesh/camera.h"
#include "mesh/normals.h"
#include "mesh/pose.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_colors.h"

namespace relumine::mesh {

/// What colours of vertices and faces are by the custom of a format.
struct ColorCustom {
    ColorCurve curve = ColorCurve::Linear;
    /// Numbers of 0 to 255, or to 65535, occur beside those of 0 to 1.
    bool may_be_whole = false;
    /// Why the curve is this one, where other programs may take another: "as ..."
    std::string reason = {};
};

/// Vertices and faces as they stand in a file, not checked.
struct PolygonSoup {
    /// [num_vertices]. Values may be infinite or NaN; load() checks them.
    std::vector<glm::vec3> positions;
    /// What floats rounded off the positions, of the first vertices; the rest have nothing.
    std::vector<glm::vec3> remainders;
    /// TriangleMesh::offset, once centre() was called.
    glm::dvec3 offset{0.0};
    /// Vertex indices of all faces, one face after the other. They may be out of range.
    std::vector<std::uint32_t> corners;
    /// What is said behind a refusal of a mesh without faces.
    std::string why_no_faces;
    /// [num_faces], the end of each face in `corners`.
    std::vector<std::size_t> face_ends;
    /// [num_vertices] of any length, or empty.
    std::vector<glm::vec3> normals;
    /// [num_vertices] as `color_custom` says, or empty.
    std::vector<glm::vec3> colors;
    /// [num_vertices], or empty.
    std::vector<glm::vec2> uvs;
    /// [num_vertices], or empty.
    std::vector<glm::vec2> second_uvs;
    /// [num_vertices] of any length, or empty, as set_tangents() takes them.
    std::vector<glm::vec4> tangents;
    /// Parallel to `corners`, or empty.
    std::vector<glm::vec2> corner_uvs;
    /// Parallel to `corners`, of any length, or empty. Zero: the corner has none, and takes that of
    /// its vertex.
    std::vector<glm::vec3> corner_normals;

    /// [num_faces], or empty: all are in one group. What has no normals is smooth between the faces
    /// of one group; those of group 0 are flat.
    std::vector<std::uint32_t> face_smoothing;
    /// [num_faces] as `color_custom` says, or empty. They count in place of `colors`.
    std::vector<glm::vec3> face_colors;
    ColorCustom color_custom = {};
    /// [num_faces] indices into materials, or empty.
    std::vector<std::uint32_t> face_materials;
    /// [num_faces] indices into groups, or empty.
    std::vector<std::uint32_t> face_groups;
    std::vector<Material> materials;
    std::vector<std::string> groups;
    std::vector<Texture> textures;
    /// Names of the looks that a glTF file offers (KHR_materials_variants).
    std::vector<std::string> variants;
    std::vector<PunctualLight> lights;
    /// [lights], or empty: their positions are exact.
    std::vector<glm::dvec3> light_positions;
    std::optional<Camera> camera = {};
    /// Files that do not exist, what the soup does not hold, and how it was read
    /// (TriangleMesh::missing, warnings, notes).
    std::vector<std::string> missing, warnings, notes;

    /// Appends a vertex of a file that has more digits than floats.
    void add_position(const glm::dvec3& position);
    /// Takes a vector off the positions, with what floats rounded off them.
    void move_back(const glm::dvec3& by);
    /// Closes the face whose corners were appended to `corners` since the last call.
    void end_face() { face_ends.push_back(corners.size()); }
};

/// Takes an offset off all coordinates, those of lights among them, if most vertices lie nearer to
/// each other than a sixteenth of their distance from the origin, and floats rounded them or are
/// about to round what is computed. A second call does nothing.
void centre(PolygonSoup& soup);

/// Checks the soup, centres it, cuts its polygons into triangles, completes the normals and makes
/// the colours linear, as load() promises. `curve` counts in place of the custom for colours.
/// Throws:  std::runtime_error "expected X, got Y".
[[nodiscard]] TriangleMesh to_mesh(PolygonSoup soup, NormalSource source,
                                   std::optional<ColorCurve> curve = {});

/// What a glTF file leaves open.
struct GltfOptions {
    /// LoadOptions has these three.
    std::optional<Pose> pose = {};
    std::optional<std::string> variant = {};
    std::optional<std::uint32_t> lightmap_uvs = {};
    /// A mesh of several nodes is repeated for each node, up to so much in all.
    std::uint64_t max_bytes = files::free_memory() / 2;
};

/// The readers, one per format. They take a whole file's bytes, never read outside them, and
/// allocate no more than a small multiple of their size. Other files that a file names are looked
/// up from its `folder`.
/// Throws:  std::runtime_error "expected X, got Y"; load() puts the path in front.
[[nodiscard]] PolygonSoup read_gltf(std::span<const std::byte> bytes,
                                    const std::filesystem::path& folder,
                                    const GltfOptions& options = {});
[[nodiscard]] PolygonSoup read_obj(std::span<const std::byte> bytes,
                                   const std::filesystem::path& folder = {});
[[nodiscard]] PolygonSoup read_off(std::span<const std::byte> bytes);
[[nodiscard]] PolygonSoup read_ply(std::span<const std::byte> bytes);
[[nodiscard]] PolygonSoup read_stl(std::span<const std::byte> bytes);

} // namespace relumine::mesh
