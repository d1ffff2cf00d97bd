// The soft light at the points that a picture shows, found by rays.
//
// Based on: G. Ward, F. Rubinstein and R. Clear, "A Ray Tracing Solution for Diffuse
// Interreflection", 1988 (how far a record holds); E. Veach and L. Guibas, "Optimally Combining
// Sampling Techniques for Monte Carlo Rendering", 1995 (the balance heuristic). Differs from them:
// records lie on a grid of the picture, squares of records guide each other's rays, and where no
// record holds for a point, the light of the vertices does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/camera.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/twin_triangles.h"
#include "prt/work.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/seen_mesh.h"

namespace relumine::relight {

/// Where rays look that gather light: mean luminance by square of the picture and cell of
/// directions. Empty at first; the first light fills it, and further lights of the same view use
/// it, so that what they gather is linear in the light.
struct GatherGuide {
    std::vector<std::vector<float>> squares = {};
};

/// What surfaces and sky send to the points of a mesh that a picture shows, gathered at every
/// fourth pixel of every fourth row, or closer in small pictures. Between vertices that lie far
/// apart, and at contacts, it has what they miss.
///
/// Threads: change() may run from any number of threads at once.
class GatheredLight {
public:
    /// What light is gathered for. All must outlive the object.
    struct Scene {
        const mesh::TriangleMesh& mesh;
        const prt::RayScene& rays;
        const SeenMesh& seen;
        const prt::TwinTriangles& twins;
        const FadingFloor& floor;
        glm::vec3 eye;
        const prt::PictureRays& grid;
        std::uint32_t width, height;
    };

    /// Gathers MeshLight::sent and MeshLight::sky. A part of the rays is cosine-distributed, the
    /// others go where rays of all records around found light: through windows, to places in the
    /// sun.
    ///
    /// Cost:    144 rays for a record, of 16 pixels in pictures of 1024 x 768; up to four times as
    ///          many in corners.
    /// Threads: parallel; the result is the same for any number of them. After a wish to stop,
    ///          records are missing.
    GatheredLight(const Scene& scene, const MeshLight& light, const prt::Work& work);

    /// Returns what a point that a pixel shows has more of the light than MeshLight::replaced says:
    /// radiance for albedo 1. 0 where no record holds.
    [[nodiscard]] glm::vec3 change(std::uint32_t x, std::uint32_t y,
                                   const prt::MeshPoint& at) const;

private:
    /// The light at a point.
    struct Record {
        glm::vec3 position, normal, light{0.0f};
        /// How far it holds, in steps between records.
        float reach = 0.0f;
        bool exists = false;
    };
    class Square;
    /// What records around a point say of its light, and how well they suit it.
    struct Mean {
        glm::vec3 light{0.0f};
        float weight = 0.0f;
    };

    /// Returns where a record lies in the picture, in pixels.
    [[nodiscard]] glm::vec2 middle(std::uint32_t column, std::uint32_t row) const {
        return (glm::vec2(column, row) + 0.5f) * static_cast<float>(step_);
    }
    /// Averages records as far as they hold.
    void smooth();
    [[nodiscard]] Mean around(const glm::vec2& pixel, const glm::vec3& position,
                              const glm::vec3& normal, float reach) const;

    const Scene scene_;
    const MeshLight& light_;
    /// Pixels between records
    std::uint32_t step_;
    std::uint32_t columns_, rows_;
    /// [rows][columns]
    std::vector<Record> records_;
};

} // namespace relumine::relight
