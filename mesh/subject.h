// How large a mesh is to who looks at it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Whether nothing of a material is ever seen: its alpha is 0, or below what it is cut off at.
[[nodiscard]] bool is_unseen(const Material& material);

/// What of a mesh tells how large it is: what is seen and carries weight.
struct Extent {
    /// Around the triangles that count.
    Bounds box;
    /// [num_triangles], or empty: all count.
    std::vector<bool> counts = {};
    /// Triangles of alpha 0, which nobody sees. Where all are so, all count.
    std::size_t num_unseen = 0;
    /// Triangles that reach 16 times as far as all the others and are no thousandth of the mesh.
    std::size_t num_stray = 0;
    /// How far the others reach, and the stray ones.
    float reach = 0.0f, stray_reach = 0.0f;
};

/// Cost:    O(triangles).
[[nodiscard]] Extent extent(const TriangleMesh& mesh);

/// Returns what a user may not expect of a mesh's size, a line each: triangles that do not count.
[[nodiscard]] std::vector<std::string> doubts_of_size(const TriangleMesh& mesh);

/// Marks the vertices of the objects on the ground: triangles that count and do not lie wholly in
/// the lowest horizontal plane, nor in a wide plate under all the rest, unless there is nothing
/// else.
[[nodiscard]] std::vector<bool> subject(const TriangleMesh& mesh, const Extent& extent);

/// Returns the box around marked vertices; one in the origin around none.
[[nodiscard]] Bounds bounds_of(const TriangleMesh& mesh, const std::vector<bool>& vertices);

/// Returns the box around subject().
[[nodiscard]] Bounds subject_bounds(const TriangleMesh& mesh);

/// Returns the length that lengths in the scene are parts of: the diagonal of extent(), but no more
/// than 10 times that of the subject. A ground of kilometres does not make a crate small.
[[nodiscard]] float scale(const TriangleMesh& mesh);

} // namespace relumine::mesh
