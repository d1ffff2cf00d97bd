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
    return PictureView(mesh, rays, camera, options, 0).draw(vertex_radiance, background);
}

namespace {

/// The samples of a picture: n x n rays per pixel.
class SampleGrid {
public:
    SampleGrid(const Camera& camera, const PictureOptions& options)
        : frame_(frame_of(camera, options)), options_(options) {}

    [[nodiscard]] std::uint32_t per_pixel() const {
        return options_.samples_per_axis * options_.samples_per_axis;
    }
    /// Unit direction of sample i of a pixel.
    [[nodiscard]] glm::vec3 direction(std::uint32_t x, std::uint32_t y, std::uint32_t i) const {
        const std::uint32_t n = options_.samples_per_axis;
        const std::uint32_t column = i % n;
        const std::uint32_t row = i / n;
        // Picture coordinates in pixels from the top left corner.
        const float px = static_cast<float>(x) + (static_cast<float>(column) + 0.5f) / static_cast<float>(n);
        const float py = static_cast<float>(y) + (static_cast<float>(row) + 0.5f) / static_cast<float>(n);
        const float across = 2.0f * px / static_cast<float>(options_.width) - 1.0f;
        const float upwards = 1.0f - 2.0f * py / static_cast<float>(options_.height);
        return glm::normalize(frame_.forward + across * frame_.right + upwards * frame_.up);
    }

private:
    Frame frame_;
    PictureOptions options_;
};

constexpr std::uint32_t NoTriangle = ~std::uint32_t{0};

} // namespace

PictureView::PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Camera& camera,
                         const PictureOptions& options, std::size_t max_bytes)
    : mesh_(mesh), rays_(rays), camera_(camera), options_(options) {
    constexpr std::uint32_t MaxSize = 16384;
    const auto good_size = [](std::uint32_t size) {
        return size >= 1 && size <= MaxSize;
    };
    if (!good_size(options.width) || !good_size(options.height) || options.samples_per_axis < 1 ||
        options.samples_per_axis > 64)
        throw std::invalid_argument(fmt::format("expected a picture of 1 to {} pixels a side", MaxSize));
    const SampleGrid grid(camera, options);
    const std::size_t num_samples = std::size_t{options.width} * options.height * grid.per_pixel();
    if (num_samples > max_bytes / sizeof(Sample))
        return;
    samples_.resize(num_samples);
    tbb::parallel_for(std::uint32_t{0}, options.height, [&](std::uint32_t y) {
        std::size_t index = std::size_t{y} * options.width * grid.per_pixel();
        for (std::uint32_t x = 0; x < options.width; ++x)
            for (std::uint32_t i = 0; i < grid.per_pixel(); ++i) {
                const std::optional<prt::Hit> hit = rays.closest_hit(camera.eye, grid.direction(x, y, i));
                samples_[index++] = hit ? Sample{hit->triangle, hit->barycentric.x, hit->barycentric.y}
                                        : Sample{NoTriangle, 0.0f, 0.0f};
            }
    });
}

Picture PictureView::draw(std::span<const glm::vec3> vertex_radiance,
                          const cubemap::CubeMap& background) const {
    if (vertex_radiance.size() != mesh_.num_vertices())
        throw std::invalid_argument("expected one radiance per vertex");
    if (background.resolution == 0)
        throw std::invalid_argument("expected a background with texels");
    const SampleGrid grid(camera_, options_);
    const auto seen = [&](std::uint32_t x, std::uint32_t y, std::uint32_t i, std::size_t index) {
        Sample sample{NoTriangle, 0.0f, 0.0f};
        if (!samples_.empty()) {
            sample = samples_[index];
        } else if (const auto hit = rays_.closest_hit(camera_.eye, grid.direction(x, y, i))) {
            sample = {hit->triangle, hit->barycentric.x, hit->barycentric.y};
        }
        if (sample.triangle == NoTriangle)
            return cubemap::sample(background, grid.direction(x, y, i));
        const mesh::Triangle& triangle = mesh_.triangles[sample.triangle];
        const float first = 1.0f - sample.second - sample.third;
        return first * vertex_radiance[triangle[0]] + sample.second * vertex_radiance[triangle[1]] +
               sample.third * vertex_radiance[triangle[2]];
    };

    Picture picture{.width = options_.width, .height = options_.height};
    picture.pixels.resize(std::size_t{options_.width} * options_.height);
    tbb::parallel_for(std::uint32_t{0}, options_.height, [&](std::uint32_t y) {
        std::size_t index = std::size_t{y} * options_.width * grid.per_pixel();
        for (std::uint32_t x = 0; x < options_.width; ++x) {
            glm::vec3 sum(0.0f);
            for (std::uint32_t i = 0; i < grid.per_pixel(); ++i)
                sum += seen(x, y, i, index++);
            picture.pixels[std::size_t{y} * options_.width + x] = sum / static_cast<float>(grid.per_pixel());
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
