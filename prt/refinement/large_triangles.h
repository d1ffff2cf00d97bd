// Triangles that are large in a scene, and the points inside of them that are asked.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

[[nodiscard]] float longest_side(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle);

/// Returns the length of a mesh whose points are asked as far as that from each other: what hides
/// between them is small. Triangles with a longer side are large.
[[nodiscard]] float large_side(const mesh::TriangleMesh& mesh);

/// Sides of larger triangles are as many times as long as a large one.
inline constexpr float MostParts = 24.0f;

/// Returns points inside of a triangle with a side so many times as long as a large one: weights of
/// its second and third corner. One for triangles that are not large; for those at most 576.
[[nodiscard]] std::vector<glm::vec2> points_inside(float side);

/// Returns points inside of a triangle of any size where it comes near a box: what stands there
/// would lie between the points of points_inside().
[[nodiscard]] std::vector<glm::vec2> points_near(const mesh::TriangleMesh& mesh,
                                                 const mesh::Triangle& triangle,
                                                 const mesh::Bounds& box);

} // namespace relumine::prt
