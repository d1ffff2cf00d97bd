#include "relight/pictures/mesh_picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/framing.h"
#include "relight/pictures/picture.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t MeshPictureWidth = 1024, MeshPictureHeight = 768;
constexpr std::uint32_t SamplesPerAxis = 3;

/// Linear colours.
const glm::vec3 Paper(0.9f), Orange(0.9f, 0.28f, 0.02f), Violet(0.25f, 0.05f, 0.6f),
    Blue(0.02f, 0.1f, 0.8f), Magenta(0.8f, 0.02f, 0.5f), Red(0.8f, 0.01f, 0.01f),
    Yellow(0.95f, 0.7f, 0.02f);

class MeshPicture {
public:
    MeshPicture(const mesh::TriangleMesh& mesh, const mesh::Diagnosis& diagnosis)
        : mesh_(mesh), camera_(framed(mesh)), rays_(mesh),
          axes_(prt::axes_of(camera_, float{MeshPictureWidth} / MeshPictureHeight)),
          picture_{.width = MeshPictureWidth,
                   .height = MeshPictureHeight,
                   .pixels =
                       std::vector<glm::vec3>(std::size_t{MeshPictureWidth} * MeshPictureHeight)} {
        draw_triangles(diagnosis);
        for (const mesh::VertexPair& edge : diagnosis.boundary_edges)
            draw_edge(edge, Blue);
        for (const mesh::VertexPair& edge : diagnosis.repeated_sides)
            draw_edge(edge, Red);
        for (const mesh::VertexPair& edge : diagnosis.non_manifold_edges)
            draw_edge(edge, Magenta);
        for (const std::uint32_t vertex : diagnosis.non_manifold_vertices)
            draw_point(mesh.positions[vertex], Yellow, 4);
    }

    [[nodiscard]] const Picture& picture() const { return picture_; }

private:
    void draw_triangles(const mesh::Diagnosis& diagnosis) {
        std::vector<glm::vec3> colors(mesh_.num_triangles(), glm::vec3(0.75f));
        for (const std::uint32_t i : diagnosis.against_normals)
            colors[i] = Violet;
        for (const std::uint32_t i : diagnosis.wrongly_wound)
            colors[i] = Orange;
        const prt::PictureRays rays(camera_, MeshPictureWidth, MeshPictureHeight, SamplesPerAxis);
        files::parallel_for(std::uint32_t{0}, MeshPictureHeight, [&](std::uint32_t y) {
            for (std::uint32_t x = 0; x < MeshPictureWidth; ++x) {
                glm::vec3 sum(0.0f);
                for (std::uint32_t i = 0; i < rays.samples_per_pixel(); ++i) {
                    const glm::vec3 direction = rays.direction(x, y, i);
                    const auto hit = rays_.closest_hit(camera_.eye, direction, prt::RayOf::Eye);
                    const float facing =
                        hit ? std::abs(glm::dot(prt::face_normal(mesh_, hit->triangle), direction))
                            : 0.0f;
                    sum += hit ? (0.1f + 0.8f * facing) * colors[hit->triangle] : Paper;
                }
                at(x, y) = sum / static_cast<float>(rays.samples_per_pixel());
            }
        });
    }

    glm::vec3& at(std::uint32_t x, std::uint32_t y) {
        return picture_.pixels[std::size_t{y} * MeshPictureWidth + x];
    }

    /// A square around a point, where nothing lies before it.
    void draw_point(const glm::vec3& point, const glm::vec3& color, int radius) {
        const glm::vec3 way = point - camera_.eye;
        const float depth = glm::dot(way, axes_.forward);
        const float distance = glm::length(way);
        if (!(depth > 0.0f))
            return;
        constexpr float Nearer = 0.997f;
        const auto hit = rays_.closest_hit(camera_.eye, way / distance, prt::RayOf::Eye);
        if (hit && hit->distance < Nearer * distance)
            return;
        const float x = 0.5f * (1.0f + glm::dot(way, axes_.right) /
                                           (depth * glm::dot(axes_.right, axes_.right)));
        const float y =
            0.5f * (1.0f - glm::dot(way, axes_.up) / (depth * glm::dot(axes_.up, axes_.up)));
        const int left = static_cast<int>(x * MeshPictureWidth) - radius;
        const int top = static_cast<int>(y * MeshPictureHeight) - radius;
        for (int row = std::max(top, 0); row <= top + 2 * radius; ++row)
            for (int column = std::max(left, 0); column <= left + 2 * radius; ++column)
                if (row < static_cast<int>(MeshPictureHeight) &&
                    column < static_cast<int>(MeshPictureWidth))
                    at(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row)) = color;
    }

    void draw_edge(const mesh::VertexPair& edge, const glm::vec3& color) {
        const glm::vec3 from = mesh_.positions[edge[0]], to = mesh_.positions[edge[1]];
        const float nearest = std::max(
            std::min(glm::distance(from, camera_.eye), glm::distance(to, camera_.eye)), 1e-20f);
        // Half a pixel between two points of a line.
        const float pixel = 2.0f * glm::length(axes_.right) / MeshPictureWidth;
        const float steps = std::ceil(2.0f * glm::distance(from, to) / (nearest * pixel));
        const int num_steps = static_cast<int>(std::min(std::max(steps, 1.0f), 4096.0f));
        for (int i = 0; i <= num_steps; ++i)
            draw_point(glm::mix(from, to, static_cast<float>(i) / static_cast<float>(num_steps)),
                       color, 1);
    }

    const mesh::TriangleMesh& mesh_;
    Camera camera_;
    prt::RayScene rays_;
    prt::CameraAxes axes_;
    Picture picture_;
};

} // namespace

void save_mesh_picture(const std::filesystem::path& path, const mesh::TriangleMesh& mesh,
                       const mesh::Diagnosis& diagnosis) {
    try {
        save_picture(path, MeshPicture(mesh, diagnosis).picture());
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace relumine::relight
