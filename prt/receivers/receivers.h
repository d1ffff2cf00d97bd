// Receivers: the points whose light transfer is computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface.h"
#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

/// Points with normals. A receiver with a zero normal (an unreferenced vertex) receives nothing.
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

    [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// Returns one receiver per vertex, in the mesh's order: geometry relighting, any view [JN, Section
/// 3.1]. Vertices on the rim of a surface look from a little inside of it, by automatic_bias(): a
/// wall that meets the floor at a hard edge must not look out under it.
[[nodiscard]] Receivers vertex_receivers(const mesh::TriangleMesh& mesh);

/// Gives every receiver its direction to an eye. A receiver at the eye itself gets +Y.
void look_from(Receivers& receivers, const glm::vec3& eye);

/// Returns the mesh's colours at the receivers: interpolated at their points, or the vertices'
/// colours.
///
/// Shape:   [num_receivers].
/// Throws:  std::invalid_argument for a mesh without colours.
[[nodiscard]] std::vector<glm::vec3> colors_at(const mesh::TriangleMesh& mesh,
                                               const Receivers& receivers);

} // namespace relumine::prt
