#include "relumine/in/receiver_placement.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "files/extension.h"
#include "mesh/floor.h"
#include "mesh/load.h"
#include "mesh/materials/material_members.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/lit_position.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/point_receivers.h"
#include "relight/pictures/array_file.h"
#include "relumine/in/precompute_table.h"
#include "relumine/in/stages.h"

namespace relumine {

namespace {

std::vector<glm::vec3> load_points(const std::filesystem::path& path, const glm::dvec3& offset) {
    if (files::extension_of(path) == ".ply")
        return mesh::load_points(path, offset);
    relight::VectorArray array = relight::load_npy(path);
    if (array.shape.size() != 1)
        throw std::runtime_error(fmt::format("{}: expected an array of [count, 3], got {} axes",
                                             path.string(), array.shape.size() + 1));
    return std::move(array.values);
}

class Placement {
public:
    Placement(Scene& scene, const PrecomputeOptions& options, const PrecomputeWork& work,
              const prt::RayScene& rays, const std::string& prefix,
              std::optional<std::uint32_t> lightmap_uvs, PrecomputeReport& report)
        : scene_(scene), options_(options), work_(work), rays_(rays), prefix_(prefix),
          lightmap_uvs_(lightmap_uvs), report_(report) {}

    void place() {
        const bool are_vertices = std::holds_alternative<Vertices>(options_.receivers);
        const bool adds_vertices = !are_vertices && options_.bounce_tolerance.value_or(0.0f) > 0.0f;
        if ((are_vertices || adds_vertices) && options_.blockers == nullptr)
            leave_obstacles_by_vertices();
        try {
            if (const auto* pixels = std::get_if<Pixels>(&options_.receivers)) {
                place_pixels(*pixels);
            } else if (const auto* texels = std::get_if<Texels>(&options_.receivers)) {
                place_texels(*texels);
            } else if (const auto* points = std::get_if<Points>(&options_.receivers)) {
                place_points(*points);
            } else if (const auto* grid = std::get_if<Grid>(&options_.receivers)) {
                place_grid(*grid);
            } else {
                scene_.receivers = prt::vertex_receivers(scene_.mesh);
            }
            // Receivers that are no pixels of the view but seen from it.
            if (options_.view && !std::holds_alternative<Pixels>(options_.receivers)) {
                const std::optional<PlacedCamera>& own = options_.view->camera;
                scene_.settings.view = own ? own->in(scene_.mesh) : camera_of(scene_);
                prt::look_from(scene_.receivers, scene_.settings.view->eye);
            }
            if (adds_vertices) {
                prt::add_vertices(scene_.receivers, scene_.mesh);
                note(work_, fmt::format("and {} vertices, from which light bounces",
                                        scene_.receivers.num_added));
            }
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(prefix_ + error.what());
        }
    }

private:
    /// What is seen from a point: the mesh, also where others block its light.
    const prt::RayScene& mesh_rays() {
        if (!scene_.blockers)
            return rays_;
        return own_rays_.emplace(ray_scene(scene_.mesh, prefix_));
    }
    /// What is seen from an eye: there is no gap between the mesh and its floor.
    const prt::RayScene& eye_rays(const glm::vec3& eye) {
        const std::size_t first = first_floor_vertex(scene_).value_or(scene_.mesh.num_vertices());
        const float gap = mesh::floor_gap(scene_.mesh, first);
        if (!(gap > 0.0f && eye.y > scene_.mesh.positions[first].y + gap))
            return mesh_rays();
        return own_rays_.emplace(
            ray_scene(mesh::with_raised_floor(scene_.mesh, first, gap), prefix_));
    }

    void leave_obstacles_by_vertices() {
        std::vector<glm::vec3> free = scene_.mesh.lifts;
        prt::leave_obstacles(rays_, scene_.settings.bias, scene_.mesh);
        const std::vector<glm::vec3>& lifts = scene_.mesh.lifts;
        // Where things move, what is in the way may go.
        for (std::size_t i = 0; i < free.size() && scene_.settings.is_movable; ++i)
            if (prt::free_lift(lifts.empty() ? glm::vec3(0.0f) : lifts[i],
                               scene_.mesh.normals[i]) != free[i]) {
                scene_.free_lifts = std::move(free);
                return;
            }
    }
    void leave_obstacles() {
        prt::leave_obstacles(scene_.mesh, rays_, scene_.settings.bias, scene_.receivers);
    }

    void place_points(const Points& points) {
        const std::string name = points.file.empty() ? "" : points.file.string() + ": ";
        std::vector<glm::vec3> of_file;
        if (!points.file.empty())
            of_file = load_points(points.file, scene_.mesh.offset);
        try {
            add_points(points.file.empty() ? points.positions : of_file);
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(name + error.what());
        }
        prt::PointLayout layout{.count = static_cast<std::uint32_t>(scene_.receivers.size())};
        layout.indices.resize(layout.count);
        std::iota(layout.indices.begin(), layout.indices.end(), 0u);
        scene_.layout = std::move(layout);
    }

    void place_grid(const Grid& grid) {
        check(grid);
        const std::size_t num_own = first_floor_vertex(scene_).value_or(scene_.mesh.num_vertices());
        const mesh::Bounds box =
            grid.box ? grid.box->in(scene_.mesh)
                     : mesh::bounds(std::span(scene_.mesh.positions).first(num_own));
        prt::GridLayout layout{
            .nx = grid.nx, .ny = grid.ny, .nz = grid.nz, .low = box.min, .high = box.max};
        add_points(prt::grid_points(layout));
        layout.indices.resize(scene_.receivers.size());
        std::iota(layout.indices.begin(), layout.indices.end(), 0u);
        scene_.layout = std::move(layout);
    }

    void add_points(std::span<const glm::vec3> points) {
        const prt::Work work{.stop = work_.stop};
        scene_.receivers = prt::point_receivers(points, scene_.mesh, mesh_rays(), work);
        if (const std::size_t inside = prt::num_inside(scene_.receivers); inside != 0)
            note(work_,
                 fmt::format("{} of {} points lie inside of objects: they take the light of the "
                             "nearest point outside",
                             inside, points.size()));
    }

    void place_pixels(const Pixels& size) {
        const bool has_camera = options_.view && options_.view->camera;
        const prt::Camera camera = has_camera
                                       ? options_.view->camera->in(scene_.mesh)
                                       : camera_of(scene_, static_cast<float>(size.width) /
                                                               static_cast<float>(size.height));
        prt::PixelReceivers pixels =
            prt::pixel_receivers(scene_.mesh, eye_rays(camera.eye),
                                 {.camera = camera,
                                  .width = size.width,
                                  .height = size.height,
                                  .samples_per_axis = size.samples_per_axis},
                                 work_.of(Stage::Receivers));
        scene_.receivers = std::move(pixels.receivers);
        leave_obstacles();
        scene_.layout = std::move(pixels.layout);
        note(work_, fmt::format("{}: {} samples hit the mesh", prt::description(scene_.layout),
                                scene_.receivers.size()));
    }

    /// Second uvs that are an unwrap were made for a lightmap.
    prt::TexelReceivers texels_of(const prt::AtlasSize& size) {
        if (lightmap_uvs_)
            return prt::texel_receivers(scene_.mesh, size, *lightmap_uvs_);
        if (!scene_.mesh.second_uvs.empty()) {
            prt::TexelReceivers second = prt::texel_receivers(scene_.mesh, size, 1);
            if (second.report.num_outside == 0 && second.report.num_overlapping == 0) {
                report_.takes_second_uvs = true;
                return second;
            }
        }
        return prt::texel_receivers(scene_.mesh, size);
    }

    void place_texels(const Texels& size) {
        prt::TexelReceivers texels = texels_of({.width = size.width, .height = size.height});
        const prt::AtlasReport& atlas = texels.report;
        if (atlas.num_overlapping > 0)
            warn(work_, Warning::ChartsOverlap,
                 fmt::format("{} texels lie in several triangles, the first at column {}, row {}: "
                             "charts overlap, the first triangle of the mesh wins",
                             atlas.num_overlapping, atlas.first_overlap % size.width,
                             atlas.first_overlap / size.width));
        if (atlas.num_outside > 0)
            warn(work_, Warning::UvsOutside,
                 fmt::format("{} triangles have uvs outside of 0 to 1: cut off there",
                             atlas.num_outside));
        if (atlas.num_flat > 0)
            note(work_,
                 fmt::format("{} triangles have no area in uv and get no texels", atlas.num_flat));
        report_.atlas = atlas;
        scene_.receivers = std::move(texels.receivers);
        leave_obstacles();
        scene_.layout = std::move(texels.layout);
    }

    Scene& scene_;
    const PrecomputeOptions& options_;
    const PrecomputeWork& work_;
    const prt::RayScene& rays_;
    const std::string& prefix_;
    std::optional<std::uint32_t> lightmap_uvs_;
    PrecomputeReport& report_;
    std::optional<prt::RayScene> own_rays_;
};

} // namespace

void place_receivers(Scene& scene, const PrecomputeOptions& options, const PrecomputeWork& work,
                     const prt::RayScene& rays, const std::string& prefix,
                     std::optional<std::uint32_t> lightmap_uvs, PrecomputeReport& report) {
    Placement(scene, options, work, rays, prefix, lightmap_uvs, report).place();
    const auto is_used = [](const mesh::Material& material) {
        return std::any_of(mesh::MaterialMembers.begin(), mesh::MaterialMembers.end(),
                           [&](const mesh::MaterialMember& member) {
                               const auto slot = member.texture();
                               return slot != nullptr && material.*slot &&
                                      (material.*slot)->uv_set == 1;
                           });
    };
    if (std::none_of(scene.mesh.materials.begin(), scene.mesh.materials.end(), is_used))
        scene.mesh.second_uvs.clear();
}

} // namespace relumine
