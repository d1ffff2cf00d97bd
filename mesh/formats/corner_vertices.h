// Vertices for the corners of a file's faces.
#pragma once

#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

#include "mesh/formats/polygon_soup.h"
#include "mesh/normals.h"
#include "mesh/triangle_mesh.h"

namespace relumine::mesh {

/// Returns true for unit normals that are apart by less than a degree. Files round normals to a few
/// digits, and bends of less are not seen.
[[nodiscard]] bool are_alike(const glm::vec3& a, const glm::vec3& b);

/// Gives each corner of a soup a vertex that has the corner's normal and the colour of its face.
/// Where the corners of a vertex differ, the first keep the vertex and the others get copies, which
/// follow all vertices. Normals that are alike share their mean. A corner without a normal takes
/// that of its flat face, or of its smoothing group around the vertex. Does nothing where the
/// normals of vertices are all there is.
///
/// Input:   triangles of places in soup.corners.
/// Returns: the number of vertices that were added.
std::size_t set_corner_vertices(PolygonSoup& soup, std::span<const Triangle> triangles,
                                NormalSource source);

} // namespace relumine::mesh
