#include "viewer/view_state.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "cubemap/environment.h"

namespace relumine::viewer {

namespace {

template<typename Work>
bool reported(ViewState& state, Work work) {
    try {
        state.message = work();
        state.message_is_error = false;
    } catch (const std::exception& error) {
        state.message = error.what();
        state.message_is_error = true;
    }
    return !state.message_is_error;
}

void set_environment(ViewState& state, const std::filesystem::path& path) {
    state.desk.set_base(state.load_environment(path));
    state.environment_path = path;
    state.heat_is_stale = true;
}

std::string open_layers(ViewState& state, const std::filesystem::path& path) {
    cubemap::LightLayers file = cubemap::load_layers(path);
    if (file.base)
        if (const std::filesystem::path base = path.parent_path() / *file.base;
            base.lexically_normal() != state.environment_path.lexically_normal())
            set_environment(state, base);
    state.desk.replace(std::move(file.layers));
    state.desk.select(std::nullopt);
    state.frames = std::move(file.frames);
    state.heat_is_stale = true;
    return fmt::format("{}: {} layers", path.string(), state.desk.layers().size());
}

} // namespace

OrbitCamera camera_on_all(const mesh::TriangleMesh& mesh, const PixelRectangle& viewport) {
    return orbit_camera(relight::automatic_camera(
        mesh, {.width = static_cast<std::uint32_t>(std::max(viewport.width, 1)),
               .height = static_cast<std::uint32_t>(std::max(viewport.height, 1))}));
}

void click_mesh(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel) {
    const Ray ray = ray_through(state.camera, viewport, pixel);
    const std::optional<prt::Hit> hit = state.rays.closest_hit(ray.origin, ray.direction);
    state.receiver.reset();
    state.environment_look.heat = hit.has_value();
    if (!hit)
        return;
    const glm::vec3 weights(1.0f - hit->barycentric.x - hit->barycentric.y, hit->barycentric.x,
                            hit->barycentric.y);
    // The triangle's corner with the largest weight: the nearest, in all but needles of triangles.
    const int corner = weights.x >= weights.y && weights.x >= weights.z ? 0 : weights.y >= weights.z ? 1 : 2;
    state.receiver = state.mesh.triangles[hit->triangle][static_cast<std::size_t>(corner)];
    state.heat_is_stale = true;
}

bool open(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&]() -> std::string {
        const std::string extension = path.extension().string();
        if (extension == ".json")
            return open_layers(state, path);
        if (extension != ".exr" && extension != ".hdr")
            throw std::runtime_error(
                fmt::format("{}: expected .exr, .hdr or .json, got '{}'", path.string(), extension));
        set_environment(state, path);
        return fmt::format("{}: {} texels a face", path.string(),
                           state.desk.editor().environment().resolution);
    });
}

bool save_layers(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&] {
        cubemap::LightLayers file{.layers = {state.desk.layers().begin(), state.desk.layers().end()},
                                  .frames = state.frames};
        if (!state.environment_path.empty())
            file.base = std::filesystem::absolute(state.environment_path)
                            .lexically_proximate(std::filesystem::absolute(path).parent_path());
        // Key frames of layers that are gone go with them.
        for (cubemap::KeyFrame& frame : file.frames)
            std::erase_if(frame.changes, [&](const auto& key) { return !state.desk.find(key.layer); });
        std::erase_if(file.frames, [](const auto& frame) { return frame.changes.empty(); });
        cubemap::save_layers(path, file);
        return fmt::format("{}: saved {} layers", path.string(), file.layers.size());
    });
}

bool save_environment(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&] {
        cubemap::save_environment(path, state.desk.editor().environment(), cubemap::Layout::LatLong);
        return fmt::format("{}: saved the environment with its layers", path.string());
    });
}

} // namespace relumine::viewer
