#include "relumine/out/floor_picture.h"

#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "cubemap/layers/layer_composite.h"
#include "mesh/floor.h"
#include "mesh/triangle_mesh.h"

namespace relumine {

relight::FadingFloor picture_floor(const Scene& scene) {
    // The outer part of the radius over which the floor fades into the background.
    constexpr float Fade = 0.6f;
    const std::optional<std::size_t> first = first_floor_vertex(scene);
    if (!first)
        return {};
    const mesh::Bounds floor = mesh::bounds(std::span(scene.mesh.positions).subspan(*first));
    const float half_side = 0.5f * (floor.max.x - floor.min.x);
    return {.first_vertex = static_cast<std::uint32_t>(*first),
            .center = 0.5f * glm::vec2(floor.min.x + floor.max.x, floor.min.z + floor.max.z),
            .opaque_radius = (1.0f - Fade) * half_side,
            .end_radius = half_side,
            .gap = mesh::floor_gap(scene.mesh, *first)};
}

relight::Ground picture_ground(const Scene& scene, const OutputOptions& options) {
    constexpr double Reach = 20.0; // heights: what stands farther away is upright
    const std::span<const glm::vec3> positions = scene.mesh.positions;
    const std::optional<std::size_t> first = first_floor_vertex(scene);
    if (!first)
        throw std::invalid_argument("expected a scene with a floor");
    const mesh::Bounds floor = mesh::bounds(positions.subspan(*first));
    // The added floor is the lowest plane, so what stands on it is the mesh.
    const glm::vec3 size = relight::subject_bounds(scene.mesh).size();
    const auto height =
        static_cast<double>(options.photo_height.value_or(std::max({size.x, size.y, size.z})));
    return {.camera = {floor.center().x, double{floor.max.y} + height, floor.center().z},
            .height = height,
            .reach = Reach * height};
}

FloorLook floor_look(const Scene& scene, const Lighting& lighting, const OutputOptions& options) {
    const std::vector<bool> is_floor = floor_receivers(scene);
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    // A floor with a surface of its own is to be seen.
    for (std::size_t i = 0; i < is_floor.size(); ++i)
        if (is_floor[i] && !surfaces.empty() && !(surfaces[i] == prt::Surface()))
            return FloorLook::Grey;
    const bool is_colored = std::holds_alternative<glm::vec3>(options.background);
    if (is_floor.empty() || !lighting.open_floor ||
        (!is_colored && lighting.environment == nullptr))
        return FloorLook::Grey;
    if (options.floor != FloorLook::Automatic)
        return options.floor;
    return is_colored || relight::has_ground(lighting.behind(), *lighting.open_floor)
               ? FloorLook::Photo
               : FloorLook::Studio;
}

std::optional<glm::vec3> open_floor(const Scene& scene, const Lighting& lighting, FloorLook look,
                                    const glm::vec3& eye) {
    if (look == FloorLook::Grey)
        return std::nullopt;
    return eye.y > scene.mesh.positions[*first_floor_vertex(scene)].y ? lighting.open_floor
                                                                      : glm::vec3(0.0f);
}

glm::vec3 studio_color(const Lighting& lighting, const OutputOptions& options) {
    return lighting.open_floor.value_or(glm::vec3(0.0f)) *
           options.floor_albedo.value_or(glm::vec3(FloorAlbedo));
}

namespace {

/// Shows what layers and added lights make of the ground in a photograph, as of the floor on it.
/// Where a layer lies over the ground itself, what it makes of that is seen already.
relight::Backdrop relit_ground(relight::Backdrop photograph, const Lighting& lighting) {
    constexpr std::uint32_t Resolution = 64;
    constexpr float Horizon = 0.1f; // sine of the depth at which all is ground
    const LightState& state = *lighting.state;
    auto gains = std::make_shared<cubemap::CubeMap>(Resolution, lighting.open_gain);
    for (const cubemap::LightLayer& layer : state.layers) {
        if (!layer.on || !layer.camera)
            continue;
        const std::vector<float> covered = cubemap::coverage_map(layer.region, Resolution);
        for (std::size_t i = 0; i < covered.size(); ++i)
            gains->texels[i] = glm::mix(gains->texels[i], glm::vec3(1.0f), covered[i]);
    }
    const glm::mat3 to_layers(glm::transpose(cubemap::turn_about_y(state.rotation_degrees)));
    return [photograph = std::move(photograph), gains, to_layers,
            gain = relight::map_backdrop(*gains)](const glm::vec3& direction) {
        const glm::vec3 seen = photograph(direction);
        if (!(direction.y < 0.0f))
            return seen;
        return seen * glm::mix(glm::vec3(1.0f), gain(to_layers * direction),
                               glm::smoothstep(0.0f, Horizon, -direction.y));
    };
}

} // namespace

relight::Backdrop on_floor(relight::Backdrop backdrop, const Scene& scene, const Lighting& lighting,
                           FloorLook look, const glm::vec3& eye, const OutputOptions& options) {
    if (look == FloorLook::Grey)
        return backdrop;
    const relight::Ground ground = picture_ground(scene, options);
    if (look == FloorLook::Studio)
        return relight::sweep_backdrop(std::move(backdrop), studio_color(lighting, options), ground,
                                       eye);
    constexpr float Visible = 1e-3f;
    if (lighting.state != nullptr && !cubemap::has_solo(lighting.state->layers) &&
        std::holds_alternative<EnvironmentBehind>(options.background) &&
        glm::any(glm::greaterThan(glm::abs(lighting.open_gain - 1.0f), glm::vec3(Visible))))
        backdrop = relit_ground(std::move(backdrop), lighting);
    return relight::grounded_backdrop(std::move(backdrop), ground, eye);
}

} // namespace relumine
