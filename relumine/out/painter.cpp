#include "relumine/out/output.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "cubemap/resample/resample.h"
#include "files/extension.h"
#include "mesh/save.h"
#include "relight/pictures/array_file.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/painter_impl.h"

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
        mesh::save_lit(path, scene.mesh, numbers);
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
    keep_guide(false);
    impl_->view.reset();
    impl_->small.reset();
    impl_->drew_one = false;
}

void Painter::dim(std::vector<EmissionGain> gains) {
    impl_->options.emission = std::move(gains);
    impl_->take_emission();
}

void Painter::keep_guide(bool is_kept) {
    impl_->guide.reset();
    if (is_kept)
        impl_->guide.emplace();
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
