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
#include "mesh/save.h"
#include "relight/pictures/array_file.h"
#include "relight/pictures/receiver_picture.h"
#include "relumine/lit_scene.h"

namespace relumine {

namespace {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

bool is_picture(const std::string& extension) {
    return extension == ".png" || extension == ".exr";
}

void require_fit(const Scene& scene, std::span<const glm::vec3> radiance) {
    if (radiance.size() != scene.receivers.size())
        throw std::invalid_argument(fmt::format("expected the radiance of {} receivers, got {}",
                                                scene.receivers.size(), radiance.size()));
}

} // namespace

std::vector<glm::vec3> colors_of(const Scene& scene, std::span<const glm::vec3> radiance,
                                 const Albedo& albedo) {
    require_fit(scene, radiance);
    std::vector<glm::vec3> result(radiance.begin(), radiance.end());
    if (const auto* factor = std::get_if<glm::vec3>(&albedo)) {
        for (glm::vec3& value : result)
            value *= *factor;
        return result;
    }
    const std::vector<glm::vec3> colors = prt::colors_at(scene.mesh, scene.receivers);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] *= colors[i];
    return result;
}

namespace {

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
    : scene_(lit.scene()), rays_(lit.rays()), options_(options) {
    if (std::holds_alternative<prt::VertexLayout>(scene_.layout) && !scene_.transfer.glossy)
        surface_colors_ = {scene_.mesh, scene_.receivers.surfaces};
}

Picture Painter::draw(std::span<const glm::vec3> radiance, const cubemap::CubeMap& environment) {
    const std::vector<glm::vec3> colors = colors_of(scene_, radiance, options_.albedo);
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene_.layout))
        return options_.transparent ? relight::compose_cut_out(*pixels, colors)
                                    : relight::compose(*pixels, colors, environment);
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene_.layout))
        return relight::compose(*texels, colors, options_.gutter);
    const relight::PictureOptions size{.width = options_.width,
                                       .height = options_.height,
                                       .samples_per_axis = options_.samples_per_axis};
    const Camera camera =
        options_.camera ? *options_.camera : camera_of(scene_, size, options_.fov_degrees);
    // What one picture's rays hit need not be kept.
    if (!std::exchange(drew_one_, true))
        return relight::draw(scene_.mesh, rays_, colors, environment, camera, size,
                             surface_colors_);
    if (!view_)
        view_ = std::make_unique<relight::PictureView>(scene_.mesh, rays_, camera, size);
    return view_->draw(colors, environment, surface_colors_);
}

std::vector<glm::vec3> Painter::values(std::span<const glm::vec3> radiance) const {
    std::vector<glm::vec3> values = colors_of(scene_, radiance, options_.albedo);
    const auto scale = static_cast<float>(std::exp2(options_.exposure_ev));
    for (glm::vec3& value : values)
        value *= scale;
    return values;
}

void Painter::save(const std::filesystem::path& path, std::span<const glm::vec3> radiance,
                   const cubemap::CubeMap& environment) {
    const std::string extension = extension_of(path);
    if (!is_output_of(path, scene_))
        throw std::invalid_argument(fmt::format(
            "{}: expected .png, .exr{} or .npy for a scene whose receivers are {}, got "
            "'{}'",
            path.string(),
            std::holds_alternative<prt::VertexLayout>(scene_.layout) ? ", .ply, .glb" : "",
            prt::description(scene_.layout), extension));
    if (is_picture(extension)) {
        const Picture picture = draw(radiance, environment);
        if (extension == ".exr")
            require_finite(path, picture.pixels, options_.exposure_ev);
        relight::save_picture(path, picture, options_.exposure_ev);
        return;
    }
    const std::vector<glm::vec3> numbers = values(radiance);
    require_finite(path, numbers);
    if (extension == ".npy")
        relight::save_npy(path, numbers);
    else
        mesh::save(path, scene_.mesh, numbers);
}

bool is_output_of(const std::filesystem::path& path, const Scene& scene) {
    const std::string extension = extension_of(path);
    if (is_picture(extension) || extension == ".npy")
        return true;
    return std::holds_alternative<prt::VertexLayout>(scene.layout) &&
           (extension == ".ply" || extension == ".glb");
}

void save_map(const std::filesystem::path& path, const cubemap::CubeMap& map, double exposure_ev) {
    const cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, 4 * map.resolution, 2 * map.resolution);
    double white_ev = 0.0;
    if (extension_of(path) == ".png") {
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
                          exposure_ev + white_ev);
}

} // namespace relumine
