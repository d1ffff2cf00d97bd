#include "data_gen/lathe.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "data_gen/scene_parts.h"
#include "data_gen/shapes.h"

namespace relumine::data_gen {
namespace {

// The only formula for a vertex of a ring. The same arguments give the same vertex to the bit.
glm::vec3 ring_point(double radius, double height, std::uint32_t i, std::uint32_t num_around) {
    const double angle = FullTurn * i / num_around;
    return {glm::dvec3(radius * std::cos(angle), height, radius * std::sin(angle))};
}

// Depth of the grooves at a height and at vertex i of a ring.
double groove(const Flutes& flutes, double height, std::uint32_t i, std::uint32_t num_around) {
    if (flutes.count == 0 || height <= flutes.bottom || height >= flutes.top) {
        return 0.0;
    }
    const std::uint32_t per_flute = num_around / flutes.count;
    const double across = double(i % per_flute) / per_flute;
    // The ends are round, about as long as a groove is deep and wide.
    const double to_end =
        std::min(height - flutes.bottom, flutes.top - height) / (3.0 * flutes.depth);
    const double end = to_end >= 1.0 ? 1.0 : std::sqrt(1.0 - (1.0 - to_end) * (1.0 - to_end));
    return flutes.depth * end * 4.0 * across * (1.0 - across);
}

} // namespace

Curve line(const glm::dvec2& from, const glm::dvec2& to, double spacing) {
    const std::uint32_t n = num_intervals(glm::distance(from, to), spacing);
    Curve points;
    for (std::uint32_t i = 0; i < n; ++i) {
        points.push_back(from + (to - from) * (double(i) / n));
    }
    points.push_back(to);
    return points;
}

Curve arc(const Arc& shape, double spacing) {
    const double radians = (shape.end_degrees - shape.begin_degrees) * std::numbers::pi / 180.0;
    const double mean_radius = 0.5 * (shape.radii.x + shape.radii.y);
    const std::uint32_t n = num_intervals(std::abs(radians) * mean_radius, spacing, 2);
    Curve points;
    for (std::uint32_t i = 0; i <= n; ++i) {
        const double angle = shape.begin_degrees * std::numbers::pi / 180.0 + radians * i / n;
        points.push_back(shape.center + shape.radii * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

void append_lathe(mesh::TriangleMesh& mesh, const std::vector<Curve>& profile,
                  std::uint32_t num_around, const Flutes& flutes) {
    assert(num_around >= 3 && "a ring needs three vertices");
    for (const Curve& curve : profile) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const glm::dvec2& point : curve) {
            for (std::uint32_t i = 0; i < num_around; ++i) {
                const double radius = point.x - groove(flutes, point.y, i, num_around);
                mesh.positions.push_back(ring_point(radius, point.y, i, num_around));
            }
        }
        for (std::uint32_t j = 0; j + 1 < curve.size(); ++j) {
            for (std::uint32_t i = 0; i < num_around; ++i) {
                const std::uint32_t below = first + j * num_around + i;
                const std::uint32_t below_next = first + j * num_around + (i + 1) % num_around;
                mesh.triangles.push_back({below, below + num_around, below_next + num_around});
                mesh.triangles.push_back({below, below_next + num_around, below_next});
            }
        }
    }
}

void append_disc(mesh::TriangleMesh& mesh, const Disc& disc) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto append = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.triangles.push_back(disc.facing == Facing::Up ? mesh::Triangle{a, c, b}
                                                           : mesh::Triangle{a, b, c});
    };
    if (disc.fill == Fill::Fan) {
        mesh.positions.emplace_back(0.0, disc.height, 0.0);
        for (std::uint32_t i = 0; i < disc.num_around; ++i) {
            mesh.positions.push_back(ring_point(disc.radius, disc.height, i, disc.num_around));
            append(first, first + 1 + i, first + 1 + (i + 1) % disc.num_around);
        }
        return;
    }
    // Ring k has 6 k vertices; ring 0 is the centre. The strip between two rings is six sectors of
    // k inner and k + 1 outer edges.
    assert(disc.num_around % 6 == 0 && disc.inner_num_around % 6 == 0 &&
           "an even disc needs rims of six equal parts");
    const std::uint32_t first_ring = disc.inner_num_around / 6;
    const std::uint32_t last_ring = disc.num_around / 6;
    const auto num_before = [](std::uint32_t ring) {
        return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1);
    };
    const auto index = [&](std::uint32_t ring, std::uint32_t i) {
        return first + num_before(ring) - num_before(first_ring) + (ring == 0 ? 0 : i % (6 * ring));
    };
    for (std::uint32_t ring = first_ring; ring <= last_ring; ++ring) {
        const double outwards = double(ring - first_ring) / (last_ring - first_ring);
        const double radius = (1.0 - outwards) * disc.inner_radius + outwards * disc.radius;
        const std::uint32_t num_around = std::max(1u, 6 * ring);
        for (std::uint32_t i = 0; i < num_around; ++i) {
            mesh.positions.push_back(ring_point(radius, disc.height, i, num_around));
        }
    }
    for (std::uint32_t ring = first_ring + 1; ring <= last_ring; ++ring) {
        const std::uint32_t inner = ring - 1;
        for (std::uint32_t sector = 0; sector < 6; ++sector) {
            for (std::uint32_t j = 0; j < ring; ++j) {
                const std::uint32_t outer_index = sector * ring + j;
                const std::uint32_t inner_index = sector * inner + j;
                append(index(inner, inner_index), index(ring, outer_index),
                       index(ring, outer_index + 1));
                if (j < inner) {
                    append(index(inner, inner_index), index(ring, outer_index + 1),
                           index(inner, inner_index + 1));
                }
            }
        }
    }
}

} // namespace relumine::data_gen
