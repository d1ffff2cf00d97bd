// The still life of scenes.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "data_gen/icosphere.h"
#include "data_gen/lathe.h"
#include "data_gen/scene_parts.h"
#include "data_gen/scenes.h"
#include "data_gen/shapes.h"

namespace relumine::data_gen {
namespace {

using mesh::Material;

Material physical(const char* name, const glm::vec3& color, float metallic, float roughness) {
    return {.name = name,
            .model = mesh::MaterialModel::MetallicRoughness,
            .base_color = color,
            .metallic = metallic,
            .roughness = roughness,
            .is_double_sided = false};
}

/// In the order of the enumeration below.
std::vector<Material> materials() {
    std::vector<Material> all = {physical("ground", glm::vec3(0.42f), 0.0f, 1.0f),
                                 physical("plaster", {0.74f, 0.72f, 0.68f}, 0.0f, 1.0f),
                                 physical("gold", {1.0f, 0.71f, 0.29f}, 1.0f, 0.25f),
                                 physical("glass", glm::vec3(1.0f), 0.0f, 0.0f),
                                 physical("lacquer", {0.55f, 0.02f, 0.02f}, 0.0f, 0.5f),
                                 physical("stone", {0.30f, 0.31f, 0.33f}, 0.0f, 1.0f),
                                 physical("glow", glm::vec3(0.8f), 0.0f, 1.0f)};
    // Matt: without the gloss of a dielectric.
    for (Material& material : all)
        if (material.roughness == 1.0f)
            material.specular_strength = 0.0f;
    all[3].transmission = 1.0f;
    all[3].thickness = 0.6f;
    all[3].attenuation_color = {0.80f, 0.95f, 0.92f};
    all[3].attenuation_distance = 0.8f;
    all[4].coat = 1.0f;
    all[4].coat_roughness = 0.05f;
    all[6].emission = {30.0f, 17.0f, 7.0f};
    return all;
}

enum Kind : std::uint32_t { Ground, Plaster, Gold, Glass, Lacquer, Stone, Glow };

/// Objects whose parts have vertices of one spacing.
class Plinth {
public:
    explicit Plinth(double spacing) : spacing_(spacing) {}

    /// A round plinth with a rounded edge.
    void add_plinth(double radius, double height) {
        constexpr double Edge = 0.04;
        const std::uint32_t around =
            6 * std::max(2u, num_intervals(FullTurn * radius, 6.0 * spacing_));
        append_lathe(
            mesh_,
            {line({radius, 0.0}, {radius, height - Edge}, spacing_),
             arc({.center = {radius - Edge, height - Edge}, .radii = glm::dvec2(Edge)}, spacing_)},
            around);
        append_disc(
            mesh_,
            {.radius = radius - Edge, .height = height, .num_around = around, .fill = Fill::Even});
        of(Plaster);
    }

    /// A part of the unit's size that stands at `foot`.
    void add(const mesh::TriangleMesh& part, double size, const glm::dvec3& foot, Kind kind) {
        mesh::TriangleMesh scaled = part;
        for (glm::vec3& p : scaled.positions)
            p *= static_cast<float>(size);
        const double lowest = mesh::bounds(scaled.positions).min.y;
        append_copy(mesh_, scaled, 0.0, foot - glm::dvec3(0.0, lowest, 0.0));
        of(kind);
    }

    void add_ball(double radius, const glm::dvec3& foot, Kind kind) {
        // An icosahedron's edge is 1.05 long on the unit sphere.
        add(icosphere(num_intervals(1.05 * radius, spacing_)), radius, foot, kind);
    }

    [[nodiscard]] mesh::TriangleMesh take() { return std::move(mesh_); }

private:
    void of(Kind kind) { mesh_.triangle_materials.resize(mesh_.num_triangles(), kind); }

    double spacing_;
    mesh::TriangleMesh mesh_;
};

mesh::TriangleMesh objects_of(double spacing) {
    constexpr double Top = 0.14;
    Plinth objects(spacing);
    objects.add_plinth(1.3, Top);
    constexpr double KnotSize = 0.42;
    objects.add(knot_surface(spacing / KnotSize), KnotSize, {-0.12, Top, -0.3}, Gold);
    constexpr double StoneSize = 0.32;
    objects.add(boulder_surface(num_intervals(1.05 * StoneSize, spacing)), StoneSize,
                {-0.82, Top, 0.32}, Stone);
    objects.add_ball(0.3, {0.68, Top, 0.22}, Glass);
    objects.add_ball(0.2, {0.16, Top, 0.72}, Lacquer);
    objects.add_ball(0.07, {-0.3, Top, 0.62}, Glow);
    return objects.take();
}

} // namespace

mesh::TriangleMesh still_life(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    // The objects take about half of the vertices. Their count falls as the spacing grows.
    double fine = 1e-3, coarse = 1.0;
    mesh::TriangleMesh objects;
    for (int step = 0; step < 12; ++step) {
        const double middle = std::sqrt(fine * coarse);
        objects = objects_of(middle);
        (objects.num_vertices() > num_vertices / 2 ? fine : coarse) = middle;
    }
    mesh::TriangleMesh mesh = on_ground(std::move(objects), 9.0, num_vertices);
    mesh.triangle_materials.resize(mesh.num_triangles(), Ground);
    mesh.materials = materials();
    return mesh;
}

} // namespace relumine::data_gen
