#include "relumine/in/scene.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/opacity.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/tolerance.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/options/option_table.h"

namespace relumine {

Scene unclustered_scene(Mesh mesh) {
    Scene scene;
    scene.mesh = std::move(mesh.geometry);
    scene.blockers = std::move(mesh.blockers);
    scene.receivers = prt::vertex_receivers(scene.mesh);
    scene.settings.camera = mesh.camera;
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    scene.lamps = prt::lamps_of(scene.mesh);
    return scene;
}

float rms_tolerance(const Scene& scene) {
    return prt::rms_tolerance(scene.settings.tolerance, scene.settings.epsilon,
                              scene.transfer.num_receivers());
}

std::optional<std::size_t> first_floor_vertex(const Scene& scene) {
    const std::uint64_t n = scene.settings.floor_vertices;
    const std::uint64_t of_floor = n * n + scene.settings.floor_added;
    if (n < 2 || of_floor > scene.mesh.num_vertices())
        return std::nullopt;
    return scene.mesh.num_vertices() - static_cast<std::size_t>(of_floor);
}

std::vector<bool> floor_receivers(const Scene& scene) {
    const std::optional<std::size_t> first = first_floor_vertex(scene);
    std::vector<bool> result;
    if (!first)
        return result;
    const std::vector<prt::MeshPoint>& points = scene.receivers.points;
    for (std::size_t i = 0; i < scene.receivers.size(); ++i)
        result.push_back(i >= scene.receivers.num_points() &&
                         (points.empty() ? i : scene.mesh.triangles[points[i].triangle][0]) >=
                             *first);
    return result;
}

OptionTable options_of(SurfaceColors& o) {
    return {row<ColorText>("--surface-albedo", o.albedo,
                           "scenes with materials: albedo of all surfaces in place of the "
                           "precompute's, a number or R,G,B",
                           {.example = "0.25"}),
            row<ColorText>("--surface-specular", o.specular,
                           "scenes with highlights: their F0 (Ks) in place of the precompute's, a "
                           "number or R,G,B",
                           {.example = "0.25"}),
            row("--surface-roughness", o.roughness,
                "scenes whose highlights follow the eye: roughness of all GGX surfaces in place of "
                "the precompute's; a texture multiplies it",
                {.min = 0, .max = 1})};
}

OptionRow material_row(SurfaceColors& colors) {
    return row(
        "--material",
        [&colors](const std::string& text) {
            SurfaceColors read;
            for (const auto& [name, value] : named_texts(text, "albedo=A,f0=F,roughness=R", text)) {
                if (name == "albedo")
                    read.albedo = ColorText::read(value);
                else if (name == "f0")
                    read.specular = ColorText::read(value);
                else if (name == "roughness")
                    read.roughness = ValueText<float>::read(value);
                else
                    refuse_text("albedo, f0 or roughness", name);
            }
            if (read.roughness && !(*read.roughness >= 0.0f && *read.roughness <= 1.0f))
                refuse_text("a roughness from 0 to 1", text);
            colors = read;
        },
        "scenes with materials: albedo=A,f0=F,roughness=R (numbers or R,G,B; any of them) of all "
        "surfaces in place of the precompute's; a roughness is for highlights that follow the eye, "
        "and a texture multiplies it",
        {.type = "TEXT"});
}

bool has_ggx(const mesh::Material& material) {
    return prt::has_highlight(material) && material.model != mesh::MaterialModel::Phong &&
           material.model != mesh::MaterialModel::Measured;
}

namespace {

/// Whether a material has a highlight that follows the eye, and colours of its own for its diffuse
/// light and for its highlight.
bool is_live(const Scene& scene, const mesh::Material& material) {
    return scene.receivers.to_eye.empty() && prt::has_highlight(material) &&
           material.model == mesh::MaterialModel::SpecularGlossiness;
}

} // namespace

void set_roughness(Scene& scene, float roughness) {
    mesh::TriangleMesh& mesh = scene.mesh;
    if (!(roughness >= 0.0f && roughness <= 1.0f))
        throw std::invalid_argument(
            fmt::format("expected a roughness from 0 to 1, got {}", roughness));
    if (!scene.receivers.to_eye.empty())
        throw std::invalid_argument("expected highlights that follow the eye, got those of a fixed "
                                    "view, whose roughness is precomputed");
    if (std::none_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                     [&](std::uint32_t index) { return has_ggx(mesh.materials[index]); }))
        throw std::invalid_argument("expected surfaces with GGX highlights, got none");
    const std::size_t first_floor = first_floor_vertex(scene).value_or(mesh.num_vertices());
    const auto is_floor = [&](std::size_t triangle) {
        return mesh.triangles[triangle][0] >= first_floor;
    };
    // The floor keeps its material, where it shares one.
    std::vector<bool> is_of_floor(mesh.materials.size(), false);
    for (std::size_t i = 0; i < mesh.triangle_materials.size(); ++i)
        if (is_floor(i))
            is_of_floor[mesh.triangle_materials[i]] = true;
    for (std::size_t index = 0; index < is_of_floor.size(); ++index) {
        if (!has_ggx(mesh.materials[index]))
            continue;
        std::size_t changed = index;
        if (is_of_floor[index]) {
            changed = mesh.materials.size();
            mesh.materials.push_back(mesh.materials[index]);
            for (std::size_t i = 0; i < mesh.triangle_materials.size(); ++i)
                if (mesh.triangle_materials[i] == index && !is_floor(i))
                    mesh.triangle_materials[i] = static_cast<std::uint32_t>(changed);
        }
        mesh.materials[changed].roughness = roughness;
    }
}

void set_colors(Scene& scene, const SurfaceColors& colors) {
    if (scene.receivers.surfaces.empty())
        throw std::invalid_argument("expected a scene with materials, got one without");
    if (colors.roughness)
        set_roughness(scene, *colors.roughness);
    const std::vector<bool> is_floor = floor_receivers(scene);
    for (std::size_t i = 0; i < scene.receivers.size(); ++i) {
        if (!is_floor.empty() && is_floor[i])
            continue;
        prt::Surface& surface = scene.receivers.surfaces[i];
        surface.albedo = colors.albedo.value_or(surface.albedo);
        surface.specular = colors.specular.value_or(surface.specular);
    }
    if (colors.albedo) { // textures, too, give way to it
        for (mesh::Material& material : scene.mesh.materials)
            if (is_live(scene, material)) {
                material.base_color = *colors.albedo;
                material.base_color_texture.reset();
            } else {
                material = mesh::without_colors(material);
            }
    }
    if (colors.specular) {
        for (mesh::Material& material : scene.mesh.materials)
            if (is_live(scene, material)) {
                material.specular = *colors.specular;
                material.specular_texture.reset();
            }
    }
    prt::set_surfaces(scene.transfer, scene.receivers);
}

std::optional<Camera> own_camera(const Scene& scene, float aspect) {
    if (scene.settings.view)
        return scene.settings.view;
    if (scene.settings.camera)
        return scene.settings.camera;
    return relight::inside_room(scene.mesh, {.aspect = aspect});
}

Camera camera_of(const Scene& scene, float aspect) {
    const std::optional<Camera> own = own_camera(scene, aspect);
    return own ? *own : relight::framed_from_open_side(scene.mesh, {.aspect = aspect});
}

std::uint32_t nearest_receiver(const Scene& scene, const glm::vec3& position) {
    const std::vector<glm::vec3>& positions = scene.receivers.positions;
    const auto end = positions.begin() + static_cast<std::ptrdiff_t>(scene.receivers.num_own());
    const auto nearest =
        std::min_element(positions.begin(), end, [&](const auto& a, const auto& b) {
            return glm::dot(a - position, a - position) < glm::dot(b - position, b - position);
        });
    return static_cast<std::uint32_t>(nearest - positions.begin());
}

} // namespace relumine
