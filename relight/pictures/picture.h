// Pictures of relit meshes by ray casting.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/image/picture.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/surface_colors.h"

namespace relumine::relight {

using cubemap::Picture;
using prt::Camera;

struct PictureOptions {
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n: each pixel has n x n rays and a box filter.
    std::uint32_t samples_per_axis = 3;
};

/// Returns a camera that looks at the mesh from the front, a little from the right and from above.
/// It is as near as shows all of the mesh but the ground. Triangles in the lowest horizontal plane
/// are the ground, unless there is nothing else.
[[nodiscard]] Camera automatic_camera(const mesh::TriangleMesh& mesh,
                                      const PictureOptions& options = {},
                                      float fov_degrees = 35.0f);

/// Draws the mesh as the camera sees it, with radiance interpolated between vertices, and the
/// environment behind it. Triangles that have `colors` take the light from the vertices alone.
///
/// Shape:   vertex_radiance is [num_vertices].
/// Throws:  std::invalid_argument for a camera without a direction, a field of view outside (0,
///          180), a size outside 1..16384 or a background without texels.
[[nodiscard]] Picture draw(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                           std::span<const glm::vec3> vertex_radiance,
                           const cubemap::CubeMap& background, const Camera& camera,
                           const PictureOptions& options = {}, const SurfaceColors& colors = {});

/// A camera's view of a still scene, traced once and drawn in any light. Pictures are bit by bit
/// the pictures of draw().
class PictureView {
public:
    /// Traces the rays and keeps 12 bytes per sample, if they come to at most `max_bytes`.
    /// Otherwise draw() traces anew each time. The mesh and rays must outlive this object.
    ///
    /// Throws:  as the function draw().
    PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Camera& camera,
                const PictureOptions& options = {}, std::size_t max_bytes = std::size_t{1} << 30);

    [[nodiscard]] Picture draw(std::span<const glm::vec3> vertex_radiance,
                               const cubemap::CubeMap& background,
                               const SurfaceColors& colors = {}) const;

private:
    /// The point where a sample's ray meets the mesh.
    struct Sample {
        std::uint32_t triangle;
        /// Weights of the triangle's second and third vertex.
        float second, third;
    };

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    Camera camera_;
    PictureOptions options_;
    /// [height * width * samples per pixel]; empty when draw() traces anew.
    std::vector<Sample> samples_;
};

/// Writes .png (times 2^exposure_ev, sRGB curve, clipped, 8 bit) or .exr (linear float, exposure
/// applied too). Alpha becomes a channel. Writes the file whole or not at all.
///
/// Throws:  std::runtime_error that names the path; std::invalid_argument for another extension, or
///          a picture with too few pixels.
void save_picture(const std::filesystem::path& path, const Picture& picture,
                  double exposure_ev = 0.0);

} // namespace relumine::relight
