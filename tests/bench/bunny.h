// The scene of the editing and video benchmarks.
#pragma once

#include <filesystem>

#include <fmt/format.h>

#include "cubemap/layers/light_layer.h"
#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/precompute.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::bench {

/// The Stanford bunny on a floor: from a .prt file where one is named, otherwise precomputed from
/// the data folder's mesh.
inline prt::Scene bunny(const std::filesystem::path& scene_file,
                        const std::filesystem::path& data) {
    if (!scene_file.empty())
        return prt::load_scene(scene_file);
    fmt::print(stderr, "precompute; name a finished one with --scene to save the time\n");
    prt::Scene scene;
    scene.mesh = mesh::load(data / "meshes/stanford/bun_zipper.ply");
    mesh::append_floor(scene.mesh);
    const prt::RayScene rays(scene.mesh);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    scene.settings.tolerance = prt::PrecomputeOptions{}.tolerance;
    scene.transfer =
        prt::precompute(prt::vertex_receivers(scene.mesh), rays, {.bias = scene.settings.bias});
    return scene;
}

/// The disc of the editing experiments; its radius is a part of the map's width. A face, a quarter
/// of the map's width around, spans 90 degrees.
inline cubemap::LightLayer disc(const glm::dvec3& direction, double part_of_face,
                                double intensity) {
    cubemap::LightLayer layer;
    layer.name = "disc";
    layer.region = cubemap::Disc{.direction = direction, .radius_degrees = 90.0 * part_of_face};
    layer.effect = cubemap::Emit{.radiance = glm::vec3(static_cast<float>(intensity))};
    return layer;
}

} // namespace relumine::bench
