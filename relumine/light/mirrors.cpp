#include "relumine/light/mirrors.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/twin_triangles.h"
#include "relight/surfaces/highlight_rays.h"
#include "relight/surfaces/mirrors.h"

namespace relumine {

namespace {

/// What rays see of the surfaces that they meet.
class MirroredSurfaces {
public:
    MirroredSurfaces(const Scene& scene, const relight::Reflections& reflections,
                     const SceneMirrors::Surfaces& surfaces)
        : mesh_(scene.mesh), reflections_(reflections), twins_(scene.mesh),
          gains_(scene.lamps.empty() ? std::vector<glm::vec3>()
                                     : triangle_gains(scene, surfaces.emission)) {
        for (const mesh::Material& material : mesh_.materials) {
            has_highlight_.push_back(prt::has_highlight(material));
            has_own_color_.push_back(material.base_color_texture || material.emission_texture ||
                                     has_highlight_.back());
        }
        const prt::Receivers& receivers = scene.receivers;
        if (surfaces.radiance.empty() || receivers.num_added == 0)
            return;
        light_.resize(mesh_.num_vertices(), glm::vec3(0.0f));
        sent_.resize(mesh_.num_vertices(), glm::vec3(0.0f));
        emission_.resize(mesh_.num_vertices(), glm::vec3(0.0f));
        for (std::size_t i = receivers.num_own(); i < receivers.size(); ++i) {
            const prt::Surface& surface = receivers.surfaces[i];
            const glm::vec3 albedo = glm::max(surface.albedo, 1e-4f);
            const std::uint32_t vertex = prt::vertex_at(mesh_, receivers.points[i]);
            light_[vertex] = surfaces.radiance[i] / albedo;
            sent_[vertex] = surfaces.albedo.empty() ? surfaces.radiance[i]
                                                    : light_[vertex] * surfaces.albedo[i];
            emission_[vertex] = surface.emission;
        }
    }

    /// Returns the radiance of a surface that a ray meets, as relight::Reflections asks for it.
    [[nodiscard]] glm::vec3 radiance(const relight::MetSurface& met) const {
        const prt::MeshPoint at = point_of(met);
        if (!has_highlight(at))
            return matte(at);
        const prt::Surface surface =
            prt::surface_at(mesh_, at.triangle, at.barycentric, prt::GgxForm::Whole);
        return relight::seen_in_mirror(
                   reflections_, met, {mesh_, at, surface, diffuse(at)},
                   [this](const relight::MetSurface& behind) { return radiance(behind); }) +
               gain(at) * surface.emission;
    }

private:
    [[nodiscard]] prt::MeshPoint point_of(const relight::MetSurface& met) const {
        const prt::Hit facing = twins_.facing(met.hit, met.direction);
        return {.triangle = facing.triangle, .barycentric = facing.barycentric};
    }
    [[nodiscard]] bool has_highlight(const prt::MeshPoint& at) const {
        return !mesh_.triangle_materials.empty() &&
               has_highlight_[mesh_.triangle_materials[at.triangle]];
    }
    [[nodiscard]] glm::vec3 gain(const prt::MeshPoint& at) const {
        return gains_.empty() ? glm::vec3(1.0f) : gains_[at.triangle];
    }
    /// What arrives, as radiance of albedo 1.
    [[nodiscard]] glm::vec3 diffuse(const prt::MeshPoint& at) const {
        return light_.empty() ? glm::vec3(0.0f) : prt::value_at(mesh_, light_, at);
    }
    /// radiance() of what mirrors nothing.
    [[nodiscard]] glm::vec3 matte(const prt::MeshPoint& at) const {
        if (mesh_.triangle_materials.empty() ||
            !has_own_color_[mesh_.triangle_materials[at.triangle]])
            return light_.empty() ? glm::vec3(0.0f)
                                  : prt::value_at(mesh_, sent_, at) +
                                        gain(at) * prt::value_at(mesh_, emission_, at);
        const prt::Surface surface = prt::without_highlight(
            prt::surface_at(mesh_, at.triangle, at.barycentric, prt::GgxForm::Published));
        return surface.albedo * diffuse(at) + gain(at) * surface.emission;
    }

    const mesh::TriangleMesh& mesh_;
    const relight::Reflections& reflections_;
    prt::TwinTriangles twins_;
    std::vector<glm::vec3> gains_;
    /// Whether the materials know their colours; others have those of the vertices.
    std::vector<bool> has_own_color_;
    /// Whether they have a highlight
    std::vector<bool> has_highlight_;
    /// [num_vertices] what arrives, as radiance of albedo 1, what is sent of it, and what glows;
    /// empty: unknown.
    std::vector<glm::vec3> light_, sent_, emission_;
};

} // namespace

SceneMirrors::SceneMirrors(const Scene& scene, const SceneRays& rays, std::uint32_t num_rays)
    : scene_(&scene), rays_(&rays) {
    if (!has_traced_highlights(scene))
        return;
    rays_per_pixel_ = num_rays;
}

std::uint32_t SceneMirrors::rays_of(std::size_t receiver) const {
    if (rays_per_pixel_ == 0)
        return 0;
    const auto* pixels = std::get_if<prt::PixelLayout>(&scene_->layout);
    const float shown = pixels == nullptr ? 1.0f
                                          : static_cast<float>(pixels->num_shown(receiver)) /
                                                static_cast<float>(pixels->samples_per_pixel());
    return relight::rays_of_receiver(scene_->receivers.surfaces[receiver], rays_per_pixel_, shown);
}

void SceneMirrors::add(const relight::Relighter& light, const Surfaces& surfaces,
                       std::span<const std::uint32_t> receivers,
                       std::span<glm::vec3> radiance) const {
    const prt::Receivers& all = scene_->receivers;
    const relight::Reflections reflections(rays_->of_mesh(), scene_->settings.bias, rays_per_pixel_,
                                           light.environment(), light.sharp_lights());
    const MirroredSurfaces mirrored(*scene_, reflections, surfaces);
    const auto seen = [&](const relight::MetSurface& met) {
        return mirrored.radiance(met);
    };
    files::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t i) {
        const std::uint32_t receiver = receivers[i];
        const prt::Surface& surface = all.surfaces[receiver];
        if (receiver >= all.num_own() || surface.highlight == prt::Highlight::None)
            return;
        const glm::vec3& normal = all.normals[receiver];
        const glm::vec3& to_eye = all.to_eye[receiver];
        const relight::MirrorPoint point{.position = all.positions[receiver],
                                         .normal = normal,
                                         .to_eye = to_eye,
                                         .shift = relight::ray_shift(receiver)};
        const prt::EyeCosines n_v(surface, normal, to_eye);
        const prt::Lobes<glm::vec3> lobes = relight::lobes_of(
            surface, reflections.light(surface, point, rays_of(receiver), seen), n_v);
        radiance[i] += prt::reflect(surface, lobes, n_v);
    });
}

} // namespace relumine
