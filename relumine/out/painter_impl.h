// The inside of a Painter.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/pictures/display_transform.h"
#include "relight/pictures/gathered_light.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/receiver_picture.h"
#include "relight/surfaces/reflections.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/floor_picture.h"
#include "relumine/out/output.h"

namespace relumine {

struct Painter::Impl {
    Impl(const LitScene& lit, const OutputOptions& given)
        : scene(lit.scene()), rays(lit.rays().of_mesh()), beams(lit.rays().for_moving_lights()),
          options(given), floor(picture_floor(scene)) {
        take_emission();
        // The transfer of a scene that processes share has no highlights.
        if (is_on_vertices())
            textures = {scene.mesh, scene.receivers.surfaces,
                        scene.settings.glossy_tolerance.has_value()};
    }

    void take_emission() {
        require_lamps(scene, options.emission);
        emission = emission_of(scene, options.emission);
        if (is_on_vertices() && !emission.empty())
            emission_gains = triangle_gains(scene, options.emission);
    }

    [[nodiscard]] bool is_on_vertices() const { return prt::on_vertices(scene.layout); }

    /// The part of values of all receivers that pixels or texels show.
    [[nodiscard]] std::span<const glm::vec3> own(std::span<const glm::vec3> values) const {
        return values.first(scene.receivers.num_own());
    }

    /// What pixels or texels show.
    [[nodiscard]] std::vector<glm::vec3> own_colors(const Lighting& lighting) {
        std::vector<glm::vec3> colors = product(own(lighting.radiance), shown_factors());
        add_emission(emission, colors);
        return colors;
    }

    [[nodiscard]] relight::PictureOptions size() const {
        return {.width = options.width,
                .height = options.height,
                .samples_per_axis = options.samples_per_axis,
                .work = {.on_progress = on_progress}};
    }
    const Camera& camera() {
        if (!chosen_camera)
            chosen_camera = camera_of(scene, options);
        return *chosen_camera;
    }

    const std::vector<glm::vec3>& shown_factors() {
        if (shown.empty())
            shown = picture_albedo(scene, options);
        return shown;
    }

    /// A scene of vertices. Null: the mesh alone.
    [[nodiscard]] Picture drawn(const relight::PictureView& from, const Lighting& lighting,
                                const relight::Backdrop* behind) {
        const bool traces = options.sun == SunShadows::Pixels && !lighting.lights.empty();
        const std::span<const glm::vec3> radiance = traces ? lighting.soft : lighting.drawn();
        std::vector<glm::vec3> colors = shown_colors(radiance, lighting);
        const bool has_mirrors = textures.has_mirrors() && options.highlight_rays != 0;
        std::vector<glm::vec3> mirrored;
        if (has_mirrors)
            mirrored = traces ? shown_colors(lighting.drawn(), lighting) : colors;
        relight::MeshLight light{
            .radiance = colors, .emission = emission, .emission_gains = emission_gains};
        if (scene.settings.view)
            light.eye = scene.settings.view->eye;
        // The lobes are those of lights that are traced, or of no lights.
        std::vector<prt::Lobes<glm::vec3>> lobes;
        if (traces || lighting.lights.empty())
            lobes = shown_lobes(lighting, radiance);
        if (!lobes.empty() || !scene.settings.glossy_tolerance)
            light.textures = &textures;
        light.lobes = lobes;
        std::vector<glm::vec3> harmonics;
        if (light.textures != nullptr && (traces || lighting.lights.empty()))
            harmonics = relight::scaled(lighting.harmonics, shown_factors());
        light.harmonics = harmonics;
        light.open_floor = open_floor(scene, lighting, look(lighting), eye());
        light.surfaces = scene.receivers.surfaces;
        light.albedo = shown_factors();
        light.bias = scene.settings.bias;
        if (options.sun == SunShadows::Pixels && !lighting.floor_lights.empty()) {
            light.floor_lights = lighting.floor_lights;
            for (std::size_t i = 0; i < lighting.of_floor_lights.size(); ++i) {
                glm::vec3& color = colors[floor.first_vertex + i];
                const glm::vec3 own = lighting.of_floor_lights[i];
                color -= light.open_floor ? own : own * shown_factors()[floor.first_vertex + i];
                color = glm::max(color, 0.0f);
            }
        }
        if (traces)
            light.lights = lighting.lights;
        light.blockers = &beams;
        if (!lighting.sent.empty() && (traces || lighting.lights.empty())) {
            light.sent = lighting.sent;
            light.replaced = lighting.replaced;
            light.sends_from_backs = scene.settings.two_sided_bounces;
            light.guide = guide ? &*guide : nullptr;
        }
        std::optional<relight::Reflections> reflections;
        if (has_mirrors || !light.sent.empty()) {
            static const cubemap::CubeMap Black;
            reflections.emplace(rays, scene.settings.bias, options.highlight_rays,
                                lighting.environment == nullptr ? Black : *lighting.environment,
                                light.lights.first(traces ? lighting.num_environment_lights : 0));
            light.sky = &*reflections;
        }
        if (has_mirrors) {
            light.reflections = &*reflections;
            light.mirrored = mirrored;
            light.eye = eye();
        }
        return behind == nullptr ? from.cut_out(light) : from.draw(light, *behind);
    }

    /// The colours of vertices. A floor that catches shadows has its radiance for albedo 1.
    [[nodiscard]] std::vector<glm::vec3> shown_colors(std::span<const glm::vec3> radiance,
                                                      const Lighting& lighting) {
        std::vector<glm::vec3> colors = product(radiance, shown_factors());
        if (catches(lighting))
            std::copy(radiance.begin() + floor.first_vertex, radiance.end(),
                      colors.begin() + floor.first_vertex);
        return colors;
    }

    /// Returns the lobes of vertices with textures and highlights, given their radiance; else none.
    std::vector<prt::Lobes<glm::vec3>> shown_lobes(const Lighting& lighting,
                                                   std::span<const glm::vec3> radiance) {
        std::vector<prt::Lobes<glm::vec3>> lobes = lighting.lobes;
        if (lobes.empty())
            return lobes;
        relight::add_rest(radiance, scene.receivers.surfaces, prt::eye_cosines(scene.receivers),
                          lobes);
        for (std::size_t i = 0; i < lobes.size(); ++i)
            prt::multiply(lobes[i], shown_factors()[i]);
        return lobes;
    }

    /// Chosen by the first light, so that the frames of a movie agree.
    FloorLook look(const Lighting& lighting) {
        if (!chosen_look)
            chosen_look = floor_look(scene, lighting, options);
        return *chosen_look;
    }

    /// Whether the floor shows what is behind it, in its own light.
    bool catches(const Lighting& lighting) {
        return look(lighting) != FloorLook::Grey && lighting.open_floor;
    }

    glm::vec3 eye() {
        const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
        return pixels != nullptr ? pixels->camera.eye : camera().eye;
    }

    /// What is behind the mesh, and the ground.
    relight::Backdrop backdrop(const Lighting& lighting) {
        return on_floor(plain_view(lighting), scene, lighting, look(lighting), eye(), options);
    }

    [[nodiscard]] relight::Backdrop plain_view(const Lighting& lighting) const {
        if (const auto* color = std::get_if<glm::vec3>(&options.background))
            return relight::plain_backdrop(*color);
        if (lighting.environment == nullptr ||
            std::holds_alternative<NothingBehind>(options.background))
            return relight::plain_backdrop(glm::vec3(0.0f));
        if (const double blur = std::get<EnvironmentBehind>(options.background).blur_degrees;
            blur > 0.0)
            return relight::blurred_backdrop(lighting.behind(), blur);
        return lighting.sharp ? lighting.sharp : relight::map_backdrop(lighting.behind());
    }

    /// Returns the opacity of pixels, without added vertices; empty where all are opaque.
    [[nodiscard]] std::vector<glm::vec3> opacity(const Lighting& lighting) {
        std::vector<glm::vec3> result;
        const std::optional<glm::vec3> open = open_floor(scene, lighting, look(lighting), eye());
        if (floor.first_vertex >= scene.mesh.num_vertices())
            return result;
        const prt::Receivers& receivers = scene.receivers;
        result.assign(receivers.num_own(), glm::vec3(1.0f));
        for (std::size_t i = 0; i < result.size(); ++i) {
            if (!floor.has(scene.mesh.triangles[receivers.points[i].triangle]))
                continue;
            const float own = floor.opacity(receivers.positions[i]);
            result[i] =
                open ? 1.0f - relight::caught(lighting.radiance[i], *open, own) : glm::vec3(own);
        }
        return result;
    }

    // How each kind of receivers becomes a picture. Vertices are drawn().
    [[nodiscard]] Picture composed(const prt::VertexLayout&, std::span<const glm::vec3>,
                                   const Lighting&) const {
        throw std::logic_error("expected receivers with a place in a picture");
    }
    [[nodiscard]] Picture composed(const prt::PixelLayout& pixels,
                                   std::span<const glm::vec3> colors, const Lighting& lighting) {
        std::vector<glm::vec3> emitted(colors.begin(), colors.end());
        if (catches(lighting)) {
            const std::vector<bool> is_floor = floor_receivers(scene);
            for (std::size_t i = 0; i < emitted.size(); ++i)
                if (is_floor[i])
                    emitted[i] = glm::vec3(0.0f);
        }
        if (std::holds_alternative<NothingBehind>(options.background))
            return relight::compose_cut_out(pixels, emitted, opacity(lighting),
                                            scene.receivers.veils);
        return relight::compose(pixels, emitted, backdrop(lighting), opacity(lighting),
                                scene.receivers.veils);
    }
    [[nodiscard]] Picture composed(const prt::TexelLayout& texels,
                                   std::span<const glm::vec3> colors, const Lighting&) const {
        return relight::compose(texels, colors);
    }
    [[nodiscard]] Picture composed(const prt::PointLayout& points,
                                   std::span<const glm::vec3> colors, const Lighting&) const {
        return relight::compose_rows(points.grid(), colors);
    }
    [[nodiscard]] Picture composed(const prt::GridLayout& grid, std::span<const glm::vec3> colors,
                                   const Lighting&) const {
        return relight::compose_rows(grid.grid(), colors);
    }

    Picture draw(const Lighting& lighting) {
        require_fit(scene, lighting.radiance);
        const bool is_transparent = std::holds_alternative<NothingBehind>(options.background);
        if (is_on_vertices()) {
            // What one picture's rays hit need not be kept.
            const bool is_first = !std::exchange(drew_one, true);
            std::optional<relight::PictureView> once;
            if (is_first)
                once.emplace(scene.mesh, rays, camera(), size(), floor, 0);
            else if (!view)
                view.emplace(scene.mesh, rays, camera(), size(), floor);
            const relight::PictureView& used = is_first ? *once : *view;
            const relight::Backdrop behind = is_transparent ? nullptr : backdrop(lighting);
            return drawn(used, lighting, is_transparent ? nullptr : &behind);
        }
        const std::vector<glm::vec3> colors = own_colors(lighting);
        return std::visit([&](const auto& layout) { return composed(layout, colors, lighting); },
                          scene.layout);
    }

    // The light meter: painter_meter.cpp.

    /// Adds what is seen of the mesh, of its floor and behind them. What is seen through the
    /// windows of a room does not count: it may burn out.
    void meter(const Lighting& lighting);
    /// Returns the share of the picture that the mesh covers.
    double meter_picture(const Lighting& lighting);
    /// Meters pixels or texels, and returns the share of the picture that the mesh covers. Of the
    /// floor, what pixels see of its opaque part counts.
    double meter_receivers(const Lighting& lighting);
    /// Adds a point of the floor that is seen in a direction. Of a floor that shows what is behind
    /// it, `color` is what it makes of white: only where lamps brighten it is it more than a
    /// photograph.
    void meter_floor(const glm::vec3& color, const glm::vec3& direction,
                     const relight::Backdrop* behind);
    /// Returns the exposure that suits what was metered, or this light where nothing was.
    double exposure(const Lighting& lighting);
    /// Returns the exposure that makes white of a 4096th of a floor in the open. What is darker
    /// gets no light but what roundings let through.
    [[nodiscard]] double most_exposure(const Lighting& lighting) const;
    [[nodiscard]] relight::PictureOptions small_size() const;

    std::vector<glm::vec3> exposed(std::span<const glm::vec3> radiance,
                                   std::span<const glm::vec3> albedo, double ev) const {
        require_fit(scene, radiance);
        std::vector<glm::vec3> values = product(own(radiance), albedo);
        add_emission(emission, values);
        const auto scale = static_cast<float>(std::exp2(ev));
        for (glm::vec3& value : values)
            value *= scale;
        return values;
    }

    const Scene& scene;
    const prt::RayScene& rays;
    /// For the sun.
    const prt::Blockers& beams;
    OutputOptions options;
    /// [num_receivers] or empty: none.
    std::vector<glm::vec3> emission;
    /// [num_triangles] factors on the emission of vertices with textures.
    std::vector<glm::vec3> emission_gains;
    /// Null: the tone curve.
    std::unique_ptr<const relight::DisplayTransform> display =
        options.display.config.empty()
            ? nullptr
            : std::make_unique<const relight::DisplayTransform>(options.display);
    relight::FadingFloor floor;
    /// What the textures show, where receivers are vertices.
    relight::SurfaceColors textures;
    std::vector<glm::vec3> shown;
    std::function<void(double)> on_progress;
    /// Where rays look, for pictures that are to be added up.
    std::optional<relight::GatherGuide> guide;
    /// Made when a second picture is drawn
    std::optional<relight::PictureView> view;
    bool drew_one = false;
    /// The light meter's.
    std::optional<relight::PictureView> small;
    struct Metered {
        std::vector<glm::vec3> colors, behind, floor;
        /// [colors]
        std::vector<float> weights;
        /// The pixels of all pictures.
        double num_pixels = 0.0;
    } metered;
    std::optional<double> chosen_ev;
    std::optional<FloorLook> chosen_look;
    std::optional<Camera> chosen_camera;
};

} // namespace relumine
