// Surfaces of a picture whose highlights rays find: relight/pictures/reflections.h.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/twin_triangles.h"
#include "relight/pictures/picture_view.h"

namespace relumine::relight {

/// A point that mirrors, and its surface.
struct Mirror {
    prt::Surface surface;
    glm::vec3 normal, to_eye;
};

/// The mirrors that the samples of a picture's pixels see. Samples of a pixel share their rays
/// where they see nearly the same surface. For one thread.
class Mirrors {
public:
    /// All must outlive this object. Null: there is nothing behind the mesh but the environment.
    Mirrors(const mesh::TriangleMesh& mesh, const prt::TwinTriangles& twins, const MeshLight& light,
            const FadingFloor& floor, const Backdrop* backdrop, const prt::TextureView& view)
        : mesh_(mesh), twins_(twins), light_(light), floor_(floor), backdrop_(backdrop),
          view_(view) {}

    /// `middle` is what the middle of the pixel sees: the first to be shared.
    void begin_pixel(std::uint32_t x, std::uint32_t y, const std::optional<prt::MeshPoint>& middle);

    /// Returns the mirror at a point; none where nothing mirrors, or
    /// the point looks away from the eye.
    [[nodiscard]] std::optional<Mirror> at(const prt::MeshPoint& point) const;

    /// Returns what a mirror sends on of all but MeshLight::lights. `diffuse` is the light of its
    /// diffuse part: the radiance of albedo 1, times the factor.
    [[nodiscard]] glm::vec3 soft(const Mirror& mirror, const prt::MeshPoint& point,
                                 const glm::vec3& diffuse);

private:
    struct Traced {
        Mirror mirror;
        MirroredLight light;
    };

    [[nodiscard]] MirroredLight light(const Mirror& mirror, const prt::MeshPoint& point);
    /// Traces the rays of a mirror, for the samples that are like it.
    void trace(const Mirror& mirror, const prt::MeshPoint& point);
    [[nodiscard]] glm::vec3 seen(const prt::Hit& hit, const glm::vec3& direction,
                                 const glm::vec3& sky) const;

    const mesh::TriangleMesh& mesh_;
    const prt::TwinTriangles& twins_;
    const MeshLight& light_;
    const FadingFloor& floor_;
    const Backdrop* backdrop_;
    const prt::TextureView& view_;
    glm::vec2 shift_{0.0f};
    // Of this pixel
    std::optional<prt::MeshPoint> middle_;
    std::vector<Traced> traced_;
};

} // namespace relumine::relight
