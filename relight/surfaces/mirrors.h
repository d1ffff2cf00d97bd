// Surfaces of a picture whose highlights rays find: relight/surfaces/reflections.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/twin_triangles.h"
#include "relight/surfaces/mesh_light.h"

namespace relumine::relight {

/// A point that mirrors, and its surface.
struct Mirror {
    prt::Surface surface;
    glm::vec3 normal, to_eye;
    /// Alpha of its facets. The surface is rougher where the mesh bends within a sample, which
    /// light that goes through follows by itself.
    float facet_alpha = 0.0f;
};

/// Returns the mirror at a point, whose surface is given, for an eye or a ray that comes from the
/// side of `to_eye`; none where the point looks away from there. For a sample of a view, the
/// surface is as much rougher as the normals of its maps differ in what the sample sees.
[[nodiscard]] std::optional<Mirror> mirror_of(const mesh::TriangleMesh& mesh,
                                              const prt::MeshPoint& point,
                                              const prt::Surface& surface, const glm::vec3& to_eye,
                                              const prt::TextureView* view = nullptr);

/// A surface that mirrors, and its diffuse light, which is the radiance of albedo 1.
struct LitMirror {
    const mesh::TriangleMesh& mesh;
    prt::MeshPoint at;
    prt::Surface surface;
    glm::vec3 light;
};

/// Returns what such a surface sends to the ray of a highlight that met it, but for what it gives
/// of its own. `surfaces`: what others send to it.
///
/// Cost:    none to 3 rays, as asked_for() says.
/// Threads: any.
[[nodiscard]] glm::vec3 seen_in_mirror(const Reflections& reflections, const MetSurface& met,
                                       const LitMirror& lit, const Reflections::Surfaces& surfaces);

/// The mirrors that the samples of a picture's pixels see. Samples of a pixel share their rays
/// where they see nearly the same surface; so do neighbouring pixels, where the lobe is wide and
/// blurs more than that: each has other rays of it [Keller and Heidrich 2001, "Interleaved
/// sampling"]. For one thread.
class Mirrors {
public:
    /// So many pixels around a tile share their rays with it.
    static constexpr std::uint32_t Reach = 3;

    /// Returns the radiance behind the mesh, which a ray of a unit direction finds.
    using Behind = std::function<glm::vec3(const glm::vec3& direction)>;

    /// All must outlive this object. `behind` is empty where there is nothing behind the mesh but
    /// the environment.
    Mirrors(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
            const prt::TwinTriangles& twins, const MeshLight& light, const FadingFloor& floor,
            Behind behind, const prt::TextureView& view)
        : mesh_(mesh), rays_(rays), twins_(twins), light_(light), floor_(floor),
          behind_(std::move(behind)), view_(view) {}

    /// Traces the rays of the middles of pixels: a rectangle of them, `width` to a row, from (left,
    /// top) on. `middles` are what these see.
    void begin_tile(std::uint32_t left, std::uint32_t top, std::uint32_t width,
                    std::span<const std::optional<prt::MeshPoint>> middles);
    /// Begins a pixel of the tile.
    void begin_pixel(std::uint32_t x, std::uint32_t y);

    /// Returns the mirror at a point; none where nothing mirrors, or
    /// the point looks away from the eye.
    [[nodiscard]] std::optional<Mirror> at(const prt::MeshPoint& point) const;

    /// Returns what a mirror sends on of all but MeshLight::lights. `diffuse` is the light of its
    /// diffuse part: the radiance of albedo 1, times the factor.
    [[nodiscard]] glm::vec3 soft(const Mirror& mirror, const prt::MeshPoint& point,
                                 const glm::vec3& diffuse);

    /// Returns the radiance of a surface that a ray meets, with what it mirrors itself, as
    /// asked_for() says. A floor that catches shadows shows what is behind it, as in the picture;
    /// without a picture's backdrop, the mean of the sky over the ray's solid angle.
    [[nodiscard]] glm::vec3 seen(const MetSurface& met) const;

    /// How the rays of this pixel are shifted: MirrorPoint::shift.
    [[nodiscard]] const glm::vec2& shift() const { return shift_; }

private:
    /// What a surface passes on from behind it.
    [[nodiscard]] glm::vec3 passed_on(const prt::MeshPoint& at) const;
    /// seen() of what mirrors nothing.
    [[nodiscard]] glm::vec3 matte(const prt::MeshPoint& at, const MetSurface& met) const;
    [[nodiscard]] glm::vec3 floor(const prt::MeshPoint& at, const MetSurface& met) const;
    [[nodiscard]] prt::MeshPoint point_of(const MetSurface& met) const;

    struct Traced {
        Mirror mirror;
        MirroredLight light;
    };
    /// What the middle of a pixel mirrors.
    struct Middle {
        Traced traced;
        glm::vec3 position;
    };

    [[nodiscard]] MirroredLight light(const Mirror& mirror, const prt::MeshPoint& point);
    /// Returns what rays of a mirror find.
    [[nodiscard]] MirroredLight trace(const Mirror& mirror, const prt::MeshPoint& point,
                                      std::uint32_t num_rays) const;
    /// The light that several points found.
    struct Shared {
        MirroredLight sum;
        float count = 0.0f, num_coats = 0.0f;
        /// Whether the middle of this pixel is among them
        bool has_own = false;
        void add(const MirroredLight& light, bool has_coat);
        [[nodiscard]] MirroredLight mean() const;
    };
    /// Returns the light that the middles of this pixel and of those around found on the same
    /// surface.
    [[nodiscard]] Shared shared(const Mirror& mirror, const glm::vec3& position) const;

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    const prt::TwinTriangles& twins_;
    const MeshLight& light_;
    const FadingFloor& floor_;
    Behind behind_;
    const prt::TextureView& view_;
    glm::vec2 shift_{0.0f};
    // Where this tile begins, and its size
    std::uint32_t left_ = 0, top_ = 0, width_ = 0;
    std::vector<std::optional<Middle>> middles_;
    // Where this pixel is
    std::uint32_t x_ = 0, y_ = 0;
    std::vector<Traced> traced_;
};

} // namespace relumine::relight
