// The round temple of scenes.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "data_gen/icosphere.h"
#include "data_gen/lathe.h"
#include "data_gen/scene_parts.h"
#include "data_gen/scenes.h"
#include "data_gen/shapes.h"
#include "mesh/normals.h"

namespace relumine::data_gen {
namespace {

enum class Detail {
    /// Few columns, without bases.
    Plain,
    /// All mouldings.
    Full,
    /// All mouldings, and grooves in the shafts that are at least VerticesPerFlute wide.
    Fluted,
};

// Measures in metres. Heights of a column's parts are above the stylobate, the top of the steps.
constexpr double FloorRadius = 13.0;
constexpr double RingRadius = 3.6; // axes of the columns
constexpr double StylobateHeight = 0.6;
constexpr double StylobateRadius = 4.3;
constexpr double StepWidth = 0.35;
constexpr double ColumnHeight = 4.0;
constexpr double FootRadius = 0.36; // of a shaft
constexpr double NeckRadius = 0.30;
constexpr std::uint32_t NumFlutes = 20;
constexpr std::uint32_t VerticesPerFlute = 3;

std::uint32_t multiple_of(std::uint32_t factor, double value) {
    return factor * std::max(1u, static_cast<std::uint32_t>(std::lround(value / factor)));
}

// The outline of a shaft with entasis: the taper starts slowly. `spacing` along the height may be
// coarser than elsewhere.
Curve shaft(double bottom, double top, double spacing) {
    Curve points = line({FootRadius, bottom}, {NeckRadius, top}, spacing);
    for (glm::dvec2& point : points) {
        const double t = (point.y - bottom) / (top - bottom);
        point.x = FootRadius - (FootRadius - NeckRadius) * std::pow(t, 1.6);
    }
    return points;
}

mesh::TriangleMesh column(double spacing, Detail detail) {
    mesh::TriangleMesh mesh;
    std::uint32_t num_around = num_intervals(2.0 * std::numbers::pi * FootRadius, spacing, 8);
    if (detail == Detail::Plain) {
        append_disc(mesh, {.radius = FootRadius, .num_around = num_around, .facing = Facing::Down});
        append_lathe(
            mesh,
            {shaft(0.0, 3.68, 1.5 * spacing), line({NeckRadius, 3.68}, {0.46, 3.86}, spacing)},
            num_around);
        append_disc(mesh, {.radius = 0.46, .height = 3.86, .num_around = num_around});
        append_box(mesh, {-0.5, 3.86, -0.5}, {0.5, ColumnHeight, 0.5}, spacing);
        return mesh;
    }
    Flutes flutes;
    if (detail == Detail::Fluted) {
        num_around = std::max(VerticesPerFlute * NumFlutes, multiple_of(NumFlutes, num_around));
        flutes = {.count = NumFlutes, .depth = 0.028, .bottom = 0.50, .top = 3.42};
    }
    append_box(mesh, {-0.5, 0.0, -0.5}, {0.5, 0.14, 0.5}, spacing);
    // Attic base (torus, scotia, torus), shaft, astragal, neck and echinus.
    append_disc(mesh,
                {.radius = 0.42, .height = 0.14, .num_around = num_around, .facing = Facing::Down});
    append_lathe(mesh,
                 {arc({{0.42, 0.21}, {0.07, 0.07}, -90.0, 90.0}, spacing),
                  line({0.42, 0.28}, {0.40, 0.28}, spacing),
                  arc({{0.40, 0.33}, {0.04, 0.05}, -90.0, -270.0}, spacing),
                  line({0.40, 0.38}, {0.38, 0.38}, spacing),
                  arc({{0.38, 0.42}, {0.04, 0.04}, -90.0, 90.0}, spacing),
                  line({0.38, 0.46}, {FootRadius, 0.46}, spacing), shaft(0.46, 3.46, 1.5 * spacing),
                  line({NeckRadius, 3.46}, {0.31, 3.46}, spacing),
                  arc({{0.31, 3.49}, {0.03, 0.03}, -90.0, 90.0}, spacing),
                  line({0.31, 3.52}, {NeckRadius, 3.52}, spacing),
                  line({NeckRadius, 3.52}, {NeckRadius, 3.66}, spacing),
                  line({NeckRadius, 3.66}, {0.33, 3.66}, spacing),
                  arc({{0.33, 3.81}, {0.14, 0.15}, -90.0, 0.0}, spacing),
                  line({0.47, 3.81}, {0.47, 3.86}, spacing)},
                 num_around, flutes);
    append_disc(mesh, {.radius = 0.47, .height = 3.86, .num_around = num_around});
    append_box(mesh, {-0.5, 3.86, -0.5}, {0.5, ColumnHeight, 0.5}, spacing);
    return mesh;
}

int num_steps(Detail detail) {
    return detail == Detail::Plain ? 1 : 3;
}

double foot_radius(Detail detail) {
    return StylobateRadius + StepWidth * (num_steps(detail) - 1);
}

std::uint32_t num_around_steps(double spacing) {
    return std::max(18u, multiple_of(6, 2.0 * std::numbers::pi * StylobateRadius / spacing));
}

// Steps from the floor to the stylobate.
mesh::TriangleMesh steps(double spacing, Detail detail) {
    const int num = num_steps(detail);
    const std::uint32_t num_around = num_around_steps(spacing);
    const auto radius = [&](int step) {
        return foot_radius(detail) - StepWidth * step;
    };
    mesh::TriangleMesh mesh;
    append_disc(mesh, {.radius = radius(0), .num_around = num_around, .facing = Facing::Down});
    std::vector<Curve> profile;
    for (int step = 0; step < num; ++step) {
        const double bottom = StylobateHeight * step / num;
        const double top = StylobateHeight * (step + 1) / num;
        profile.push_back(line({radius(step), bottom}, {radius(step), top}, spacing));
        if (step + 1 < num) {
            profile.push_back(line({radius(step), top}, {radius(step + 1), top}, spacing));
        }
    }
    append_lathe(mesh, profile, num_around);
    append_disc(mesh, {.radius = radius(num - 1),
                       .height = StylobateHeight,
                       .num_around = num_around,
                       .fill = Fill::Even});
    return mesh;
}

// The floor around the steps, from their foot outwards. A grid below the steps would spread the
// dark under them to the nearest vertices outside. Ring k of the floor has 6 k vertices.
void append_floor_around(mesh::TriangleMesh& mesh, double foot_radius,
                         std::uint32_t foot_num_around, std::size_t num_vertices) {
    const double foot_ring = foot_num_around / 6.0;
    const double last_ring =
        std::sqrt(static_cast<double>(num_vertices) / 3.0 + foot_ring * (foot_ring - 1.0) + 0.25) -
        0.5;
    append_disc(mesh, {.radius = FloorRadius,
                       .num_around = std::max(foot_num_around + 6, 6 * static_cast<std::uint32_t>(
                                                                           std::lround(last_ring))),
                       .fill = Fill::Even,
                       .inner_radius = foot_radius,
                       .inner_num_around = foot_num_around});
}

// The ring that the columns carry: architrave of two bands, frieze and cornice.
mesh::TriangleMesh entablature(double spacing, Detail detail) {
    const double bottom = StylobateHeight + ColumnHeight;
    std::vector<glm::dvec2> outline;
    if (detail == Detail::Plain) {
        outline = {{0.4, 0.0}, {0.4, 0.7}, {-0.4, 0.7}, {-0.4, 0.0}};
    } else {
        outline = {{0.38, 0.0},   {0.38, 0.16},  {0.42, 0.16},  {0.42, 0.32}, {0.48, 0.32},
                   {0.48, 0.37},  {0.40, 0.37},  {0.40, 0.54},  {0.62, 0.58}, {0.62, 0.70},
                   {-0.48, 0.70}, {-0.48, 0.58}, {-0.38, 0.54}, {-0.38, 0.0}};
    }
    std::vector<Curve> profile;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 axis(RingRadius, bottom);
        profile.push_back(
            line(axis + outline[i], axis + outline[(i + 1) % outline.size()], spacing));
    }
    mesh::TriangleMesh mesh;
    append_lathe(mesh, profile, num_intervals(2.0 * std::numbers::pi * RingRadius, spacing, 18));
    return mesh;
}

// A globe on a round pedestal.
mesh::TriangleMesh monument(double spacing) {
    const std::uint32_t num_around =
        std::max(12u, multiple_of(6, 2.0 * std::numbers::pi * 0.66 / spacing));
    const double globe_radius = 0.62;
    mesh::TriangleMesh mesh;
    append_disc(mesh, {.radius = 0.75, .num_around = num_around, .facing = Facing::Down});
    append_lathe(mesh,
                 {line({0.75, 0.0}, {0.75, 0.16}, spacing),
                  line({0.75, 0.16}, {0.66, 0.16}, spacing),
                  arc({{0.66, 0.26}, {0.10, 0.10}, -90.0, -180.0}, spacing),
                  line({0.56, 0.26}, {0.56, 1.0}, spacing),
                  arc({{0.66, 1.0}, {0.10, 0.10}, 180.0, 90.0}, spacing),
                  line({0.66, 1.1}, {0.66, 1.2}, spacing)},
                 num_around);
    append_disc(mesh,
                {.radius = 0.66, .height = 1.2, .num_around = num_around, .fill = Fill::Even});
    mesh::TriangleMesh globe = icosphere(num_intervals(1.12 * globe_radius, spacing));
    for (glm::vec3& p : globe.positions) {
        p *= static_cast<float>(globe_radius);
    }
    append_copy(mesh, globe, 0.0, {0.0, 1.2 + globe_radius, 0.0});
    return mesh;
}

struct Parts {
    mesh::TriangleMesh column, steps, entablature, monument;
    std::uint32_t num_columns = 12;

    Parts(double spacing, Detail detail)
        : column(data_gen::column(spacing, detail)), steps(data_gen::steps(spacing, detail)),
          entablature(data_gen::entablature(spacing, detail)),
          num_columns(detail == Detail::Plain ? 6 : 12) {
        if (detail != Detail::Plain) {
            monument = data_gen::monument(spacing);
        }
    }
    [[nodiscard]] std::size_t num_vertices() const {
        return num_columns * column.num_vertices() + steps.num_vertices() +
               entablature.num_vertices() + monument.num_vertices();
    }
};

} // namespace

mesh::TriangleMesh colonnade(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    const Detail detail = num_vertices < 8'000    ? Detail::Plain
                          : num_vertices < 80'000 ? Detail::Full
                                                  : Detail::Fluted;
    // Finds the widest spacing that fills half of the wished number. The count falls as the spacing
    // grows.
    double fine = 0.001;
    double coarse = 4.0;
    for (int step = 0; step < 12; ++step) {
        const double middle = std::sqrt(fine * coarse);
        (Parts(middle, detail).num_vertices() > num_vertices / 2 ? fine : coarse) = middle;
    }
    const Parts parts(coarse, detail);
    mesh::TriangleMesh mesh;
    append_copy(mesh, parts.steps, 0.0, glm::dvec3(0.0));
    append_copy(mesh, parts.monument, 0.0, {0.0, StylobateHeight, 0.0});
    for (std::uint32_t i = 0; i < parts.num_columns; ++i) {
        const double azimuth = 2.0 * std::numbers::pi * (i + 0.5) / parts.num_columns;
        append_copy(
            mesh, parts.column, azimuth,
            {RingRadius * std::sin(azimuth), StylobateHeight, RingRadius * std::cos(azimuth)});
    }
    append_copy(mesh, parts.entablature, 0.0, glm::dvec3(0.0));
    append_floor_around(mesh, foot_radius(detail), num_around_steps(coarse),
                        num_vertices - std::min(num_vertices, mesh.num_vertices()));
    mesh.normals = mesh::smooth_normals(mesh);
    return mesh;
}

} // namespace relumine::data_gen
