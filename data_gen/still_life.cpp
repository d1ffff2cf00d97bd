// The still life of scenes.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "data_gen/icosphere.h"
#include "data_gen/lathe.h"
#include "data_gen/scene_parts.h"
#include "data_gen/scenes.h"
#include "data_gen/shapes.h"
#include "mesh/normals.h"

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
                                 physical("gold", {1.0f, 0.71f, 0.29f}, 1.0f, 0.15f),
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
    all[4].coat = 1.0f;
    all[4].coat_roughness = 0.05f;
    all[6].emission = {30.0f, 17.0f, 7.0f};
    return all;
}

enum Kind : std::uint32_t { Ground, Plaster, Gold, Glass, Lacquer, Stone, Glow };

constexpr double PlinthRadius = 1.3, PlinthHeight = 0.14, GroundRadius = 6.0;

/// The still life, whose objects have vertices of one spacing.
class StillLife {
public:
    explicit StillLife(double spacing)
        : spacing_(spacing),
          around_(6 * std::max(2u, num_intervals(FullTurn * PlinthRadius, 6.0 * spacing))) {}

    /// A round plinth with a rounded edge.
    void add_plinth() {
        constexpr double Edge = 0.04, Inside = PlinthRadius - Edge, Below = PlinthHeight - Edge;
        append_lathe(mesh_,
                     {line({PlinthRadius, 0.0}, {PlinthRadius, Below}, spacing_),
                      arc({.center = {Inside, Below}, .radii = glm::dvec2(Edge)}, spacing_)},
                     around_);
        append_disc(mesh_, {.radius = PlinthRadius, .num_around = around_, .facing = Facing::Down});
        append_disc(
            mesh_,
            {.radius = Inside, .height = PlinthHeight, .num_around = around_, .fill = Fill::Even});
        of(Plaster);
    }

    /// A part of the unit's size that stands on the plinth.
    void add(const mesh::TriangleMesh& part, double size, const glm::dvec2& foot, Kind kind) {
        mesh::TriangleMesh scaled = part;
        for (glm::vec3& p : scaled.positions)
            p *= static_cast<float>(size);
        const double lowest = mesh::bounds(scaled.positions).min.y;
        append_copy(mesh_, scaled, 0.0, {foot.x, PlinthHeight - lowest, foot.y});
        of(kind);
    }

    void add_ball(double radius, const glm::dvec2& foot, Kind kind) {
        add(icosphere(ball_frequency(radius, spacing_, 2)), radius, foot, kind);
    }

    /// The ground about the plinth, whose outer rim has so many vertices.
    void add_ground(std::uint32_t around) {
        append_disc(mesh_, {.radius = GroundRadius,
                            .num_around = std::max(around, around_ + 6),
                            .fill = Fill::Even,
                            .inner_radius = PlinthRadius,
                            .inner_num_around = around_});
        of(Ground);
    }

    [[nodiscard]] std::size_t num_vertices() const { return mesh_.num_vertices(); }
    [[nodiscard]] mesh::TriangleMesh take() {
        mesh_.normals = mesh::smooth_normals(mesh_);
        mesh_.materials = materials();
        return std::move(mesh_);
    }

private:
    void of(Kind kind) { mesh_.triangle_materials.resize(mesh_.num_triangles(), kind); }

    double spacing_;
    std::uint32_t around_;
    mesh::TriangleMesh mesh_;
};

StillLife objects(double spacing) {
    StillLife all(spacing);
    all.add_plinth();
    constexpr double KnotSize = 0.42, StoneSize = 0.32;
    all.add(knot_surface(spacing / KnotSize), KnotSize, {-0.12, -0.3}, Gold);
    // The boulder's fine grain takes more vertices.
    all.add(boulder_surface(num_intervals(2.0 * StoneSize, spacing, 2)), StoneSize, {-0.82, 0.32},
            Stone);
    all.add_ball(0.3, {0.68, 0.22}, Glass);
    all.add_ball(0.2, {0.16, 0.72}, Lacquer);
    all.add_ball(0.07, {-0.3, 0.62}, Glow);
    return all;
}

} // namespace

mesh::TriangleMesh still_life(std::size_t num_vertices) {
    check_num_vertices(num_vertices);
    const auto miss = [&](const StillLife& scene) {
        return std::abs(static_cast<double>(scene.num_vertices()) -
                        static_cast<double>(num_vertices));
    };
    // The objects' count falls as the spacing grows, in steps; the ground's grows with its rim's.
    // Objects have some 18 m^2. A vertex of triangles of one edge takes 0.87 of the edge's square.
    const auto half = static_cast<double>(num_vertices) / 2.0;
    double spacing = std::sqrt(18.0 / (0.87 * half));
    for (int step = 0; step < 4; ++step)
        spacing *= std::sqrt(static_cast<double>(objects(spacing).num_vertices()) / half);
    std::optional<StillLife> best;
    for (int coarser = 0; coarser < 6; ++coarser) {
        const StillLife standing = objects(spacing * (1.0 + 0.01 * coarser));
        std::uint32_t low = 1, high = static_cast<std::uint32_t>(std::sqrt(num_vertices)) + 8;
        while (low + 1 < high) {
            const std::uint32_t middle = (low + high) / 2;
            StillLife scene = standing;
            scene.add_ground(6 * middle);
            (scene.num_vertices() > num_vertices ? high : low) = middle;
            if (!best || miss(scene) < miss(*best))
                best = std::move(scene);
        }
        if (miss(*best) < 0.002 * static_cast<double>(num_vertices))
            break;
    }
    return best->take();
}

} // namespace relumine::data_gen
