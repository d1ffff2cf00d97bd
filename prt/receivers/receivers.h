// Receivers: the points whose light transfer is computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/opacity.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

/// Points with normals. A receiver with a zero normal (an unreferenced vertex) receives nothing,
/// unless receivers are without a surface.
struct Receivers {
    /// [num_receivers] in the mesh's unit.
    std::vector<glm::vec3> positions;
    /// [num_receivers] unit length or zero.
    std::vector<glm::vec3> normals;
    /// [num_receivers] unit directions to the eye; empty: diffuse receivers, seen from anywhere.
    std::vector<glm::vec3> to_eye = {};
    /// [num_receivers]; empty: Lambert of albedo 1.
    std::vector<Surface> surfaces = {};
    /// [num_receivers] points on the mesh; empty: receivers are its vertices.
    std::vector<MeshPoint> points = {};
    /// So many at the end are vertices of the mesh, which the others get bounced light from.
    std::size_t num_added = 0;
    /// Points in space, but for the added vertices: no surface turns them, so their normals are
    /// zero and every direction of the sphere counts, by 1 in place of a cosine.
    bool have_no_surface = false;
    /// [num_own()] of pixels, or empty: nothing is seen through them. A sample has a receiver for
    /// each surface that its ray meets, nearest first.
    std::vector<mesh::Veil> veils = {};
    /// [num_own()] of pixels that share samples, or empty: the mean square by which unit normals
    /// differ from their mean in what a receiver stands for. Highlights are widened by it
    /// (prt::widen()); files do not keep it.
    std::vector<float> normal_spread = {};
    /// [num_receivers] where points were asked for; empty: at `positions`. A point inside of an
    /// object is blind, so it looks from the position of the nearest point that is not.
    std::vector<glm::vec3> own_positions = {};

    [[nodiscard]] std::size_t size() const { return positions.size(); }
    /// Those that were asked for come first: all but the added vertices.
    [[nodiscard]] std::size_t num_own() const { return size() - num_added; }
    /// So many at the beginning have no surface.
    [[nodiscard]] std::size_t num_points() const { return have_no_surface ? num_own() : 0; }
    /// Returns the positions that were asked for.
    [[nodiscard]] const std::vector<glm::vec3>& places() const {
        return own_positions.empty() ? positions : own_positions;
    }
    /// Whether a point lies inside of an object.
    [[nodiscard]] bool is_inside(std::size_t receiver) const {
        return !own_positions.empty() && own_positions[receiver] != positions[receiver];
    }
};

/// Returns one receiver per vertex, in the mesh's order: geometry relighting, any view [JN, Section
/// 3.1]. Vertices on the rim of a surface look from a little inside of it, by automatic_bias(): a
/// wall that meets the floor at a hard edge must not look out under it. Those with a lift look from
/// the smooth surface.
[[nodiscard]] Receivers vertex_receivers(const mesh::TriangleMesh& mesh);
/// Does the same with another step in place of automatic_bias(), that of a mesh before it changed.
[[nodiscard]] Receivers vertex_receivers(const mesh::TriangleMesh& mesh, float rim_step);

/// Takes the normals of receivers that show a colour of their own and reflect nothing: unlit ones,
/// above all. No light changes them, so none is looked for.
void leave_unlit_out(Receivers& receivers);

/// Adds the mesh's vertices that belong to triangles to receivers that are others, so that these
/// have something to get bounced light from. The vertices are Lambert, whatever the
/// surface. Surfaces must be empty.
void add_vertices(Receivers& receivers, const mesh::TriangleMesh& mesh);

/// Returns some of the receivers, in the order of `chosen`, without what only their light needs:
/// direct light by clusters is found for positions and normals. Vertices behind points stay behind
/// them.
[[nodiscard]] Receivers sampled(const Receivers& receivers, std::span<const std::uint32_t> chosen);

/// Returns the vertex that an added receiver is.
[[nodiscard]] std::uint32_t vertex_at(const mesh::TriangleMesh& mesh, const MeshPoint& point);

/// Returns values of vertices from values of receivers, [num_vertices]: of the vertices themselves
/// or of the added ones. Vertices without a receiver get 0.
[[nodiscard]] std::vector<glm::vec3> vertex_values(const mesh::TriangleMesh& mesh,
                                                   const Receivers& receivers,
                                                   std::span<const glm::vec3> values);

/// Gives every receiver its direction to an eye. A receiver at the eye itself gets +Y.
void look_from(Receivers& receivers, const glm::vec3& eye);

/// Returns the cosines between normals and directions to the eye, [num_receivers]; 0 without an
/// eye.
[[nodiscard]] std::vector<EyeCosines> eye_cosines(const Receivers& receivers);

/// Returns the mesh's colours at the receivers: interpolated at their points, or the vertices'
/// colours.
///
/// Shape:   [num_receivers].
/// Throws:  std::invalid_argument for a mesh without colours.
[[nodiscard]] std::vector<glm::vec3> colors_at(const mesh::TriangleMesh& mesh,
                                               const Receivers& receivers);

} // namespace relumine::prt
