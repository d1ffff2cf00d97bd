// Scenes: a mesh with its precomputed light transfer, in memory and as a .prt file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/scene/scene_file.h"
#include "prt/transfer/transfer.h"
#include "relight/pictures/framing.h"
#include "relumine/in/mesh.h"
#include "relumine/options/option_words.h"

namespace relumine {

/// A mesh, what is lit of it (vertices, pixels or texels), its transfer, and how that was made. A
/// value; bias and tolerance travel in its settings.
using prt::Scene;

/// Reads a scene and checks all of it. Throws std::runtime_error "path: expected X, got Y".
using prt::load_scene;

/// Writes a scene, whole or not at all; returns the file's size in bytes.
using prt::save_scene;

using relight::Camera;

/// Returns a scene of the mesh's vertices without clusters, at no cost. Light lists light it with
/// shadow rays. Environments cannot light it.
[[nodiscard]] Scene unclustered_scene(Mesh mesh);

/// False for unclustered_scene().
[[nodiscard]] inline bool has_clusters(const Scene& scene) {
    return scene.transfer.num_receivers() != 0;
}

/// Whether pictures turn the normals between the vertices.
[[nodiscard]] inline bool has_mapped_vertices(const Scene& scene) {
    const std::vector<mesh::Material>& materials = scene.mesh.materials;
    return prt::on_vertices(scene.layout) && !scene.mesh.corner_tangents.empty() &&
           std::any_of(materials.begin(), materials.end(), [](const mesh::Material& material) {
               return material.normal_texture || material.coat_normal_texture;
           });
}

/// Returns the RMS tolerance of the scene's clusters, 1/sr, whichever form it was given in.
[[nodiscard]] float rms_tolerance(const Scene& scene);

/// Returns which receivers lie on the floor that was added to the mesh, [num_receivers]; empty
/// where there is none.
[[nodiscard]] std::vector<bool> floor_receivers(const Scene& scene);

/// Returns the first vertex of the added floor, which is n x n and what was added to it; none where
/// there is no floor.
[[nodiscard]] std::optional<std::size_t> first_floor_vertex(const Scene& scene);

/// New colours for all surfaces but the added floor's. An empty colour stays as it is.
struct SurfaceColors {
    std::optional<glm::vec3> albedo = {};
    /// F0, or Ks of Blinn-Phong
    std::optional<glm::vec3> specular = {};
    /// The roughness of GGX highlights that follow the eye; a texture of roughness multiplies it.
    std::optional<float> roughness = {};

    bool operator==(const SurfaceColors&) const = default;
};

[[nodiscard]] OptionTable options_of(SurfaceColors& colors);
/// --material albedo=A,f0=F,roughness=R: all of them as one option, any of which may be absent.
[[nodiscard]] OptionRow material_row(SurfaceColors& colors);

/// Colours are no part of the transfer, so they may change without a new precompute.
///
/// Throws:  std::invalid_argument for a scene without materials, and as set_roughness().
void set_colors(Scene& scene, const SurfaceColors& colors);

/// Whether a material has a GGX highlight.
[[nodiscard]] bool has_ggx(const mesh::Material& material);

/// Sets the roughness of the GGX materials of a scene's mesh, but of the added floor's: its
/// highlights follow the eye, so nothing of them is stored.
///
/// Throws:  std::invalid_argument for a roughness outside of [0, 1], highlights that are stored for
///          an eye, and where no material has a GGX highlight; nothing has changed then.
void set_roughness(Scene& scene, float roughness);

/// The camera that a scene brings along: the eye that its highlights are for, the camera of the
/// mesh's file, or one inside of a room (relight::inside_room()). None for other scenes.
[[nodiscard]] std::optional<Camera> own_camera(const Scene& scene, float aspect = 1024.0f / 768.0f);

/// The camera that a picture of the scene's mesh has unless another is given: the scene's own, or
/// one that shows all of the mesh in a picture of this shape, width over height.
[[nodiscard]] Camera camera_of(const Scene& scene, float aspect = 1024.0f / 768.0f);

/// Returns the receiver nearest to a position. The scene must have a receiver.
///
/// Cost:    O(receivers).
[[nodiscard]] std::uint32_t nearest_receiver(const Scene& scene, const glm::vec3& position);

} // namespace relumine
