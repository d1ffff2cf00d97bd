// What is seen through glass that bends or spreads it, found by rays.
//
// Based on: KHR_materials_transmission, KHR_materials_volume, KHR_materials_dispersion; B. Walter
// et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007 (facets refract).
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/texture_view.h"
#include "prt/visibility/ray_scene.h"
#include "relight/surfaces/mirrors.h"

namespace relumine::relight {

/// Follows the eye's rays through bodies of glass (KHR_materials_volume), which refract them by
/// their index and take light on the way, and through rough sheets, which spread them. Where a body
/// parts colours, red, green and blue go ways of their own from there on. At each
/// surface a ray goes one way: on, or back where all of it is mirrored. What the inner side of a
/// surface mirrors beyond that leaves elsewhere, and is taken to go on, so glass loses no light. A
/// facet of rough glass that would send a ray against another facet gives way to others. The sky
/// behind is the mean over all that a sample sees of it, which bent glass spreads or narrows: a
/// window that falls between samples would else be a speck.
class Refractions {
public:
    /// All must outlive this object. Used where `light` has reflections.
    /// `view` says how far apart samples are.
    Refractions(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const MeshLight& light,
                const Mirrors& mirrors, const prt::TextureView& view)
        : mesh_(mesh), rays_(rays), light_(light), mirrors_(mirrors), view_(view) {}

    /// Whether what is behind a point is not simply seen straight on. Others are
    /// prt::RayScene::layers().
    [[nodiscard]] bool bends(const Mirror& mirror, const prt::MeshPoint& at) const;

    /// Returns the radiance that goes on through such a point to the eye. `sample` numbers the
    /// points of a pixel; `shift` is that of the pixel, as in MirrorPoint.
    ///
    /// Cost:    some three rays for each time that light enters glass and leaves it; of rough
    ///          glass, a quarter of the reflections' rays so often. Three times that where colours
    ///          part.
    [[nodiscard]] glm::vec3 light(const Mirror& mirror, const prt::MeshPoint& at,
                                  std::uint32_t sample, const glm::vec2& shift) const;

private:
    struct Ray;
    void begin_steps(Ray& ray, const glm::vec3& position, const glm::vec3& face) const;
    [[nodiscard]] glm::vec3 followed(Ray ray) const;
    [[nodiscard]] bool meet(Ray& ray, const prt::Hit& hit) const;
    [[nodiscard]] glm::vec3 sky(const Ray& ray) const;

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    const MeshLight& light_;
    const Mirrors& mirrors_;
    const prt::TextureView& view_;
};

} // namespace relumine::relight
