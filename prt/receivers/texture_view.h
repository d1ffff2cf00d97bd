// How the samples of a picture see textures.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "mesh/materials/mip_maps.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

/// The rays of a picture's samples start at the eye and go to forward + x right + y down, for whole
/// numbers x and y.
struct TextureView {
    const mesh::MipMaps* maps = nullptr;
    glm::vec3 eye{0.0f};
    glm::vec3 right{0.0f}, down{0.0f}, forward{0.0f, 0.0f, -1.0f};

    /// Takes a picture's rays.
    TextureView(const mesh::MipMaps& of, const glm::vec3& from, const PictureRays& rays)
        : maps(&of), eye(from), right(rays.right()), down(rays.down()), forward(rays.forward()) {}
    TextureView() = default;

    /// Returns how far the uv of a set moves between samples, in the plane of the triangle.
    [[nodiscard]] mesh::Footprint footprint(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                                            std::uint32_t uv_set) const;
};

} // namespace relumine::prt
