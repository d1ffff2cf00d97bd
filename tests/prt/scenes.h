// Small meshes, trees and random things that the tests of prt and relight share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/face.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/quadtree.h"

namespace relumine::scenes {

/// n x n vertices of a square of the given side in the plane y = height, facing +Y.
[[nodiscard]] mesh::TriangleMesh floor_grid(std::uint32_t n, float side, float height = 0.0f);

/// A sphere from an icosahedron whose triangles are quartered `level` times; outward normals.
[[nodiscard]] mesh::TriangleMesh icosphere(std::uint32_t level, float radius,
                                           const glm::vec3& centre);

/// An axis-aligned box, 8 vertices, outward normals that point along the diagonals.
[[nodiscard]] mesh::TriangleMesh box(const glm::vec3& low, const glm::vec3& high);

/// One mesh of both; triangles of the second follow.
[[nodiscard]] mesh::TriangleMesh joined(const mesh::TriangleMesh& first,
                                        const mesh::TriangleMesh& second);

/// Triangles with random corners in [-1, 1]^3; no normals.
[[nodiscard]] mesh::TriangleMesh triangle_soup(std::size_t num_triangles, std::uint32_t seed);

/// A floor with a sphere and a slanted box over it: hard and soft shadows, faces of every slope.
/// About 300 vertices.
[[nodiscard]] mesh::TriangleMesh sphere_and_box_on_floor();

/// Evenly distributed unit vector.
[[nodiscard]] glm::vec3 random_direction(std::mt19937& random);

/// Split flags of six random trees no deeper than `max_level`; a cell is split with the given
/// probability.
[[nodiscard]] std::vector<bool> random_split_flags(std::mt19937& random, std::uint32_t max_level,
                                                   double probability);

/// The integral of w over the solid angle of [s0, s1] x [t0, t1] of a face: Lambert's formula for a
/// polygonal light, half the sum over its edges of the edge's angle times the unit normal of the
/// edge's plane.
[[nodiscard]] glm::dvec3 vector_irradiance_of_white(cubemap::Face face, double s0, double t0,
                                                    double s1, double t1);
[[nodiscard]] glm::dvec3 vector_irradiance_of_white(const prt::Cell& cell);

/// The mesh with its positions scaled, then moved.
[[nodiscard]] mesh::TriangleMesh transformed(mesh::TriangleMesh mesh, float scale,
                                             const glm::vec3& offset);

} // namespace relumine::scenes
