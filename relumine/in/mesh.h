// Meshes, as load_mesh() reads them and precompute() takes them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "mesh/load.h"
#include "mesh/triangle_mesh.h"
#include "mesh/up_axis.h"
#include "prt/receivers/camera.h"
#include "prt/refinement/refine.h"
#include "relumine/options/option_words.h"

namespace relumine {

inline constexpr std::array<std::string_view, 3> AxisWords = {"x", "y", "z"};
inline constexpr std::array<std::string_view, 2> NormalWords = {"file", "smooth"};
inline constexpr std::array<std::string_view, 2> ColorCurveWords = {"srgb", "linear"};

template<>
inline constexpr std::span<const std::string_view> WordsOf<mesh::UpAxis> = AxisWords;
template<>
inline constexpr std::span<const std::string_view> WordsOf<mesh::NormalSource> = NormalWords;
template<>
inline constexpr std::span<const std::string_view> WordsOf<mesh::ColorCurve> = ColorCurveWords;

/// A triangle mesh and its origin. A TriangleMesh made in code converts to it.
struct Mesh {
    mesh::TriangleMesh geometry;
    /// The path as it was given, or empty. Messages name the path. A scene file keeps its last
    /// part.
    std::string source;
    /// xxHash64 of the file's bytes, 0 without a file
    std::uint64_t source_hash = 0;
    /// n: n x n vertices, and those that refined() added, are a floor under the mesh. They stand at
    /// its end. 0: there is no floor.
    std::uint32_t floor_vertices = 0;
    std::uint32_t floor_added = 0;
    /// Whether refined_by_itself() may give the floor, or the rest, more vertices. Whoever chose
    /// the vertices wants these.
    bool is_floor_open = false, is_open = true;
    /// The file's own camera.
    std::optional<prt::Camera> camera = {};
    /// Which uvs a lightmap takes: 0, or 1 for the mesh's second ones. Empty: the second ones where
    /// they are within 0 to 1 and do not overlap.
    std::optional<std::uint32_t> lightmap_uvs = {};
    /// The triangles that block light, where they are not those of `geometry`.
    std::optional<mesh::TriangleMesh> blockers = {};

    Mesh() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): a mesh made in code is a mesh
    Mesh(mesh::TriangleMesh triangles) : geometry(std::move(triangles)) {}
};

/// "Walk@1.5": an animation of the file by name or number, and seconds (0).
struct PoseText {
    static constexpr const char* Type = "TEXT";
    static mesh::Pose read(const std::string& text);
    static std::string show(const mesh::Pose& pose);
};

/// In place of a floor's n.
inline constexpr std::uint32_t AutomaticFloor = 0;

/// "auto" or n of n x n vertices.
struct FloorText {
    static constexpr const char* Type = "N";
    static std::uint32_t read(const std::string& text);
    static std::string show(std::uint32_t n);
};

struct MeshOptions {
    /// The file's axis that points up. Empty: Z for .stl, Y for all others.
    std::optional<mesh::UpAxis> up = {};
    /// Where normals come from: the file if it has them, or always the faces.
    mesh::NormalSource normals = mesh::NormalSource::File;
    /// The moment of one of a glTF file's animations. Empty: as its nodes say.
    std::optional<mesh::Pose> pose = {};
    /// The name of a look that a glTF file offers. Empty: each surface has its own material.
    std::optional<std::string> variant = {};
    /// What colours of vertices and faces mean. Empty: by the custom of the format.
    std::optional<mesh::ColorCurve> vertex_colors = {};
    /// The set of uvs that a lightmap takes, TEXCOORD_n of glTF. Empty: 1 where it is an unwrap.
    std::optional<std::uint32_t> uv_set = {};
    /// Replaces the normals by mesh::with_creases() of so many degrees.
    std::optional<float> crease = {};
    /// n: adds a floor of n x n vertices under the mesh; 193 gives the scenes of [JN].
    /// AutomaticFloor: a coarse one, which precompute() refines where shadows fall.
    std::optional<std::uint32_t> floor_vertices = {};
    /// Side of the floor over the mesh's width, or half its height if that is more.
    float floor_scale = 4.0f;
    /// Refuses a floor that takes more bytes; PrecomputeOptions::max_memory
    std::optional<std::uint64_t> max_memory = {};
};

[[nodiscard]] OptionTable options_of(MeshOptions& options);
/// What a glTF file leaves open: --pose and --variant alone
[[nodiscard]] OptionTable open_choices(MeshOptions& options);

/// --crease of MeshOptions alone
[[nodiscard]] OptionRow crease_row(std::optional<float>& degrees);

/// Returns the mesh with smooth normals where it has none at all. All functions that take a mesh
/// begin with this, because a mesh made in code may be anything.
///
/// Throws:  std::invalid_argument as mesh::require_consistent().
[[nodiscard]] Mesh sound(Mesh mesh);

/// Reads an .obj, .gltf, .glb, .ply, .off or .stl file, makes its normals and winding agree
/// (mesh::settle_normals()), turns it upright and adds the floor.
///
/// Throws:  std::runtime_error "path: expected X, got Y" for a file that cannot be read;
///          std::invalid_argument for a floor that does not fit (mesh::append_floor());
///          MemoryLimitExceeded.
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& path, const MeshOptions& options = {});

/// Does the rest of load_mesh() with what mesh::load() gave of the file. Throws as it does.
[[nodiscard]] Mesh prepared(mesh::LoadedMesh loaded, const std::filesystem::path& path,
                            const MeshOptions& options = {});

using prt::RefineOptions;
using prt::RefineReport;

/// The options of what shapes the mesh; `light` is a file to the command line, and `bias` that of
/// the scene.
[[nodiscard]] OptionTable options_of(RefineOptions& options);

/// Returns the mesh with more vertices where its light changes between two of them, or where edges
/// are long: prt::refine(). The original triangles remain what blocks light, unless the new
/// vertices lie on a curved surface, which then does. The vertices of the file keep their places;
/// those of an added floor follow the new ones. The light of the mesh's own lamps is asked, too.
/// Where a curved surface bulges downwards the floor sinks as much.
///
/// Throws:  std::runtime_error "SOURCE: ..." where prt::refine() throws std::invalid_argument;
///          Cancelled.
[[nodiscard]] Mesh refined(Mesh mesh, RefineOptions options = {}, const prt::Work& work = {},
                           RefineReport* report = nullptr);

/// Adds the floor of the options, if there is one.
void add_floor(Mesh& mesh, const MeshOptions& options);

/// Adds an automatic floor to what stands on nothing: not to a room (relight::inside_room()), nor
/// to a mesh that has a ground of its own (mesh::subject_bounds()).
void stand_on_floor(Mesh& mesh);

/// What refined_by_itself() may add to a mesh, and to its floor.
inline constexpr std::size_t BudgetOfMesh = 45000, BudgetOfFloor = 7000;

/// Returns the mesh with more vertices where it is coarse, its triangles large in the scene, and
/// light changes between them; so is an automatic floor. At most BudgetOfMesh and BudgetOfFloor
/// vertices are added. A fine mesh, and one whose vertices were chosen by refined() or
/// simplified(), stays as it is. This is what precompute() does unless it is told not to.
///
/// Report:  gets the sums of mesh and floor; it stays as it is where nothing is asked.
/// Throws:  as refined() does.
[[nodiscard]] Mesh refined_by_itself(Mesh mesh, std::optional<float> bias = {},
                                     const prt::Work& work = {}, RefineReport* report = nullptr);

/// Returns the mesh with the backs of what passes light on from one side to the other
/// (prt::with_backs_of_sheets()), before the floor. precompute() does so last.
[[nodiscard]] Mesh with_backs_of_sheets(Mesh mesh);

/// Returns the mesh with so many vertices, its floor not counted: mesh::simplified(). The original
/// triangles remain what blocks light.
///
/// Throws:  std::runtime_error "SOURCE: ..." where mesh::simplified() throws.
[[nodiscard]] Mesh simplified(Mesh mesh, std::size_t num_vertices);

} // namespace relumine
