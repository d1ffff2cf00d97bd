// The scene's picture as `relumine relight` draws it, traced in the background while nothing moves.
// Works without a window.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relumine/in/mesh_files.h"
#include "relumine/in/scene_rays.h"
#include "relumine/out/pictures.h"

namespace relumine::viewer {

/// What a mesh looks like in pictures, apart from its light.
struct Shading {
    /// [num_vertices] what the radiance is multiplied with.
    std::vector<glm::vec3> albedo;
    relight::FadingFloor floor = {};
    /// [num_vertices] or empty; must outlive its user.
    std::span<const prt::Surface> surfaces = {};
    relight::SurfaceColors textures = {};
    /// [num_vertices] as relight::add_rest() takes them; empty without highlights.
    std::vector<prt::EyeCosines> eye_cosines = {};
    /// [num_vertices] or empty, as relight::MeshLight has it.
    std::vector<glm::vec3> emission = {};
    /// [num_triangles], as relight::MeshLight has it.
    std::vector<glm::vec3> emission_gains = {};
    /// The eye that highlights are for.
    std::optional<glm::vec3> eye = {};
    /// Lift of shadow rays.
    float bias = 0.0f;
};

/// A moment of the scene: copies, so that the scene may change while the picture is drawn.
struct Moment {
    relight::Camera camera = {};
    std::uint32_t width = 1, height = 1;
    /// [num_vertices] without the lights, albedo 1.
    std::vector<glm::vec3> radiance;
    std::vector<relight::SharpLight> lights;
    /// [num_vertices] lobes, and harmonics of the light that arrives (Lighting).
    std::vector<prt::Lobes<glm::vec3>> lobes = {};
    std::vector<glm::vec3> harmonics = {};
    /// The radiance of a floor that nothing shades; empty: floors catch no shadows (MeshLight).
    std::optional<glm::vec3> open_floor = {};
    /// What surfaces that mirror see: the environment, and the radiance of all light for albedo 1
    /// (Lighting). Null: the picture has no highlights by rays.
    std::shared_ptr<const cubemap::CubeMap> environment = {};
    std::vector<glm::vec3> mirrored = {};
    std::size_t num_environment_lights = 0;
    /// Empty: the picture has alpha.
    relight::Backdrop backdrop;
};

/// Draws a moment in two passes: one sample a pixel, then nine.
class Refiner {
public:
    /// All arguments must outlive this object.
    Refiner(const mesh::TriangleMesh& mesh, const prt::RayScene& rays, const Shading& shading);
    ~Refiner();
    Refiner(const Refiner&) = delete;
    Refiner& operator=(const Refiner&) = delete;

    /// Begins to draw a moment on a thread of its own, and drops the one that is being drawn.
    void start(Moment moment);
    /// Drops what is being drawn.
    void stop();
    /// Returns the picture of the last pass that was finished since the last call.
    [[nodiscard]] std::optional<relight::Picture> take();
    /// Draws the finest pass at once.
    [[nodiscard]] relight::Picture draw(const Moment& moment) const;

private:
    class Work;
    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    const Shading& shading_;
    std::unique_ptr<Work> work_;
};

} // namespace relumine::viewer
