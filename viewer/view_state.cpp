#include "viewer/view_state.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "relumine/in/environment_files.h"
#include "relumine/light/layer_compositor.h"
#include "relumine/light/layers.h"
#include "relumine/out/pictures.h"

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

/// Sets the environment; this is not a step of undo yet.
void set_environment(ViewState& state, const std::filesystem::path& path) {
    set_base(state.desk, state.load_environment(path));
    state.heat_is_stale = true;
}

std::string open_layers(ViewState& state, const std::filesystem::path& path) {
    cubemap::LightLayers file = cubemap::load_layers(path);
    if (file.base)
        if (const std::filesystem::path base = path.parent_path() / *file.base;
            base.lexically_normal() != state.desk.state().base->path().lexically_normal())
            set_environment(state, base);
    // Layers may be saved to another folder than the one they came from.
    for (cubemap::LightLayer& layer : file.layers)
        if (auto* patch = std::get_if<cubemap::ImagePatch>(&layer.effect))
            patch->path =
                std::filesystem::absolute(path.parent_path() / patch->path).lexically_normal();
    if (file.rotate_degrees)
        set_rotation(state.desk, *file.rotate_degrees);
    replace(state.desk, std::move(file.layers));
    state.desk.select(std::nullopt);
    state.frames = std::move(file.frames);
    state.heat_is_stale = true;
    return fmt::format("{}: {} layers", path.string(), state.desk.layers().size());
}

} // namespace

relight::Backdrop backdrop_of(const ViewState& state) {
    const LightState& light = state.desk.state();
    const relight::Backdrop& pixels = light.base->backdrop();
    if (pixels && light.layers.empty())
        return
            [sharp = pixels, unturned = glm::dmat3(cubemap::turn_about_y(-light.rotation_degrees))](
                const glm::vec3& w) {
                return sharp(glm::vec3(unturned * glm::dvec3(w)));
            };
    // A copy: the environment may change while the picture is drawn.
    auto now = seen_environment(light);
    if (!now)
        now = std::make_shared<const cubemap::CubeMap>(environment_of(state.desk.lit()));
    if (pixels && light.shows_base())
        return [now, base = light.base,
                edited = relight::edited_backdrop(pixels, *light.base->map(), *now)](
                   const glm::vec3& w) {
            return edited(w);
        };
    return [now](const glm::vec3& w) {
        return cubemap::sample(*now, w);
    };
}

OrbitCamera camera_on_all(const Scene& scene, const PixelRectangle& viewport,
                          OutputOptions options) {
    options.width = static_cast<std::uint32_t>(std::max(viewport.width, 1));
    options.height = static_cast<std::uint32_t>(std::max(viewport.height, 1));
    return orbit_camera(camera_of(scene, options));
}

void click_mesh(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel) {
    const Ray ray = ray_through(state.camera, viewport, pixel);
    const std::optional<prt::Hit> hit =
        state.rays.closest_hit(ray.origin, ray.direction, prt::RayOf::Eye);
    state.receiver.reset();
    state.environment_look.heat = false;
    if (!hit)
        return;
    const glm::vec3 weights(1.0f - hit->barycentric.x - hit->barycentric.y, hit->barycentric.x,
                            hit->barycentric.y);
    // The triangle's corner with the largest weight. It is the nearest one, except in very thin
    // triangles.
    const int corner = weights.x >= weights.y && weights.x >= weights.z ? 0
                       : weights.y >= weights.z                         ? 1
                                                                        : 2;
    const std::uint32_t vertex =
        state.mesh.triangles[hit->triangle][static_cast<std::size_t>(corner)];
    state.receiver = state.balls != nullptr ? state.balls->receiver_of(vertex) : vertex;
    state.environment_look.heat = state.receiver.has_value();
    state.heat_is_stale = true;
}

bool aim_light(ViewState& state, std::size_t layer, const PixelRectangle& viewport,
               const glm::vec2& pixel, Aim aim) {
    const Ray ray = ray_through(state.camera, viewport, pixel);
    const auto direction = light_direction(state.desk.lit(), ray.origin, ray.direction, aim);
    if (direction)
        move_middle(state.desk, layer, *direction);
    return direction.has_value();
}

void take_thing(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel) {
    reported(state, [&]() -> std::string {
        if (state.balls != nullptr)
            throw std::runtime_error("things are dragged in scenes of vertices");
        state.thing.begin(ray_through(state.camera, viewport, pixel));
        return state.thing.is_dragging() ? state.thing.step()->name : "";
    });
}

void drag_thing(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel,
                bool is_before_eye, double turn_degrees) {
    reported(state, [&]() -> std::string {
        const glm::vec3 normal =
            is_before_eye ? frame(state.camera, viewport).forward : glm::vec3(0.0f, 1.0f, 0.0f);
        state.thing.move_to(ray_through(state.camera, viewport, pixel), normal, turn_degrees);
        const std::optional<GroupStep>& step = state.thing.step();
        return step ? fmt::format("relumine move: {}={:.4g},{:.4g},{:.4g},{:.4g}", step->name,
                                  step->by.x, step->by.y, step->by.z, step->degrees)
                    : "";
    });
}

void drop_thing(ViewState& state) {
    state.thing.end();
    state.heat_is_stale = true;
}

bool open(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&]() -> std::string {
        if (path.extension() == ".json")
            return open_layers(state, path);
        if (!cubemap::is_environment_name(path))
            throw std::runtime_error(fmt::format("{}: expected {}, or layers (.json), got '{}'",
                                                 path.string(), cubemap::environment_extensions(),
                                                 path.extension().string()));
        set_environment(state, path);
        state.desk.finish();
        return fmt::format("{}: {} texels a face", path.string(),
                           environment_of(state.desk.lit()).resolution);
    });
}

bool drop(ViewState& state, const std::filesystem::path& path) {
    if (!cubemap::is_environment_name(path))
        return open(state, path);
    state.dropped = path;
    return true;
}

bool add_image(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&] {
        if (!cubemap::is_environment_name(path)) {
            state.wants_path = true;
            throw std::runtime_error(
                path.empty()
                    ? std::string("Which picture? Type its path (.exr, .hdr) below, or "
                                  "drop it on the window.")
                    : fmt::format("{}: expected {} for an image layer, got '{}'", path.string(),
                                  cubemap::environment_extensions(), path.extension().string()));
        }
        cubemap::ImagePatch patch{.path = std::filesystem::absolute(path).lexically_normal(),
                                  .picture = cubemap::load_image_pyramid(path)};
        const cubemap::Picture& full = patch.picture->levels().front();
        // Shaped as the picture's pixels, 40 degrees along its longer side.
        constexpr double DegreesPerRadian = 180.0 / std::numbers::pi;
        const double half = std::tan(20.0 / DegreesPerRadian);
        const double longer = std::max(full.width, full.height);
        const auto degrees = [&](double pixels) {
            return std::max(0.1, 2.0 * std::atan(half * pixels / longer) * DegreesPerRadian);
        };
        add(state.desk,
            {.name = path.stem().string(),
             .region = cubemap::Rectangle{.direction = turned(direction_at(state.lat_long.center),
                                                              -state.desk.state().rotation_degrees),
                                          .width_degrees = degrees(full.width),
                                          .height_degrees = degrees(full.height)},
             .effect = std::move(patch)});
        state.heat_is_stale = true;
        return fmt::format("{}: {} x {} pixels as a layer", path.string(), full.width, full.height);
    });
}

bool save_layers(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&] {
        cubemap::LightLayers file{.rotate_degrees = state.desk.state().rotation_degrees,
                                  .layers = state.desk.state().layers,
                                  .frames = state.frames};
        const std::filesystem::path folder =
            std::filesystem::absolute(path).lexically_normal().parent_path();
        const auto from_folder = [&](const std::filesystem::path& named) {
            return std::filesystem::absolute(named).lexically_normal().lexically_proximate(folder);
        };
        if (!state.desk.state().base->path().empty())
            file.base = from_folder(state.desk.state().base->path());
        for (cubemap::LightLayer& layer : file.layers)
            if (auto* patch = std::get_if<cubemap::ImagePatch>(&layer.effect))
                patch->path = from_folder(patch->path);
        // Removes the key frames of layers that are gone.
        for (cubemap::KeyFrame& frame : file.frames)
            std::erase_if(frame.changes,
                          [&](const auto& key) { return !find(state.desk, key.layer); });
        std::erase_if(file.frames, [](const auto& frame) { return frame.changes.empty(); });
        cubemap::save_layers(path, file);
        return fmt::format("{}: saved {} layers", path.string(), file.layers.size());
    });
}

bool save_environment(ViewState& state, const std::filesystem::path& path) {
    return reported(state, [&] {
        cubemap::save_environment(path, environment_of(state.desk.lit()), cubemap::Layout::LatLong);
        return fmt::format("{}: saved the environment with its layers", path.string());
    });
}

bool save_picture(ViewState& state, const PixelRectangle& viewport,
                  const std::filesystem::path& path) {
    return reported(state, [&] {
        const bool is_linear = path.extension() == ".exr";
        if (!is_linear && path.extension() != ".png")
            throw std::runtime_error(fmt::format("{}: expected .png or .exr for a picture, got "
                                                 "'{}'",
                                                 path.string(), path.extension().string()));
        if (state.balls != nullptr)
            throw std::runtime_error("pictures are saved of scenes of vertices; `view -o` keeps "
                                     "what the window shows of points");
        OutputOptions options = state.picture;
        options.camera = picture_camera(state.camera);
        options.width = static_cast<std::uint32_t>(std::max(viewport.width, 1));
        options.height = static_cast<std::uint32_t>(std::max(viewport.height, 1));
        options.exposure_ev = is_linear ? 0.0 : static_cast<double>(state.scene_look.exposure_ev);
        options.tone = state.scene_look.tone;
        if (!state.scene_look.background)
            options.background = NothingBehind{};
        state.desk.bounce(true);
        Painter(state.desk.lit(), options).save(path, state.desk.lit().lighting());
        return fmt::format("{}: {} x {} pixels", path.string(), options.width, options.height);
    });
}

std::filesystem::path new_picture(const ViewState& state) {
    std::filesystem::path named(state.path);
    if ((named.extension() == ".png" || named.extension() == ".exr") &&
        !std::filesystem::exists(named))
        return named;
    for (int number = 1;; ++number)
        if (const auto path = fmt::format("picture-{}.png", number); !std::filesystem::exists(path))
            return path;
}

} // namespace relumine::viewer
