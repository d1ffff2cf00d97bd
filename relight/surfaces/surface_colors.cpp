#include "relight/surfaces/surface_colors.h"

#include <algorithm>
#include <array>

#include "prt/glossy/brdf.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/texture_view.h"

namespace relumine::relight {

SurfaceColors::SurfaceColors(const mesh::TriangleMesh& mesh, std::span<const prt::Surface> surfaces,
                             bool has_highlights)
    : mesh_(&mesh), has_highlights_(has_highlights) {
    const auto is_whole = [](const prt::Surface& surface) {
        return surface.highlight == prt::Highlight::GgxWhole;
    };
    form_ = std::any_of(surfaces.begin(), surfaces.end(), is_whole) ? prt::GgxForm::Whole
                                                                    : prt::GgxForm::Published;
    const auto has_texture = [](const mesh::Material& material) {
        return material.base_color_texture || material.emission_texture ||
               material.normal_texture || material.diffuse_transmission > 0.0f;
    };
    const auto mirrors = [&](const mesh::Material& material) {
        return !has_highlights && prt::has_highlight(material);
    };
    if (mesh.triangle_materials.empty() || surfaces.size() != mesh.num_vertices())
        return;
    const auto marked = [&](const auto& is_marked) {
        std::vector<bool> result;
        if (std::any_of(mesh.materials.begin(), mesh.materials.end(), is_marked))
            for (const std::uint32_t material : mesh.triangle_materials)
                result.push_back(is_marked(mesh.materials[material]));
        return result;
    };
    is_textured_ = marked(has_texture);
    mirrors_ = marked(mirrors);
    if (is_textured_.empty() && mirrors_.empty())
        return;
    maps_ = std::make_shared<const mesh::MipMaps>(mesh.textures);
    for (const prt::Surface& surface : surfaces)
        light_of_radiance_.push_back(before_color(glm::vec3(1.0f), surface.albedo));
}

prt::Surface SurfaceColors::surface(const prt::MeshPoint& point,
                                    const prt::TextureView* view) const {
    const prt::Surface own =
        prt::surface_at(*mesh_, point.triangle, point.barycentric, form_, view);
    return has_highlights_ ? own : prt::without_highlight(own);
}

prt::Surface SurfaceColors::mirror(const prt::MeshPoint& point,
                                   const prt::TextureView* view) const {
    return prt::surface_at(*mesh_, point.triangle, point.barycentric, prt::GgxForm::Whole, view);
}

glm::vec3 SurfaceColors::light(std::span<const glm::vec3> vertex_radiance,
                               const prt::MeshPoint& point, const glm::vec3& change) const {
    const mesh::Triangle& triangle = mesh_->triangles[point.triangle];
    const std::array<float, 3> weights = {1.0f - point.barycentric.x - point.barycentric.y,
                                          point.barycentric.x, point.barycentric.y};
    glm::vec3 light(0.0f);
    for (std::size_t corner = 0; corner < 3; ++corner)
        light += weights[corner] * vertex_radiance[triangle[corner]] *
                 light_of_radiance_[triangle[corner]];
    return glm::max(light + change, 0.0f);
}

glm::vec3 SurfaceColors::radiance(std::span<const glm::vec3> vertex_radiance,
                                  const prt::MeshPoint& point, const glm::vec3& change,
                                  const prt::TextureView* view) const {
    return light(vertex_radiance, point, change) * surface(point, view).albedo;
}

std::vector<glm::vec3> scaled(std::span<const glm::vec3> harmonics,
                              std::span<const glm::vec3> factors) {
    std::vector<glm::vec3> result(harmonics.begin(), harmonics.end());
    const std::size_t count = harmonics.size() / std::max<std::size_t>(factors.size(), 1);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] *= factors[i / count];
    return result;
}

void add_rest(std::span<const glm::vec3> radiance, std::span<const prt::Surface> surfaces,
              std::span<const prt::EyeCosines> eye_cosines,
              std::span<prt::Lobes<glm::vec3>> lobes) {
    constexpr float LeastDiffuse = 0.02f;
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        const glm::vec3 rest = radiance[i] - prt::reflect(surfaces[i], lobes[i], eye_cosines[i]);
        const glm::vec3 share =
            prt::reflect(surfaces[i], {.diffuse = glm::vec3(1.0f)}, eye_cosines[i]);
        for (int channel = 0; channel < 3; ++channel)
            if (share[channel] > LeastDiffuse)
                lobes[i].diffuse[channel] += rest[channel] / share[channel];
            else {
                // What Fresnel makes white is a part of the highlight.
                lobes[i].specular[channel] += rest[channel];
                lobes[i].specular_grazing[channel] += rest[channel];
                if (prt::has_lobes_of_colors(surfaces[i]))
                    lobes[i].diffuse_grazing[channel] += rest[channel];
            }
    }
}

} // namespace relumine::relight
