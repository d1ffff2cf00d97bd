// The light of a mesh that is drawn, and the floor under it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/lobes.h"
#include "prt/receivers/surface.h"
#include "prt/visibility/blockers.h"
#include "relight/sharp/sharp_lights.h"
#include "relight/surfaces/reflections.h"
#include "relight/surfaces/surface_colors.h"

namespace relumine::relight {

/// A floor that becomes transparent toward its edge. Triangles of vertices from `first_vertex` on
/// are the floor.
struct FadingFloor {
    std::uint32_t first_vertex = ~std::uint32_t{0};
    /// x and z.
    glm::vec2 center{0.0f};
    /// Opaque up to the first, gone from the second on, in between smooth.
    float opaque_radius = 0.0f, end_radius = 0.0f;
    /// mesh::floor_gap().
    float gap = 0.0f;

    [[nodiscard]] bool has(const mesh::Triangle& triangle) const {
        return triangle[0] >= first_vertex;
    }
    /// Returns the opacity of a point of the floor, 0 to 1.
    [[nodiscard]] float opacity(const glm::vec3& position) const;
};

struct GatherGuide;

/// The light of a mesh that is drawn.
struct MeshLight {
    /// [num_vertices] outgoing radiance, but for what `lights` give.
    std::span<const glm::vec3> radiance;
    /// Traced at every point that is seen, with its own normal: their shadows are as sharp as the
    /// picture, on any mesh.
    std::span<const SharpLight> lights = {};
    /// Cells of the sky whose light is traced on the floor alone (relight/bright_clusters.h):
    /// `radiance` of its vertices is without it.
    std::span<const SharpLight> floor_lights = {};
    /// What blocks the lights: the mesh. Null: the picture's rays are asked. LazyBeamScene is
    /// faster, with the same answers.
    const prt::Blockers* blockers = nullptr;
    /// [num_vertices] factor on what the lights give.
    std::span<const glm::vec3> albedo = {};
    /// [num_vertices] radiance that surfaces give of their own, or empty: none. Triangles with a
    /// texture take theirs times `emission_gains`, [num_triangles] or empty.
    std::span<const glm::vec3> emission = {};
    std::span<const glm::vec3> emission_gains = {};
    [[nodiscard]] glm::vec3 emission_gain(std::uint32_t triangle) const {
        return emission_gains.empty() ? glm::vec3(1.0f) : emission_gains[triangle];
    }
    /// [num_vertices], or empty: Lambert of albedo 1.
    std::span<const prt::Surface> surfaces = {};
    /// Triangles with a texture take its colour at the point, and the light of the vertices. Null:
    /// there are none. Must fit the vertices' surfaces.
    const SurfaceColors* textures = nullptr;
    /// [num_vertices] what `radiance` is made of, or empty where nothing has a highlight: triangles
    /// with a texture take them in place of `radiance`.
    std::span<const prt::Lobes<glm::vec3>> lobes = {};
    /// [num_vertices][4 or 9] harmonics of the light that arrives (docs/harmonics.md), times the
    /// same factor as `radiance`, or empty: normal maps tilt no light but that of `lights`.
    std::span<const glm::vec3> harmonics = {};
    /// Finds the highlights of surfaces that mirror (SurfaceColors::mirrors()), for `eye`. Null:
    /// they have none.
    const Reflections* reflections = nullptr;
    /// [num_vertices] outgoing radiance in all light: what mirrors see of surfaces. The floor's is
    /// that of `radiance`.
    std::span<const glm::vec3> mirrored = {};
    /// The eye that highlights are for. Empty: there are none.
    std::optional<glm::vec3> eye = {};
    /// [num_vertices] radiance that surfaces send to each other: pictures gather it, and `sky`, at
    /// the points that are seen (relight/pictures/gathered_light.h), in place of the part of
    /// `radiance` that is `replaced`, [num_vertices] for albedo 1. Empty: nothing is gathered.
    std::span<const glm::vec3> sent = {}, replaced = {};
    /// Whether backs send as much as their fronts; otherwise they are black.
    bool sends_from_backs = false;
    /// The environment without `lights`. Null: surfaces alone are gathered.
    const Reflections* sky = nullptr;
    /// Null: each light has a guide of its own.
    GatherGuide* guide = nullptr;
    /// Lift of the rays' origins, as in prt::PrecomputeOptions.
    float bias = 0.0f;
    /// The radiance, for albedo 1, of a floor that nothing shades. With it the floor is not seen:
    /// it multiplies what is behind it with its light over this. `radiance` of its vertices is then
    /// for albedo 1.
    std::optional<glm::vec3> open_floor = {};
};

/// Returns what a floor that catches shadows leaves of the light behind it, where its own light is
/// `radiance` in place of `open`: their ratio, and 1 where it is not opaque.
[[nodiscard]] glm::vec3 caught(const glm::vec3& radiance, const glm::vec3& open, float opacity);

} // namespace relumine::relight
