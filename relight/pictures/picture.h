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

namespace relumine::relight {

using cubemap::Picture;
using prt::Camera;

struct PictureOptions {
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n x n rays per pixel, box filter
    std::uint32_t samples_per_axis = 3;
};

/// A camera that looks at the mesh from the front, a little from the right and from above, as near
/// as shows all of it but the ground: triangles that lie in the lowest horizontal plane do not
/// count, unless there is nothing else.
[[nodiscard]] Camera automatic_camera(const mesh::TriangleMesh& mesh,
                                      const PictureOptions& options = {},
                                      float fov_degrees = 35.0f);

/// The mesh seen by the camera, radiance interpolated between its vertices [num_vertices], the
/// environment behind it. Throws std::invalid_argument for a camera without a direction, a field of
/// view outside (0, 180), a size outside 1..16384 or a background without texels.
[[nodiscard]] Picture draw(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                           std::span<const glm::vec3> vertex_radiance,
                           const cubemap::CubeMap& background, const Camera& camera,
                           const PictureOptions& options = {});

/// What a camera sees of a scene that stands still, found once and drawn in any light: pictures are
/// bit by bit those of draw().
class PictureView {
public:
    /// Traces the rays: 12 bytes per sample are kept as long as they are at most `max_bytes`;
    /// beyond that draw() traces anew each time. The mesh and rays must outlive it. Throws as
    /// draw() does.
    PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Camera& camera,
                const PictureOptions& options = {}, std::size_t max_bytes = std::size_t{1} << 30);

    [[nodiscard]] Picture draw(std::span<const glm::vec3> vertex_radiance,
                               const cubemap::CubeMap& background) const;

private:
    /// Where a sample's ray meets the mesh.
    struct Sample {
        std::uint32_t triangle;
        /// Weights of the triangle's vertices
        float second, third;
    };

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    Camera camera_;
    PictureOptions options_;
    /// [height * width * samples of a pixel], or none
    std::vector<Sample> samples_;
};

/// Writes .png (times 2^exposure_ev, sRGB curve, clipped, 8 bit) or .exr (linear float, exposure
/// applied too), with an alpha channel where there is alpha. Whole or not at all. Throws
/// std::runtime_error naming the path, std::invalid_argument for another extension or a picture
/// short of pixels.
void save_picture(const std::filesystem::path& path, const Picture& picture,
                  double exposure_ev = 0.0);

} // namespace relumine::relight
