#include "relight/pictures/picture.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"
#include "relight/pictures/png_file.h"

namespace relumine::relight {

namespace {

float aspect_of(const PictureOptions& options) {
    return static_cast<float>(options.width) / static_cast<float>(options.height);
}

/// Returns the box around the objects on the ground: triangles wholly in the lowest horizontal
/// plane are left out.
mesh::Bounds subject_bounds(const mesh::TriangleMesh& mesh) {
    const mesh::Bounds all = mesh::bounds(mesh);
    const float ground = all.min.y + 1e-3f * all.size().y;
    mesh::TriangleMesh subject;
    subject.positions = mesh.positions;
    for (const mesh::Triangle& triangle : mesh.triangles)
        if (std::any_of(triangle.begin(), triangle.end(),
                        [&](std::uint32_t v) { return mesh.positions[v].y > ground; }))
            subject.triangles.push_back(triangle);
    return subject.triangles.empty() ? all : mesh::bounds(subject);
}

std::uint8_t srgb_byte(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(encoded * 255.0f));
}

std::vector<std::byte> png_of(const Picture& picture, float scale) {
    const std::size_t num_channels = picture.alpha.empty() ? 3 : 4;
    std::vector<std::uint8_t> bytes(picture.pixels.size() * num_channels);
    tbb::parallel_for(std::uint32_t{0}, picture.height, [&](std::uint32_t y) {
        for (std::size_t i = std::size_t{y} * picture.width;
             i < (std::size_t{y} + 1) * picture.width; ++i) {
            // The colours of PNG are not multiplied by alpha.
            const float alpha =
                num_channels == 4 && picture.alpha[i] > 0.0f ? picture.alpha[i] : 1.0f;
            std::uint8_t* out = &bytes[i * num_channels];
            for (int channel = 0; channel < 3; ++channel)
                out[channel] = srgb_byte(picture.pixels[i][channel] / alpha * scale);
            if (num_channels == 4) // linear
                out[3] = static_cast<std::uint8_t>(
                    std::lround(std::clamp(picture.alpha[i], 0.0f, 1.0f) * 255.0f));
        }
    });
    return encode_png(picture.width, picture.height, num_channels, bytes);
}

} // namespace

Camera automatic_camera(const mesh::TriangleMesh& mesh, const PictureOptions& options,
                        float fov_degrees) {
    const mesh::Bounds box = subject_bounds(mesh);
    const glm::vec3 from_target = glm::normalize(glm::vec3(0.45f, 0.4f, 1.0f));
    // About the origin: far from it, floats could not hold so short a way from target to eye.
    const prt::CameraAxes frame =
        prt::axes_of({.eye = from_target, .fov_degrees = fov_degrees}, aspect_of(options));

    // Every corner of the box must lie within the picture's pyramid, with a margin of an eighth.
    constexpr float Margin = 1.125f;
    float distance = 1e-20f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 sign((corner & 1) != 0 ? 0.5f : -0.5f, (corner & 2) != 0 ? 0.5f : -0.5f,
                             (corner & 4) != 0 ? 0.5f : -0.5f);
        const glm::vec3 offset = sign * box.size();
        const float across =
            std::abs(glm::dot(offset, frame.right)) / glm::dot(frame.right, frame.right);
        const float upwards = std::abs(glm::dot(offset, frame.up)) / glm::dot(frame.up, frame.up);
        distance = std::max(distance,
                            Margin * std::max(across, upwards) - glm::dot(offset, frame.forward));
    }
    return {.eye = box.center() + distance * from_target,
            .target = box.center(),
            .fov_degrees = fov_degrees};
}

Picture draw(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
             std::span<const glm::vec3> vertex_radiance, const cubemap::CubeMap& background,
             const Camera& camera, const PictureOptions& options, const SurfaceColors& colors) {
    return PictureView(mesh, rays, camera, options, 0).draw(vertex_radiance, background, colors);
}

namespace {

prt::PictureRays rays_of(const Camera& camera, const PictureOptions& options) {
    return {camera, options.width, options.height, options.samples_per_axis};
}

constexpr std::uint32_t NoTriangle = ~std::uint32_t{0};

} // namespace

PictureView::PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                         const Camera& camera, const PictureOptions& options, std::size_t max_bytes)
    : mesh_(mesh), rays_(rays), camera_(camera), options_(options) {
    const prt::PictureRays grid = rays_of(camera, options);
    const std::size_t num_samples =
        std::size_t{options.width} * options.height * grid.samples_per_pixel();
    if (num_samples > max_bytes / sizeof(Sample))
        return;
    samples_.resize(num_samples);
    tbb::parallel_for(std::uint32_t{0}, options.height, [&](std::uint32_t y) {
        std::size_t index = std::size_t{y} * options.width * grid.samples_per_pixel();
        for (std::uint32_t x = 0; x < options.width; ++x)
            for (std::uint32_t i = 0; i < grid.samples_per_pixel(); ++i) {
                const std::optional<prt::Hit> hit =
                    rays.closest_hit(camera.eye, grid.direction(x, y, i));
                samples_[index++] =
                    hit ? Sample{hit->triangle, hit->barycentric.x, hit->barycentric.y}
                        : Sample{NoTriangle, 0.0f, 0.0f};
            }
    });
}

Picture PictureView::draw(std::span<const glm::vec3> vertex_radiance,
                          const cubemap::CubeMap& background, const SurfaceColors& colors) const {
    if (vertex_radiance.size() != mesh_.num_vertices())
        throw std::invalid_argument("expected one radiance per vertex");
    if (background.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    const prt::PictureRays grid = rays_of(camera_, options_);
    const auto seen = [&](std::uint32_t x, std::uint32_t y, std::uint32_t i, std::size_t index) {
        Sample sample{NoTriangle, 0.0f, 0.0f};
        if (!samples_.empty()) {
            sample = samples_[index];
        } else if (const auto hit = rays_.closest_hit(camera_.eye, grid.direction(x, y, i))) {
            sample = {hit->triangle, hit->barycentric.x, hit->barycentric.y};
        }
        if (sample.triangle == NoTriangle)
            return cubemap::sample(background, grid.direction(x, y, i));
        if (colors.has(sample.triangle))
            return colors.radiance(vertex_radiance, {.triangle = sample.triangle,
                                                     .barycentric = {sample.second, sample.third}});
        const mesh::Triangle& triangle = mesh_.triangles[sample.triangle];
        const float first = 1.0f - sample.second - sample.third;
        return first * vertex_radiance[triangle[0]] + sample.second * vertex_radiance[triangle[1]] +
               sample.third * vertex_radiance[triangle[2]];
    };

    Picture picture{.width = options_.width, .height = options_.height};
    picture.pixels.resize(std::size_t{options_.width} * options_.height);
    tbb::parallel_for(std::uint32_t{0}, options_.height, [&](std::uint32_t y) {
        std::size_t index = std::size_t{y} * options_.width * grid.samples_per_pixel();
        for (std::uint32_t x = 0; x < options_.width; ++x) {
            glm::vec3 sum(0.0f);
            for (std::uint32_t i = 0; i < grid.samples_per_pixel(); ++i)
                sum += seen(x, y, i, index++);
            picture.pixels[std::size_t{y} * options_.width + x] =
                sum / static_cast<float>(grid.samples_per_pixel());
        }
    });
    return picture;
}

void save_picture(const std::filesystem::path& path, const Picture& picture, double exposure_ev) {
    if (picture.pixels.empty() ||
        picture.pixels.size() != std::size_t{picture.width} * picture.height)
        throw std::invalid_argument(fmt::format("{}: expected {} x {} pixels, got {}",
                                                path.string(), picture.width, picture.height,
                                                picture.pixels.size()));
    if (!picture.alpha.empty() && picture.alpha.size() != picture.pixels.size())
        throw std::invalid_argument(fmt::format("{}: expected one alpha per pixel, got {} for {}",
                                                path.string(), picture.alpha.size(),
                                                picture.pixels.size()));
    const auto scale = static_cast<float>(std::exp2(exposure_ev));
    std::vector<std::byte> bytes;
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".png") {
        bytes = png_of(picture, scale);
    } else if (extension == ".exr") {
        cubemap::EnvironmentImage image;
        static_cast<Picture&>(image) = picture;
        for (glm::vec3& pixel : image.pixels)
            pixel *= scale;
        bytes = cubemap::encode_exr(image);
    } else {
        throw std::invalid_argument(fmt::format("{}: expected .png or .exr, got '{}'",
                                                path.string(), path.extension().string()));
    }
    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

} // namespace relumine::relight
