#include "data_gen/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/icosphere.h"
#include "data_gen/noise.h"
#include "data_gen/scene_parts.h"
#include "data_gen/shapes.h"
#include "mesh/normals.h"

namespace relumine::data_gen {
namespace {

glm::dvec3 leaning(const glm::dvec3& p) {
    constexpr double Angle = 0.35; // radians
    return {p.x, p.y * std::cos(Angle) + p.z * std::sin(Angle),
            p.z * std::cos(Angle) - p.y * std::sin(Angle)};
}

// The knot's centre line, upright and leaning back. Its period is 1.
glm::dvec3 knot_line(double t) {
    constexpr double Ring = 1.0;
    constexpr double Tube = 0.42;
    const double around = 2.0 * FullTurn * t;
    const double across = 3.0 * FullTurn * t;
    const double radius = Ring + Tube * std::cos(across);
    const glm::dvec3 flat(radius * std::sin(around), radius * std::cos(around),
                          Tube * std::sin(across));
    return leaning(flat);
}

// Parameters at equal distances along the closed line, [num].
std::vector<double> even_parameters(std::uint32_t num) {
    // The chords are shorter than the line by less than 1e-7 of its length.
    constexpr int NumChords = 20'000;
    std::vector<double> length_to = {0.0};
    for (int i = 0; i < NumChords; ++i) {
        const double chord =
            glm::distance(knot_line(double(i) / NumChords), knot_line(double(i + 1) / NumChords));
        length_to.push_back(length_to.back() + chord);
    }
    std::vector<double> parameters;
    for (std::uint32_t i = 0; i < num; ++i) {
        const double wanted = length_to.back() * i / num;
        const auto above = std::upper_bound(length_to.begin(), length_to.end(), wanted);
        const double fraction = (wanted - above[-1]) / (above[0] - above[-1]);
        parameters.push_back((double(above - length_to.begin() - 1) + fraction) / NumChords);
    }
    return parameters;
}

// Two axes perpendicular to the line that close up after one turn. The first points away from the
// ring around which the knot winds.
std::array<glm::dvec3, 2> knot_axes(double t) {
    constexpr double Step = 1e-5;
    const glm::dvec3 along = glm::normalize(knot_line(t + Step) - knot_line(t - Step));
    const double around = 2.0 * FullTurn * t;
    const glm::dvec3 core = leaning({std::sin(around), std::cos(around), 0.0});
    glm::dvec3 outwards = knot_line(t) - core;
    outwards = glm::normalize(outwards - along * glm::dot(outwards, along));
    return {outwards, glm::cross(along, outwards)};
}

} // namespace

void check_num_vertices(std::size_t num_vertices) {
    if (num_vertices < MinSceneVertices || num_vertices > MaxSceneVertices) {
        throw std::invalid_argument(fmt::format("scene: expected {} to {} vertices, got {}",
                                                MinSceneVertices, MaxSceneVertices, num_vertices));
    }
}

std::uint32_t ball_frequency(double radius, double spacing, std::uint32_t minimum) {
    // An icosahedron's edge is 1.05 long on the unit sphere.
    return num_intervals(1.05 * radius, spacing, minimum);
}

mesh::TriangleMesh on_ground(mesh::TriangleMesh objects, double floor_side,
                             std::size_t num_vertices) {
    append_ground(objects, floor_side,
                  num_vertices - std::min(num_vertices, objects.num_vertices()));
    objects.normals = mesh::smooth_normals(objects);
    return objects;
}

namespace {

// Length of knot_line. It only sets how even the spacing is.
constexpr double LineLength = 15.0;
constexpr double TubeRadius = 0.27;

mesh::TriangleMesh knot_of(std::uint32_t num_across, std::uint32_t num_along) {
    mesh::TriangleMesh mesh;
    std::vector<glm::dvec3> centers;
    std::vector<std::array<glm::dvec3, 2>> axes;
    for (const double t : even_parameters(num_along)) {
        centers.push_back(knot_line(t));
        axes.push_back(knot_axes(t));
    }
    append_wrapped_grid(mesh, num_across, num_along, [&](std::uint32_t i, std::uint32_t j) {
        const double angle = FullTurn * i / num_across;
        return centers[j] +
               TubeRadius * (std::cos(angle) * axes[j][0] + std::sin(angle) * axes[j][1]);
    });
    return mesh;
}

} // namespace

mesh::TriangleMesh knot_surface(double spacing) {
    return knot_of(num_intervals(FullTurn * TubeRadius, spacing, 3),
                   num_intervals(LineLength, spacing, 24));
}

mesh::TriangleMesh knot(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    const double wish = 0.5 * static_cast<double>(num_vertices);
    const auto num_across = static_cast<std::uint32_t>(
        std::lround(std::sqrt(wish * FullTurn * TubeRadius / LineLength)));
    mesh::TriangleMesh mesh =
        knot_of(num_across, static_cast<std::uint32_t>(std::lround(wish / num_across)));
    constexpr float Gap = 0.05f;
    const float lift = Gap - mesh::bounds(mesh).min.y;
    for (glm::vec3& p : mesh.positions) {
        p.y += lift;
    }
    return on_ground(std::move(mesh), 10.0, num_vertices);
}

mesh::TriangleMesh boulder_surface(std::uint32_t frequency) {
    mesh::TriangleMesh mesh = icosphere(frequency);
    float lowest = 0.0f;
    for (glm::vec3& p : mesh.positions) {
        const glm::dvec3 direction(p);
        // Broad lumps bent by a second noise, worn ridges between them, and a fine grain.
        const glm::dvec3 bend(gradient_noise(1.3 * direction, 11),
                              gradient_noise(1.3 * direction, 12),
                              gradient_noise(1.3 * direction, 13));
        const double lumps = fractal_noise(1.15 * direction + 0.35 * bend,
                                           {.num_octaves = 9, .gain = 0.42, .seed = 1});
        const double ridges =
            1.0 - std::abs(fractal_noise(1.6 * direction + 0.3 * bend,
                                         {.num_octaves = 3, .gain = 0.35, .seed = 21}));
        const double radius = 1.0 + 0.42 * lumps + 0.30 * (ridges * ridges - 0.6);
        const glm::dvec3 rough = radius * direction;
        // The boulder lies on a side: heights below `bed` are compressed, smoothly and one to one.
        constexpr double Bed = -0.62;
        constexpr double Softness = 0.06;
        const double height = Bed + Softness * std::log1p(std::exp((rough.y - Bed) / Softness));
        p = glm::vec3(glm::dvec3(rough.x, height, rough.z));
        lowest = std::min(lowest, p.y);
    }
    for (glm::vec3& p : mesh.positions) {
        p.y -= lowest;
    }
    return mesh;
}

mesh::TriangleMesh blob(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    return on_ground(boulder_surface(icosphere_frequency(num_vertices / 2)), 7.0, num_vertices);
}

mesh::TriangleMesh sphere(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    mesh::TriangleMesh mesh = icosphere(icosphere_frequency(num_vertices / 2));
    for (glm::vec3& p : mesh.positions) {
        p = SphereCenter + SphereRadius * p;
    }
    return on_ground(std::move(mesh), 8.0, num_vertices);
}

std::span<const Scene> scenes() {
    static constexpr std::array<Scene, 7> Scenes = {{
        {"colonnade", "a round temple of fluted columns: long hard and soft shadows", colonnade},
        {"knot", "a torus knot just above the floor: soft shadows on itself and on the floor",
         knot},
        {"blob", "a weathered boulder of fractal noise: small shadows everywhere", blob},
        {"sphere", "a sphere hovering over the floor, whose shadow has a closed form", sphere},
        {"room", "a closed room with one window: sun that bounces", room},
        {"painted_room", "an open room with a red and a green wall: colours that bounce",
         painted_room},
        {"still_life", "gold, glass, lacquer, stone and a lamp on a plinth: materials", still_life},
    }};
    return Scenes;
}

} // namespace relumine::data_gen
