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

// Every scene stands on a flat floor at y = 0 that faces +Y. Outside of rooms it holds about half
// of the vertices, and the rest are closed surfaces. Vertices are evenly spaced, shared where the
// shape is smooth and doubled along sharp edges. Normals are set, texture coordinates are not; only
// rooms have colours, only the still life has materials.
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

/// Returns a closed room, 4 x 2.8 x 5 m, with one window: light that bounces. Floor, walls and
/// ceiling are sheets that face inwards. A box and a ball stand on the floor. The window is a shaft
/// of 0.3 m in the wall at x = -2, open outside, where the sun of `sun_sky` shines in.
[[nodiscard]] mesh::TriangleMesh room(std::size_t num_vertices = 100'000);

/// Returns a room without a front wall, 4 x 3.2 x 4 m: its left wall is red, its right wall green.
/// A box and a ball on the floor show the colours that bounce.
[[nodiscard]] mesh::TriangleMesh painted_room(std::size_t num_vertices = 100'000);

/// Returns a gold knot, a glass ball, a lacquered ball, a stone and a small glowing ball on a
/// plinth of plaster, 2.6 m across. All but glass, gold and lacquer is matt.
[[nodiscard]] mesh::TriangleMesh still_life(std::size_t num_vertices = 100'000);

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
