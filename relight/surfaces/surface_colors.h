// Colours between the vertices: from the textures, at the point that is seen.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/glossy/lobes.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/surface.h"

namespace relumine::mesh {
class MipMaps;
}

namespace relumine::relight {

/// Returns light before a surface of this colour reflected it; 0 in channels where that is black.
template<typename Light>
[[nodiscard]] Light before_color(const Light& light, const glm::vec3& color) {
    Light result(0);
    for (int channel = 0; channel < 3; ++channel)
        if (color[channel] > 0.0f)
            result[channel] = light[channel] / color[channel];
    return result;
}

/// Takes the light from the vertices and the colours from the textures, so that a picture shows
/// what is finer than the mesh. Highlights keep their shape and stay on top.
class SurfaceColors {
public:
    /// Nothing has a texture.
    SurfaceColors() = default;
    /// `surfaces` are the vertices', [num_vertices] or empty, with highlights if the scene has an
    /// eye for them. The mesh must outlive this object.
    SurfaceColors(const mesh::TriangleMesh& mesh, std::span<const prt::Surface> surfaces,
                  bool has_highlights = false);

    /// Whether a triangle has a texture of its albedo, its emission or its normals, or passes light
    /// on.
    [[nodiscard]] bool has(std::uint32_t triangle) const {
        return !is_textured_.empty() && is_textured_[triangle];
    }
    /// The textures at all levels, where any triangle has one.
    [[nodiscard]] const mesh::MipMaps* maps() const { return maps_.get(); }
    /// Returns the albedo at a point of such a triangle.
    [[nodiscard]] glm::vec3 albedo(const prt::MeshPoint& point) const {
        return surface(point).albedo;
    }
    /// Whether a triangle's material has a highlight that the scene has not: pictures find it by
    /// rays (relight/surfaces/reflections.h).
    [[nodiscard]] bool mirrors(std::uint32_t triangle) const {
        return !mirrors_.empty() && mirrors_[triangle];
    }
    /// Whether any triangle does.
    [[nodiscard]] bool has_mirrors() const { return !mirrors_.empty(); }
    /// Returns the surface that the materials give to a point, or to a sample of a view.
    [[nodiscard]] prt::Surface surface(const prt::MeshPoint& point,
                                       const prt::TextureView* view = nullptr) const;
    /// Returns the surface at a point of a triangle that mirrors, with its highlight.
    [[nodiscard]] prt::Surface mirror(const prt::MeshPoint& point,
                                      const prt::TextureView* view = nullptr) const;
    /// Returns the diffuse radiance of albedo 1 at a point of a triangle that has a texture or
    /// mirrors, and a change to it, which may be less than 0.
    [[nodiscard]] glm::vec3 light(std::span<const glm::vec3> vertex_radiance,
                                  const prt::MeshPoint& point,
                                  const glm::vec3& change = glm::vec3(0.0f)) const;
    /// Returns the radiance at a point of such a triangle, under the light of its vertices and a
    /// change to it, which may be less than 0.
    [[nodiscard]] glm::vec3 radiance(std::span<const glm::vec3> vertex_radiance,
                                     const prt::MeshPoint& point,
                                     const glm::vec3& change = glm::vec3(0.0f),
                                     const prt::TextureView* view = nullptr) const;

private:
    const mesh::TriangleMesh* mesh_ = nullptr;
    /// [num_triangles], or empty.
    std::vector<bool> is_textured_, mirrors_;
    std::shared_ptr<const mesh::MipMaps> maps_;
    bool has_highlights_ = false;
    prt::GgxForm form_ = prt::GgxForm::Published;
    /// [num_vertices], 1 / albedo; 0 where that is 0.
    std::vector<glm::vec3> light_of_radiance_;
};

/// Returns the harmonics of vertices times a factor each.
///
/// Shape:   harmonics is [num_vertices][coefficients], or empty.
[[nodiscard]] std::vector<glm::vec3> scaled(std::span<const glm::vec3> harmonics,
                                            std::span<const glm::vec3> factors);

/// Adds to the lobes of vertices what their radiance has beyond them, bounces above all, as diffuse
/// light; where a surface reflects none, as light of its own colour. The cosines are those of
/// reflect().
///
/// Shape:   all are [num_vertices].
void add_rest(std::span<const glm::vec3> radiance, std::span<const prt::Surface> surfaces,
              std::span<const prt::EyeCosines> eye_cosines, std::span<prt::Lobes<glm::vec3>> lobes);

} // namespace relumine::relight
