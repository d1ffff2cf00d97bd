// The scene of the editing and video benchmarks.
#pragma once

#include <filesystem>

#include <fmt/format.h>

#include "mesh/floor.h"
#include "mesh/load.h"
#include "prt/precompute.h"
#include "prt/ray_scene.h"
#include "prt/scene_file.h"

namespace relumine::bench {

/// The Stanford bunny on a floor: from a .prt file where one is named, otherwise precomputed from the data folder's mesh.
inline prt::Scene bunny(const std::filesystem::path& scene_file, const std::filesystem::path& data) {
    if (!scene_file.empty())
        return prt::load_scene(scene_file);
    fmt::print(stderr, "precompute; name a finished one with --scene to save the time\n");
    prt::Scene scene;
    scene.mesh = mesh::load(data / "meshes/stanford/bun_zipper.ply");
    mesh::append_floor(scene.mesh);
    const prt::RayScene rays(scene.mesh);
    scene.settings.bias = prt::automatic_bias(scene.mesh);
    scene.settings.tolerance = prt::PrecomputeOptions{}.tolerance;
    scene.transfer = prt::precompute(prt::vertex_receivers(scene.mesh), rays, {.bias = scene.settings.bias});
    return scene;
}

} // namespace relumine::bench
