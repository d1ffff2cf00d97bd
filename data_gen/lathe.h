// Surfaces of revolution about the y axis.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// One smooth piece of a profile: at least two points (radius, height).
using Curve = std::vector<glm::dvec2>;

/// Returns points on a straight line about `spacing` apart, both ends included.
[[nodiscard]] Curve line(const glm::dvec2& from, const glm::dvec2& to, double spacing);

/// An arc of an ellipse with half axes `radii` about `center`, from one angle to the other. Angles
/// run from +radius towards +height.
struct Arc {
    glm::dvec2 center{0.0};
    glm::dvec2 radii{1.0};
    double begin_degrees = 0.0;
    double end_degrees = 90.0;
};
/// Returns points on an arc about `spacing` apart, both ends included.
[[nodiscard]] Curve arc(const Arc& shape, double spacing);

/// Grooves along the surface between two heights. They are `depth` deep in their middle and run out
/// at both ends.
struct Flutes {
    /// A divisor of num_around. 0: no grooves.
    std::uint32_t count = 0;
    double depth = 0.0;
    double bottom = 0.0;
    double top = 0.0;
};

/// Turns a profile. Its curves join end to start. Every joint is a sharp edge with doubled
/// vertices, which lie at the same place to the bit. Seen along the profile, with radius to the
/// right and height up, the outside is on the right. num_around is at least 3.
void append_lathe(mesh::TriangleMesh& mesh, const std::vector<Curve>& profile,
                  std::uint32_t num_around, const Flutes& flutes = {});

enum class Facing { Down, Up };

/// How the inside of a disc is divided into triangles.
enum class Fill {
    /// One vertex in the middle, for surfaces that nobody sees.
    Fan,
    /// Rings of 6, 12, 18, ... vertices, about evenly spaced. num_around must be a multiple of 6.
    Even,
};

/// A flat disc that closes a lathe, or an annulus around one. Its rims meet the lathe's to the bit.
struct Disc {
    double radius = 1.0;
    double height = 0.0;
    /// Vertices of the rim.
    std::uint32_t num_around = 6;
    Facing facing = Facing::Up;
    Fill fill = Fill::Fan;
    /// For Even only: radius of an inner rim; the area inside is left out.
    double inner_radius = 0.0;
    /// Vertices of the inner rim: a multiple of 6, less than num_around.
    std::uint32_t inner_num_around = 0;
};
/// Appends a disc to a mesh.
void append_disc(mesh::TriangleMesh& mesh, const Disc& disc);

} // namespace relumine::data_gen
