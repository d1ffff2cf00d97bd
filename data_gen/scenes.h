// Generated scenes for the demo, the benchmarks and experiments.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

inline constexpr std::size_t MinSceneVertices = 1'000;
inline constexpr std::size_t MaxSceneVertices = 5'000'000;

// Every scene stands on a flat floor at y = 0 that faces +Y and holds about half of the vertices.
// The rest are closed surfaces of evenly spaced vertices: smooth where the shape is smooth, with
// doubled vertices along sharp edges. Normals are set; colours and texture coordinates are not.
//
// Unit:    metre.
// Result:  `num_vertices` is met within 4 % (1 % from 20,000 on). The same argument gives the same
//          bits.
// Throws:  std::invalid_argument outside [MinSceneVertices, MaxSceneVertices].

/// Returns a round open temple: steps, a ring of columns with bases and capitals under an
/// entablature, and a globe on a pedestal in the middle. Columns are fluted from 80,000 vertices
/// on. The temple is 10 m across and 5.3 m high; the floor is round, 26 m across, and begins at the
/// foot of the steps.
///
/// Below 8,000 vertices there are fewer and plainer columns. Near 1,000 the floor has less than
/// half of the vertices.
[[nodiscard]] mesh::TriangleMesh colonnade(std::size_t num_vertices = 100'000);

/// Returns a (2,3) torus knot that leans back a little and hovers just above the floor. It shows
/// contact shadows, and soft shadows on itself.
[[nodiscard]] mesh::TriangleMesh knot(std::size_t num_vertices = 100'000);

/// Returns a weathered boulder on the floor: a sphere displaced by several octaves of gradient
/// noise.
[[nodiscard]] mesh::TriangleMesh blob(std::size_t num_vertices = 100'000);

/// Returns a sphere hovering over the floor. It takes the part (SphereRadius / d)^2 cos(t) of the
/// sky's cosine-weighted light from a floor point p. Here d = |SphereCenter - p|, and t is the
/// angle between the direction to the centre and +Y. The sphere is above the horizon of every floor
/// point.
///
/// Source:  form factor of a sphere; Howell, "A Catalog of Radiation Heat Transfer Configuration
///          Factors".
[[nodiscard]] mesh::TriangleMesh sphere(std::size_t num_vertices = 100'000);
inline constexpr float SphereRadius = 1.0f;
inline constexpr glm::vec3 SphereCenter{0.0f, 1.5f, 0.0f};

/// One row of the list of scenes.
struct Scene {
    std::string_view name;
    /// One line.
    std::string_view description;
    mesh::TriangleMesh (*make)(std::size_t num_vertices);
};

/// Returns all scenes in the order to show them.
[[nodiscard]] std::span<const Scene> scenes();

} // namespace relumine::data_gen
