// Scenes on disk: the .prt file. docs/prt-format.md describes it byte by byte.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_matrix.h"
#include "prt/lamps/lamps.h"
#include "prt/receivers/receiver_layout.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"

namespace relumine::prt {

/// How a transfer was made. The file keeps it, so that a result can be traced back to its source.
struct SceneSettings {
    /// RMS form, 1/sr; see PrecomputeOptions.
    float tolerance = 0.0f;
    /// Set where the paper's form was used instead.
    std::optional<float> epsilon = {};
    /// PrecomputeOptions::most_clusters. `tolerance` is what it grew to.
    std::optional<std::uint32_t> most_clusters = {};
    std::uint32_t min_level = 0;
    std::uint32_t face_resolution = 0;
    /// In the mesh's unit.
    float bias = 0.0f;
    /// n of an added floor of n x n vertices; 0 for none.
    std::uint32_t floor_vertices = 0;
    /// File name of the mesh, without folders.
    std::string source = {};
    /// Vertices of a refined floor beyond n x n. All of the floor stands at the mesh's end, its n x
    /// n first.
    std::uint32_t floor_added = 0;
    /// xxHash64 of the mesh file's bytes; 0 for a mesh that came from no file.
    std::uint64_t source_hash = 0;
    /// GlossyOptions::tolerance; set where there is a glossy part.
    std::optional<float> glossy_tolerance = {};
    /// Whether the file keeps the mesh's groups, so that they can be moved (prt/moves/).
    bool is_movable = false;
    /// BounceOptions::tolerance of the bounces, 0 without any; files keep it with the groups.
    float bounce_tolerance = 0.0f;
    /// The step of vertex_receivers() where things have moved: that of the mesh before.
    std::optional<float> rim_step = {};
    /// BounceOptions::two_sided.
    bool two_sided_bounces = false;
    /// The eye that the highlights of vertices are for.
    std::optional<Camera> view = {};
    /// The camera of the mesh's file.
    std::optional<Camera> camera = {};
    /// What the mesh's file holds and the scene does not, a line each.
    std::vector<std::string> left_out = {};
};

/// A group that was taken away: its triangles, in the order of their numbers, as they are when it
/// is back. Meanwhile all corners of a triangle are its first one, so that it blocks and shows
/// nothing. Vertices and receivers stay.
struct AbsentGroup {
    std::uint32_t group = 0;
    std::vector<mesh::Triangle> triangles = {};
    /// Those of Scene::blockers
    std::vector<mesh::Triangle> blockers = {};
};

/// Everything that relighting and drawing need.
struct Scene {
    mesh::TriangleMesh mesh;
    /// The transfer of the receivers.
    Transfer transfer;
    SceneSettings settings;
    /// The lit points. load_scene() fills them in for vertices, too.
    Receivers receivers = {};
    /// What the receivers are.
    ReceiverLayout layout = {};
    /// The triangles that block light, where they are not the mesh's own: the mesh before it was
    /// refined or simplified. Positions and triangles with their groups, nothing else.
    std::optional<mesh::TriangleMesh> blockers = {};
    /// [num_vertices] the lifts of a mesh whose groups can move, were nothing in the vertices' way;
    /// empty: free_lift() of those that they have
    std::vector<glm::vec3> free_lifts = {};
    /// Groups that were taken away (prt/scene/absent_groups.h)
    std::vector<AbsentGroup> absent = {};
    /// Light from surface to surface. It comes from vertices, so pixels and texels have the mesh's
    /// vertices behind them: Receivers::num_added.
    std::optional<BounceMatrix> bounces = {};
    /// What gives light in the scene itself.
    Lamps lamps = {};
    /// Tables of BRDFs by their number in the file; load_scene() fills them in.
    std::vector<std::shared_ptr<const mesh::BrdfTable>> brdfs = {};

    [[nodiscard]] const mesh::TriangleMesh& blocking_mesh() const {
        return blockers ? *blockers : mesh;
    }
};

/// Whether receivers have an eye and highlights, and nothing of them is stored: rays find them when
/// the scene is lit.
[[nodiscard]] bool has_traced_highlights(const Scene& scene);

/// Returns a hash of mesh, materials, receivers and settings: of all that a file has but the light.
[[nodiscard]] std::uint64_t hash_without_light(const Scene& scene);

/// Writes the scene, whole or not at all. Returns the file's size in bytes. Positions and normals
/// of receivers on vertices are taken from the mesh.
///
/// Throws:  std::runtime_error that names the path, also for values that load_scene() refuses;
///          std::invalid_argument when mesh, receivers, layout and transfer do not belong together.
std::uint64_t save_scene(const std::filesystem::path& path, const Scene& scene);

/// Reads a scene and checks all of it: sizes against the file before anything is allocated,
/// checksums, indices, the tree, the counts, the range of every number. A scene that was read can
/// be lit and drawn.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] Scene load_scene(const std::filesystem::path& path);

} // namespace relumine::prt
