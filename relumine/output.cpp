#include "relumine/output.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "cubemap/resample/resample.h"
#include "files/extension.h"
#include "mesh/save.h"
#include "prt/receivers/mesh_point.h"
#include "relight/pictures/array_file.h"
#include "relight/pictures/exposure.h"
#include "relight/pictures/receiver_picture.h"
#include "relumine/lit_scene.h"

namespace relumine {

namespace {

bool is_picture(const std::string& extension) {
    return extension == ".png" || extension == ".exr";
}

/// Files whose values are computed with.
bool is_linear_data(const std::string& extension) {
    return extension == ".exr" || extension == ".npy";
}

/// Radiance is finite, but its product with albedo and exposure need not be.
void require_finite(const std::filesystem::path& path, std::span<const glm::vec3> values,
                    double exposure_ev = 0.0) {
    const double scale = std::exp2(exposure_ev);
    for (const glm::vec3& value : values)
        if (!(scale * std::max({value.r, value.g, value.b}) <= std::numeric_limits<float>::max()))
            throw std::runtime_error(
                fmt::format("{}: expected radiance times albedo and exposure within {}, got more",
                            path.string(), std::numeric_limits<float>::max()));
}

} // namespace

struct Painter::Impl {
    Impl(const LitScene& lit, const OutputOptions& given)
        : scene(lit.scene()), rays(lit.rays().of_mesh()), beams(lit.rays().for_moving_lights()),
          options(given), floor(picture_floor(scene, options)) {
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
                .on_progress = on_progress};
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
        const std::span<const glm::vec3> radiance = traces ? lighting.soft : lighting.radiance;
        const std::vector<glm::vec3> colors = shown_colors(radiance, lighting);
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
        if (traces) {
            light.lights = lighting.lights;
            light.blockers = &beams;
        }
        std::optional<relight::Reflections> reflections;
        std::vector<glm::vec3> mirrored;
        if (textures.has_mirrors() && options.highlight_rays != 0) {
            static const cubemap::CubeMap Black;
            reflections.emplace(rays, scene.settings.bias, options.highlight_rays,
                                lighting.environment == nullptr ? Black : *lighting.environment,
                                light.lights.first(traces ? lighting.num_environment_lights : 0));
            if (traces)
                mirrored = shown_colors(lighting.radiance, lighting);
            light.reflections = &*reflections;
            light.mirrored = traces ? mirrored : colors;
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

    /// Of vertices with textures and highlights; their radiance is given.
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
        if (lighting.environment == nullptr)
            return relight::plain_backdrop(glm::vec3(0.0f));
        if (const double blur = std::get<EnvironmentBehind>(options.background).blur_degrees;
            blur > 0.0)
            return relight::blurred_backdrop(lighting.behind(), blur);
        return lighting.sharp ? lighting.sharp : relight::map_backdrop(lighting.behind());
    }

    /// Of pixels, without added vertices; empty where all are opaque.
    [[nodiscard]] std::vector<glm::vec3> opacity(const Lighting& lighting) {
        std::vector<glm::vec3> result;
        const std::optional<glm::vec3> open = open_floor(scene, lighting, look(lighting), eye());
        if (floor.first_vertex >= scene.mesh.num_vertices() ||
            (!open && !(options.floor_fade > 0.0f)))
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
        return relight::compose(texels, colors, options.gutter);
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

    /// Adds what is seen of the mesh, and behind it, to the light meter. An added floor is no part
    /// of either. What is seen through the windows of a room does not count: it may burn out.
    void meter(const Lighting& lighting) {
        require_fit(scene, lighting.radiance);
        constexpr double ShareOfRooms = 0.85;
        const double share = is_on_vertices() ? meter_picture(lighting) : meter_receivers(lighting);
        if (share > ShareOfRooms || !prt::kind_of(scene.layout).are_seen ||
            !std::holds_alternative<EnvironmentBehind>(options.background) ||
            lighting.environment == nullptr)
            return;
        constexpr std::uint32_t Side = 64;
        const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
        const prt::PictureRays rays_behind(pixels != nullptr ? pixels->camera : camera(), Side,
                                           Side, 1);
        const relight::Backdrop behind = backdrop(lighting);
        for (std::uint32_t y = 0; y < Side; ++y)
            for (std::uint32_t x = 0; x < Side; ++x)
                metered_behind.push_back(behind(rays_behind.direction(x, y, 0)));
    }

    /// Returns the share of the picture that the mesh covers.
    double meter_receivers(const Lighting& lighting) {
        const std::vector<glm::vec3> colors = own_colors(lighting);
        const std::vector<bool> is_floor = floor_receivers(scene);
        const std::size_t before = metered_colors.size();
        for (std::size_t i = 0; i < colors.size(); ++i)
            if (is_floor.empty() || !is_floor[i]) {
                metered_colors.push_back(colors[i]);
                metered_weights.push_back(1.0f);
            }
        const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
        return pixels != nullptr ? static_cast<double>(metered_colors.size() - before) /
                                       static_cast<double>(pixels->num_samples())
                                 : 0.0;
    }

    /// Returns the share of the picture that the mesh covers.
    double meter_picture(const Lighting& lighting) {
        if (!small) {
            constexpr float Pixels = 256.0f * 192.0f;
            const float width = std::sqrt(Pixels * size().aspect());
            const auto side = [](float length) {
                return static_cast<std::uint32_t>(std::clamp(length, 1.0f, 4096.0f));
            };
            relight::FadingFloor gone = floor;
            gone.opaque_radius = gone.end_radius = -1.0f;
            small.emplace(scene.mesh, rays, camera(),
                          relight::PictureOptions{.width = side(width),
                                                  .height = side(width / size().aspect()),
                                                  .samples_per_axis = 1},
                          gone);
        }
        const Picture seen = drawn(*small, lighting, nullptr);
        double covered = 0.0;
        for (std::size_t i = 0; i < seen.pixels.size(); ++i)
            if (seen.alpha[i] > 0.0f) {
                metered_colors.push_back(seen.pixels[i] / seen.alpha[i]);
                metered_weights.push_back(seen.alpha[i]);
                covered += static_cast<double>(seen.alpha[i]);
            }
        return covered / static_cast<double>(seen.pixels.size());
    }

    double exposure(const Lighting& lighting) {
        if (options.exposure_ev)
            return *options.exposure_ev;
        if (!chosen_ev) {
            if (metered_colors.empty() && metered_behind.empty())
                meter(lighting);
            chosen_ev = static_cast<double>(
                relight::suitable_exposure_ev(metered_colors, metered_weights, metered_behind));
            metered_colors = metered_behind = {};
            metered_weights = {};
            small.reset();
        }
        return *chosen_ev;
    }

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
    /// Of vertices with textures: [num_triangles] factors on it.
    std::vector<glm::vec3> emission_gains;
    /// Null: the tone curve.
    std::unique_ptr<const relight::DisplayTransform> display =
        options.display.config.empty()
            ? nullptr
            : std::make_unique<const relight::DisplayTransform>(options.display);
    relight::FadingFloor floor;
    /// Of vertices.
    relight::SurfaceColors textures;
    std::vector<glm::vec3> shown;
    std::function<void(double)> on_progress;
    /// Made when a second picture is drawn
    std::optional<relight::PictureView> view;
    bool drew_one = false;
    /// The light meter's.
    std::optional<relight::PictureView> small;
    std::vector<glm::vec3> metered_colors, metered_behind;
    std::vector<float> metered_weights;
    std::optional<double> chosen_ev;
    std::optional<FloorLook> chosen_look;
    std::optional<Camera> chosen_camera;
};

Painter::Painter(const LitScene& lit, const OutputOptions& options)
    : impl_(std::make_unique<Impl>(lit, options)) {}
Painter::~Painter() = default;
Painter::Painter(Painter&&) noexcept = default;

void Painter::on_progress(std::function<void(double)> told) {
    impl_->on_progress = std::move(told);
}

Picture Painter::draw(const Lighting& lighting) {
    return impl_->draw(lighting);
}

std::vector<glm::vec3> Painter::values(std::span<const glm::vec3> radiance) const {
    return impl_->exposed(radiance, computed_albedo(impl_->scene, impl_->options),
                          impl_->options.exposure_ev.value_or(0.0));
}

void Painter::save(const std::filesystem::path& path, const Lighting& lighting) {
    const Scene& scene = impl_->scene;
    const std::string extension = files::extension_of(path);
    if (!is_output_of(path, scene))
        throw std::invalid_argument(
            fmt::format("{}: expected .png, .exr{} or .npy for a scene whose receivers are {}, got "
                        "'{}'",
                        path.string(), prt::on_vertices(scene.layout) ? ", .ply, .glb" : "",
                        prt::description(scene.layout), extension));
    if (is_picture(extension)) {
        const Picture picture = draw(lighting);
        relight::Development development{.exposure_ev = impl_->options.exposure_ev.value_or(0.0),
                                         .tone = impl_->options.tone,
                                         .display = impl_->display.get()};
        if (extension == ".exr")
            require_finite(path, picture.pixels, development.exposure_ev);
        else
            development.exposure_ev = impl_->exposure(lighting);
        relight::save_picture(path, picture, development);
        return;
    }
    const std::vector<glm::vec3> numbers =
        extension == ".npy"
            ? values(lighting.radiance)
            : impl_->exposed(lighting.radiance, impl_->shown_factors(), impl_->exposure(lighting));
    require_finite(path, numbers);
    if (extension == ".npy")
        relight::save_npy(path, numbers);
    else
        mesh::save(path, scene.mesh, numbers);
}

void Painter::meter(const Lighting& lighting) {
    if (!impl_->options.exposure_ev && !impl_->chosen_ev)
        impl_->meter(lighting);
}

double Painter::choose_exposure_ev(const Lighting& lighting) {
    return impl_->exposure(lighting);
}

void Painter::look_from(const Camera& camera) {
    impl_->chosen_camera = camera;
    impl_->view.reset();
    impl_->small.reset();
    impl_->drew_one = false;
}

void Painter::dim(std::vector<EmissionGain> gains) {
    impl_->options.emission = std::move(gains);
    impl_->take_emission();
}

void Painter::set_exposure_ev(double ev) {
    // Chosen for what is shown: numbers stay as they are.
    impl_->chosen_ev = ev;
}

bool Painter::needs_light_for(const std::filesystem::path& path) const {
    return !is_linear_data(files::extension_of(path)) && !impl_->options.exposure_ev &&
           !impl_->chosen_ev;
}

double Painter::exposure_ev(const std::filesystem::path& path) const {
    if (impl_->options.exposure_ev)
        return *impl_->options.exposure_ev;
    return is_linear_data(files::extension_of(path)) ? 0.0 : impl_->chosen_ev.value_or(0.0);
}

Picture draw(const LitScene& lit, const OutputOptions& options) {
    return Painter(lit, options).draw(lit.lighting());
}

void save(const LitScene& lit, const std::filesystem::path& path, const OutputOptions& options) {
    Painter(lit, options).save(path, lit.lighting());
}

bool is_output_of(const std::filesystem::path& path, const Scene& scene) {
    const std::string extension = files::extension_of(path);
    if (is_picture(extension) || extension == ".npy")
        return true;
    return prt::on_vertices(scene.layout) && (extension == ".ply" || extension == ".glb");
}

void save_map(const std::filesystem::path& path, const cubemap::CubeMap& map, double exposure_ev) {
    const cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, 4 * map.resolution, 2 * map.resolution);
    double white_ev = 0.0;
    if (files::extension_of(path) == ".png") {
        // One pixel in a thousand may be brighter than white: a sun must not leave the rest black.
        std::vector<float> brightness;
        for (const glm::vec3& pixel : image.pixels)
            brightness.push_back(std::max({pixel.r, pixel.g, pixel.b}));
        const auto white =
            brightness.end() - 1 - static_cast<std::ptrdiff_t>(brightness.size() / 1000);
        std::nth_element(brightness.begin(), white, brightness.end());
        white_ev = *white > 0.0f ? -std::log2(static_cast<double>(*white)) : 0.0;
    }
    relight::save_picture(path,
                          {.width = image.width, .height = image.height, .pixels = image.pixels},
                          {.exposure_ev = exposure_ev + white_ev});
}

} // namespace relumine
