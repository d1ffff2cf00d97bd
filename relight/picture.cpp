#include "relight/picture.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "cubemap/image_file.h"
#include "files/output_file.h"

namespace relumine::relight {

namespace {

constexpr float RadiansPerDegree = std::numbers::pi_v<float> / 180.0f;

/// Right, up and forward axes of a camera, right and up scaled so that they reach the picture's edges at distance 1.
struct Frame {
    glm::vec3 right, up, forward;
};

Frame frame_of(const Camera& camera, const PictureOptions& options) {
    const glm::vec3 to_target = camera.target - camera.eye;
    if (!(glm::length(to_target) > 0.0f) || !std::isfinite(glm::length(to_target)))
        throw std::invalid_argument("expected a camera target apart from its eye");
    if (!(camera.fov_degrees > 0.0f && camera.fov_degrees < 180.0f))
        throw std::invalid_argument(
            fmt::format("expected a field of view between 0 and 180 degrees, got {}", camera.fov_degrees));
    const glm::vec3 forward = glm::normalize(to_target);
    // Looking straight up or down, -Z is the picture's up.
    const glm::vec3 world_up = std::abs(forward.y) < 0.9999f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
    const glm::vec3 right = glm::normalize(glm::cross(forward, world_up));
    const float half_height = std::tan(0.5f * camera.fov_degrees * RadiansPerDegree);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    return {.right = right * half_height * aspect,
            .up = glm::cross(right, forward) * half_height,
            .forward = forward};
}

/// Box around what stands on the ground: triangles wholly in the lowest horizontal plane are left out.
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

std::vector<std::byte> encode_png(const Picture& picture, float scale) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(picture.pixels.size() * 3);
    for (const glm::vec3& pixel : picture.pixels)
        for (int channel = 0; channel < 3; ++channel)
            bytes.push_back(srgb_byte(pixel[channel] * scale));
    std::vector<std::byte> png;
    const auto append = [](void* context, void* data, int size) {
        const auto* begin = static_cast<const std::byte*>(data);
        auto* target = static_cast<std::vector<std::byte>*>(context);
        target->insert(target->end(), begin, begin + size);
    };
    const int width = static_cast<int>(picture.width);
    const int height = static_cast<int>(picture.height);
    if (stbi_write_png_to_func(append, &png, width, height, 3, bytes.data(), 3 * width) == 0)
        throw std::runtime_error("could not encode the picture as PNG");
    return png;
}

} // namespace

Camera automatic_camera(const mesh::TriangleMesh& mesh, const PictureOptions& options, float fov_degrees) {
    const mesh::Bounds box = subject_bounds(mesh);
    const glm::vec3 from_target = glm::normalize(glm::vec3(0.45f, 0.4f, 1.0f));
    // About the origin: far from it floats would not hold so short a way from target to eye.
    const Frame frame = frame_of({.eye = from_target, .fov_degrees = fov_degrees}, options);

    // Every corner of the box must lie within the picture's pyramid, with a margin of an eighth.
    constexpr float Margin = 1.125f;
    float distance = 1e-20f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 sign((corner & 1) != 0 ? 0.5f : -0.5f, (corner & 2) != 0 ? 0.5f : -0.5f,
                             (corner & 4) != 0 ? 0.5f : -0.5f);
        const glm::vec3 offset = sign * box.size();
        const float across = std::abs(glm::dot(offset, frame.right)) / glm::dot(frame.right, frame.right);
        const float upwards = std::abs(glm::dot(offset, frame.up)) / glm::dot(frame.up, frame.up);
        distance = std::max(distance, Margin * std::max(across, upwards) - glm::dot(offset, frame.forward));
    }
    return {.eye = box.center() + distance * from_target, .target = box.center(), .fov_degrees = fov_degrees};
}

Picture draw(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
             std::span<const glm::vec3> vertex_radiance, const cubemap::CubeMap& background,
             const Camera& camera, const PictureOptions& options) {
    constexpr std::uint32_t MaxSize = 16384;
    const auto good_size = [](std::uint32_t size) {
        return size >= 1 && size <= MaxSize;
    };
    if (!good_size(options.width) || !good_size(options.height) || options.samples_per_axis < 1 ||
        options.samples_per_axis > 64)
        throw std::invalid_argument(fmt::format("expected a picture of 1 to {} pixels a side", MaxSize));
    if (vertex_radiance.size() != mesh.num_vertices())
        throw std::invalid_argument("expected one radiance per vertex");
    if (background.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    const Frame frame = frame_of(camera, options);

    const auto seen = [&](float x, float y) { // picture coordinates in pixels from the top left corner
        const float across = 2.0f * x / static_cast<float>(options.width) - 1.0f;
        const float upwards = 1.0f - 2.0f * y / static_cast<float>(options.height);
        const glm::vec3 direction = glm::normalize(frame.forward + across * frame.right + upwards * frame.up);
        const std::optional<prt::Hit> hit = rays.closest_hit(camera.eye, direction);
        if (!hit)
            return cubemap::sample(background, direction);
        const mesh::Triangle& triangle = mesh.triangles[hit->triangle];
        const float first = 1.0f - hit->barycentric.x - hit->barycentric.y;
        return first * vertex_radiance[triangle[0]] + hit->barycentric.x * vertex_radiance[triangle[1]] +
               hit->barycentric.y * vertex_radiance[triangle[2]];
    };

    Picture picture{.width = options.width, .height = options.height};
    picture.pixels.resize(std::size_t{options.width} * options.height);
    const std::uint32_t n = options.samples_per_axis;
    tbb::parallel_for(std::uint32_t{0}, options.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < options.width; ++x) {
            glm::vec3 sum(0.0f);
            for (std::uint32_t i = 0; i < n * n; ++i) {
                const std::uint32_t column = i % n;
                const std::uint32_t row = i / n;
                const float dx = (static_cast<float>(column) + 0.5f) / static_cast<float>(n);
                const float dy = (static_cast<float>(row) + 0.5f) / static_cast<float>(n);
                sum += seen(static_cast<float>(x) + dx, static_cast<float>(y) + dy);
            }
            picture.pixels[std::size_t{y} * options.width + x] = sum / static_cast<float>(n * n);
        }
    });
    return picture;
}

void save_picture(const std::filesystem::path& path, const Picture& picture, double exposure_ev) {
    if (picture.pixels.empty() || picture.pixels.size() != std::size_t{picture.width} * picture.height)
        throw std::invalid_argument(fmt::format("{}: expected {} x {} pixels, got {}", path.string(),
                                                picture.width, picture.height, picture.pixels.size()));
    const auto scale = static_cast<float>(std::exp2(exposure_ev));
    std::vector<std::byte> bytes;
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".png") {
        bytes = encode_png(picture, scale);
    } else if (extension == ".exr") {
        cubemap::EnvironmentImage image;
        image.width = picture.width;
        image.height = picture.height;
        image.pixels = picture.pixels;
        for (glm::vec3& pixel : image.pixels)
            pixel *= scale;
        bytes = cubemap::encode_exr(image);
    } else {
        throw std::invalid_argument(
            fmt::format("{}: expected .png or .exr, got '{}'", path.string(), path.extension().string()));
    }
    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

} // namespace relumine::relight
