// Surfaces of revolution about the y axis.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::data_gen {

/// One smooth piece of a profile: points (radius, height), at least two.
using Curve = std::vector<glm::dvec2>;

/// Points on a straight line about `spacing` apart, both ends included.
[[nodiscard]] Curve line(const glm::dvec2& from, const glm::dvec2& to, double spacing);

/// Points on an arc of an ellipse with half axes `radii` about `center`, from one angle to the
/// other (from +radius towards +height), both ends included.
struct Arc {
    glm::dvec2 center{0.0};
    glm::dvec2 radii{1.0};
    double begin_degrees = 0.0;
    double end_degrees = 90.0;
};
[[nodiscard]] Curve arc(const Arc& shape, double spacing);

/// Grooves along the surface: `depth` at their middle between two heights, running out at both
/// ends.
struct Flutes {
    /// 0: none; otherwise a divisor of num_around
    std::uint32_t count = 0;
    double depth = 0.0;
    double bottom = 0.0;
    double top = 0.0;
};

/// Turns a profile. Its curves join end to start; every joint is a sharp edge, with doubled
/// vertices at the same place to the bit. The outside is on the right of the walk along the profile
/// (radius to the right, height up). num_around >= 3.
void append_lathe(mesh::TriangleMesh& mesh, const std::vector<Curve>& profile,
                  std::uint32_t num_around, const Flutes& flutes = {});

enum class Facing { Down, Up };

enum class Fill {
    /// A vertex in the middle: for surfaces that nobody sees
    Fan,
    /// Rings of 6, 12, 18, ... vertices, about evenly spaced; num_around must be a multiple of 6
    Even,
};

/// A flat disc that closes a lathe, or an annulus around one; its rims meet the lathe's to the bit.
struct Disc {
    double radius = 1.0;
    double height = 0.0;
    /// Vertices of the rim
    std::uint32_t num_around = 6;
    Facing facing = Facing::Up;
    Fill fill = Fill::Fan;
    /// Even only: leaves out what is inside a rim of this radius ...
    double inner_radius = 0.0;
    /// ... and of this many vertices, a multiple of 6 and less than num_around
    std::uint32_t inner_num_around = 0;
};
void append_disc(mesh::TriangleMesh& mesh, const Disc& disc);

} // namespace relumine::data_gen
