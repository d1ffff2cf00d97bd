// Pictures of relit meshes by ray casting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>

#include "cubemap/image/picture.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"
#include "relight/pictures/backdrop.h"
#include "relight/surfaces/mesh_light.h"

namespace relumine::relight {

using cubemap::Picture;
using prt::Camera;

struct PictureOptions {
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n: each pixel has n x n rays and a box filter.
    std::uint32_t samples_per_axis = 3;
    /// What is drawn after a wish to stop is unfinished.
    prt::Work work = {};

    [[nodiscard]] float aspect() const {
        return static_cast<float>(width) / static_cast<float>(height);
    }
};

class EyeSamples;
class SeenMesh;

/// A camera's view of a still scene, traced once and drawn in any light.
class PictureView {
public:
    /// Finds what the samples see and keeps 12 bytes for each, if they come to at most `max_bytes`.
    /// Otherwise it is found anew each time. The mesh and rays must outlive this object.
    ///
    /// Throws:  std::invalid_argument for a camera without a direction, a field of view outside
    ///          (0, 180), a size outside 1..16384.
    PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Camera& camera,
                const PictureOptions& options = {}, const FadingFloor& floor = {},
                std::size_t max_bytes = std::size_t{1} << 30);
    ~PictureView();
    PictureView(PictureView&&) noexcept;

    /// Draws the mesh alone. Alpha is the part of each pixel that it covers; pixels are
    /// premultiplied.
    ///
    /// Lights are traced at the middle of each pixel. Those that a pixel and the pixels around it
    /// disagree about are traced at all of its samples.
    ///
    /// Throws:  std::invalid_argument where there is not one radiance, albedo or surface per
    ///          vertex.
    [[nodiscard]] Picture cut_out(const MeshLight& light) const;

    /// Draws the mesh before the backdrop. The picture is opaque and has no alpha.
    ///
    /// Throws:  as cut_out().
    [[nodiscard]] Picture draw(const MeshLight& light, const Backdrop& backdrop) const;

private:
    [[nodiscard]] Picture drawn(const MeshLight& light, const Backdrop* backdrop) const;

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    glm::vec3 eye_;
    PictureOptions options_;
    FadingFloor floor_;
    prt::PictureRays grid_;
    std::unique_ptr<const SeenMesh> seen_;
    std::unique_ptr<const EyeSamples> samples_;
};

} // namespace relumine::relight
