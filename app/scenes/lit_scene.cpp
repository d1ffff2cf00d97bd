#include "app/scenes/lit_scene.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "app/scenes/first_scene.h"
#include "files/extension.h"
#include "relumine/in/environment.h"
#include "relumine/in/mesh_files.h"

namespace relumine::app {

void SceneOptions::add_to(Command& command) {
    command.add(row("SCENE", path,
                    "scene file from `relumine precompute`, or a mesh, which is precomputed first",
                    {.file = true, .required = true}));
    command.add_all(open_choices(mesh));
    command.add(row("--clusters-only", clusters_only,
                    "light the sun through its cluster too, without shadow rays of its own"));
    command.add(material_row(colors));
}

bool SceneOptions::is_first_picture() const {
    return mesh::has_mesh_extension(path) && !lights_alone;
}

namespace {

Scene load(const SceneOptions& options, Session& session) {
    if (!mesh::has_mesh_extension(options.path)) {
        if (options.mesh.pose || options.mesh.variant)
            throw UsageError(options.mesh.pose ? "--pose" : "--variant",
                             fmt::format("expected a mesh (.glb, .gltf), got {}, which has that of "
                                         "its precompute",
                                         options.path));
        return load_scene(options.path);
    }
    if (options.is_first_picture())
        return first_scene(options.path, options.mesh, options.before, session);
    if (options.clusters_only)
        throw std::runtime_error(fmt::format(
            "{}: expected a scene file with --clusters-only, got a mesh", options.path));
    return unclustered_scene(load_mesh(options.path, options.mesh));
}

void recolour(Scene& scene, const SceneOptions& options) {
    const SurfaceColors& colors = options.colors;
    if (!colors.albedo && !colors.specular && !colors.roughness)
        return;
    if (scene.receivers.surfaces.empty())
        throw UsageError(
            "--material",
            fmt::format("expected a scene with materials, got {} without", options.path));
    try {
        set_colors(scene, colors);
    } catch (const std::invalid_argument& error) {
        throw UsageError("--material", fmt::format("{}: {}", options.path, error.what()));
    }
}

LightOptions light_options(const SceneOptions& options, const Scene& scene) {
    return {.clusters_only = options.clusters_only,
            .harmonics = scene.receivers.num_points() != 0 && options.harmonics_of_points != 0
                             ? options.harmonics_of_points
                             : options.harmonics,
            .highlight_rays = options.highlight_rays,
            .path = options.path};
}

/// Errors about the mesh do not know its name.
template<typename Make>
auto naming_scene(const std::string& path, const Make& make) {
    try {
        return make();
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

} // namespace

void SceneOptions::check() const {
    if (cubemap::is_environment_name(path) || files::extension_of(path) == ".pic")
        throw UsageError("SCENE", fmt::format("expected a scene, got the environment {}: the scene "
                                              "stands first, the environment behind it",
                                              path));
    if (const std::string hint = mesh::hint_of_stage(path); !hint.empty())
        throw std::runtime_error(fmt::format("{}: expected a scene or a mesh, got '{}'{}", path,
                                             files::extension_of(path), hint));
}

LitScene lit_scene(const SceneOptions& options, Session& session) {
    options.check();
    if (session.team != nullptr && session.team->has_others()) {
        if (mesh::has_mesh_extension(options.path))
            throw std::runtime_error(fmt::format("{}: expected a scene for processes to share, got "
                                                 "a mesh: `relumine precompute` makes one",
                                                 options.path));
        prt::ScenePart part = prt::load_scene_part(options.path, session.team->part());
        recolour(part.scene, options);
        LightOptions light = light_options(options, part.scene);
        light.team = session.team;
        return LitScene(std::move(part), light);
    }
    Scene scene = load(options, session);
    recolour(scene, options);
    const LightOptions light = light_options(options, scene);
    return naming_scene(options.path, [&] { return LitScene(std::move(scene), light); });
}

} // namespace relumine::app
