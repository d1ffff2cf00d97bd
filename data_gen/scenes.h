// Scenes made from nothing, for the demo, the benchmarks and for trying things out.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

inline constexpr std::size_t MinSceneVertices = 1'000;
inline constexpr std::size_t MaxSceneVertices = 5'000'000;

// Every scene stands on a flat floor at y = 0 that faces +Y and holds about half of the vertices;
// the rest are closed surfaces of evenly spaced vertices, smooth where the shape is and with
// doubled vertices along sharp edges. Normals are set; colours and texture coordinates are not.
// Units are metres. `num_vertices` is a wish that is met within 4 % (1 % from 20,000 on). The same
// argument gives the same bits. Throws std::invalid_argument outside [MinSceneVertices,
// MaxSceneVertices].

/// A round open temple: steps, a ring of columns with bases and capitals (fluted from 80,000
/// vertices on) under an entablature, and a globe on a pedestal in the middle. 10 m across, 5.3 m
/// high; the floor is round, 26 m across, and begins at the foot of the steps. Below 8,000 vertices
/// there are fewer and plainer columns, and down to 1,000 the floor has less than half of the
/// vertices.
[[nodiscard]] mesh::TriangleMesh colonnade(std::size_t num_vertices = 100'000);

/// A (2,3) torus knot, leaning back a little, hovering just above the floor: contact shadows and
/// soft shadows on itself.
[[nodiscard]] mesh::TriangleMesh knot(std::size_t num_vertices = 100'000);

/// A weathered boulder: a sphere displaced by several octaves of gradient noise, lying on the
/// floor.
[[nodiscard]] mesh::TriangleMesh blob(std::size_t num_vertices = 100'000);

/// A sphere hovering over the floor. The part of the sky's cosine-weighted light that it takes from
/// a floor point p is (SphereRadius / d)^2 cos(t), with d = |SphereCenter - p| and t the angle
/// between that direction and +Y: the sphere stands clear of the horizon everywhere (the form
/// factor of a sphere; Howell, "A Catalog of Radiation Heat Transfer Configuration Factors").
[[nodiscard]] mesh::TriangleMesh sphere(std::size_t num_vertices = 100'000);
inline constexpr float SphereRadius = 1.0f;
inline constexpr glm::vec3 SphereCenter{0.0f, 1.5f, 0.0f};

/// One row of the list of scenes.
struct Scene {
    std::string_view name;
    /// One line
    std::string_view description;
    mesh::TriangleMesh (*make)(std::size_t num_vertices);
};

/// All scenes, in the order to show them.
[[nodiscard]] std::span<const Scene> scenes();

} // namespace relumine::data_gen
