// How the samples of a picture see textures and bent surfaces.
#pragma once

#include <cstdint>

#include <glm/mat2x2.hpp>
#include <glm/vec3.hpp>

#include "mesh/materials/mip_maps.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

/// The rays of a picture's samples start at the eye and go to forward + x right + y down, for whole
/// numbers x and y; `samples_per_axis` of them make a pixel.
struct TextureView {
    /// Null: textures are not filtered.
    const mesh::MipMaps* maps = nullptr;
    glm::vec3 eye{0.0f};
    glm::vec3 right{0.0f}, down{0.0f}, forward{0.0f, 0.0f, -1.0f};
    std::uint32_t samples_per_axis = 1;

    /// Take a picture's rays.
    TextureView(const glm::vec3& from, const PictureRays& rays)
        : eye(from), right(rays.right()), down(rays.down()), forward(rays.forward()),
          samples_per_axis(rays.samples_per_axis()) {}
    TextureView(const mesh::MipMaps& of, const glm::vec3& from, const PictureRays& rays)
        : TextureView(from, rays) {
        maps = &of;
    }
    TextureView() = default;

    /// Returns how far the uv of a set moves between samples, in the plane of the triangle.
    [[nodiscard]] mesh::Footprint footprint(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                            std::uint32_t uv_set) const;

    /// Returns the variance of the normals of a bent surface over what a sample stands for: its
    /// pixel, as far as normals differ by less than a degree there, or what lies between samples.
    [[nodiscard]] float normal_spread(const mesh::TriangleMesh& mesh, const MeshPoint& point) const;

private:
    /// Returns how far barycentric coordinates of the triangle move between samples, to the right
    /// and down; 0 where the triangle is seen edge-on.
    [[nodiscard]] glm::dmat2 steps(const mesh::TriangleMesh& mesh, const MeshPoint& point) const;
};

} // namespace relumine::prt
