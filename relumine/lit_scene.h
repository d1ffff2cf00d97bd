// A scene under light: what a program that relights keeps in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "cubemap/texel_rectangle.h"
#include "lights/light_list.h"
#include "prt/visibility/ray_scene.h"
#include "relight/binned_environment.h"
#include "relight/bounces/bounce_light.h"
#include "relight/light_editor.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "relumine/environment.h"
#include "relumine/output.h"
#include "relumine/scene.h"

namespace relumine {

using relight::BinnedEnvironment;
using relight::BounceLimits;
using relight::BounceReport;
using relight::RelightTimes;
using relight::UpdateReport;

/// Returns what the light of a scene needs to bounce, for relight::Relighter. `albedo` is
/// [num_receivers] what pictures multiply the radiance with, as bounce_albedo(). The scene must
/// outlive the result.
///
/// Throws:  std::invalid_argument for a scene without bounces.
[[nodiscard]] relight::SurfaceBounces
bounces_of(const Scene& scene, std::span<const glm::vec3> albedo, const BounceLimits& limits = {});

struct LightOptions {
    /// Lights the sun through its cluster too, without shadow rays of its own: faster, softer
    bool clusters_only = false;
};

struct VerifyOptions {
    /// Receivers chosen at random, 0 for all
    std::size_t num_samples = 2000;
    std::uint64_t seed = 1;
    /// Points of the surface chosen at random, evenly by area, where the light is compared that a
    /// renderer would interpolate from the vertices; 0 for none. Only for vertices.
    std::size_t num_surface_points = 500;
    /// Paths of each receiver that bounces are compared with; only after bounce()
    std::uint32_t num_paths = 256;
    /// Processes that share the work, each with the whole scene in the same light: each integrates
    /// some of the points, and all get the same result. Null: this one does it all.
    prt::Team* reduction = nullptr;
    /// Polled a few times a second; Cancelled is thrown
    std::stop_token stop = {};
    /// Fraction in [0, 1]; one call at a time
    std::function<void(double)> on_progress = {};
};

/// How far the radiance is from exact integration.
struct Verification {
    /// The receivers that were looked at
    std::vector<std::uint32_t> receivers;
    relight::ErrorReport error;
    /// Between the vertices: the diffuse light of albedo 1 that they interpolate, without bounces,
    /// against exact integration at points of the surface. Its worst_receiver is one of `points`.
    /// Only for vertices.
    struct Surface {
        std::vector<prt::MeshPoint> points;
        relight::ErrorReport error;
    };
    std::optional<Surface> surface = {};
    /// Standard error of the paths that bounces were compared with, relative to the radiance, L2
    /// over the receivers; it is a part of error.relative_l2. 0 without bounces.
    double noise = 0.0;
    /// Whether the pixels of the environment's file were integrated, not the texels of the map
    bool of_file = false;
};

/// What a part of the environment gives to a scene.
struct Share {
    /// [num_receivers], albedo 1
    std::vector<glm::vec3> radiance;
    /// The environment times the region's coverage: black outside of the region.
    cubemap::CubeMap environment;
    /// The part of the scene's reflected light that comes from the region, 0 to 1.
    double share = 0.0;
    /// As those of Lighting.
    std::vector<relight::SharpLight> lights = {};
    std::vector<glm::vec3> soft = {};

    /// Returns what a picture is drawn of. It points into this object.
    [[nodiscard]] Lighting lighting() const;
};

/// Owns a scene, its ray accelerator and its light, so that nothing can dangle. Movable; references
/// to its parts stay valid when it is moved.
///
///     relumine::LitScene lit(relumine::load_scene("bunny.prt"));
///     lit.light(relumine::load_environment("grace.exr"));
///     lit.save("bunny.png");
///
/// Threads: one thread at a time may call what is not const. Every result is the same bit by bit
///          for any number of threads.
/// Memory:  the scene, about 100 bytes per triangle for its rays, and about 1 KB for 16 receivers
///          once it is lit.
class LitScene {
public:
    /// Builds the ray accelerator, O(n log n); nothing is lit yet.
    ///
    /// Throws:  std::invalid_argument for a transfer of other receivers, and for clusters_only with
    ///          a scene that has no clusters.
    explicit LitScene(Scene scene, const LightOptions& options = {});
    /// Shares the scene with others, each in a light of its own.
    explicit LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options = {});
    ~LitScene();
    LitScene(LitScene&&) noexcept;
    LitScene& operator=(LitScene&&) noexcept;

    [[nodiscard]] const Scene& scene() const;
    /// False for unclustered_scene().
    [[nodiscard]] bool has_clusters() const;
    /// Rays against the mesh, as pictures show it.
    [[nodiscard]] const prt::RayScene& rays() const;
    /// What blocks the light: the mesh, or Scene::blockers.
    [[nodiscard]] const prt::RayScene& blockers() const;
    /// Returns what tracing single lights needs: the rays with the scene's own bias and tolerance.
    /// Empty for clusters_only. The result points into this object.
    [[nodiscard]] relight::ShadowRays shadow_rays() const;

    /// Lights the scene with an environment [JN, Eq. 8], of any resolution. Layers stay over it.
    ///
    /// Throws:  std::invalid_argument for a map without texels, radiance that is not finite or
    ///          negative, a scene without clusters; nothing has changed then.
    /// Cost:    milliseconds, see docs/measurements.md.
    RelightTimes light(cubemap::CubeMap environment);
    RelightTimes light(Environment environment);

    /// Replaces the environment under the layers by another of the same resolution, and updates
    /// only what differs.
    ///
    /// Throws:  as light().
    UpdateReport update(Environment environment);

    /// Sums an environment into the scene's clusters, for light(). An environment that comes again
    /// need not be summed again.
    ///
    /// Throws:  as light().
    /// Cost:    O(6 R^2). What is returned holds the map; copies of it share the map.
    [[nodiscard]] BinnedEnvironment bin(std::shared_ptr<const cubemap::CubeMap> environment) const;
    [[nodiscard]] BinnedEnvironment bin(cubemap::CubeMap environment) const {
        return bin(std::make_shared<const cubemap::CubeMap>(std::move(environment)));
    }

    /// Lights the scene with an environment that bin() of this scene has summed. Clusters whose
    /// light stays are not summed again, so the last bits may differ from light() of the map. The
    /// file's pixels are what pictures show behind the mesh.
    ///
    /// Throws:  std::invalid_argument for an environment of another scene.
    void light(BinnedEnvironment environment, const cubemap::EnvironmentFile& file = {});

    /// Lights the scene with distant lights alone, each with shadow rays of its own or, with
    /// clusters_only, through its cluster. The environment and its layers go; the background is
    /// black.
    ///
    /// Throws:  std::invalid_argument for irradiance that is not finite or negative, a direction
    ///          that is not of unit length.
    RelightTimes light(std::span<const lights::DistantLight> lights);

    /// Replaces a rectangle of the environment's texels, row by row [(x1 - x0) * (y1 - y0)], and
    /// updates what depends on it [JN, Section 5.2]. Under layers, the environment is what was
    /// given to light(), and finding what changed costs a comparison of the whole map.
    ///
    /// Throws:  std::invalid_argument for a rectangle outside of the face, a wrong size, radiance
    ///          that is not finite or negative, or no environment; nothing has changed then.
    UpdateReport update_region(const cubemap::TexelRectangle& rectangle,
                               std::span<const glm::vec3> radiance);

    /// Replaces the light layers over the environment, bottom first, in one update.
    ///
    /// Throws:  std::invalid_argument for a layer that is not valid, radiance that is too large, or
    ///          no environment; nothing has changed then.
    /// Cost:    proportional to what the changed layers cover. The first call relights everything
    ///          once more.
    UpdateReport set_layers(std::vector<cubemap::LightLayer> layers);

    /// Replaces one layer, as while it is dragged.
    ///
    /// Throws:  as set_layers(); std::out_of_range for an index.
    UpdateReport set_layer(std::size_t index, const cubemap::LightLayer& layer);

    /// Returns the editor, which has undo and redo, rotation, and snapshots for other threads. It
    /// takes over the environment. A call of light() with a light list destroys the editor.
    ///
    /// Throws:  std::invalid_argument for a scene without clusters.
    [[nodiscard]] relight::LightEditor& editor();

    /// Outgoing radiance, [num_receivers] in the receivers' order, in the unit of the
    /// environment's; without materials for albedo 1. Empty before the first light().
    [[nodiscard]] std::span<const glm::vec3> radiance() const;

    /// What lights the scene, layers included; black under a light list, without texels before the
    /// first light().
    [[nodiscard]] const cubemap::CubeMap& environment() const;

    /// Returns the Relighter inside, for functions of relight/ that take one: contribution_map(),
    /// transfer_lights().
    ///
    /// Throws:  std::logic_error before the first light() and for a scene without clusters.
    [[nodiscard]] const relight::Relighter& relighter() const;

    /// Adds the light that surfaces send to each other to radiance() and lighting(), all of its
    /// bounces or so many. It is for the present light: light() takes it away until the next call.
    /// Updates and layers show their direct light with the bounces of the light before, until the
    /// next call here or of editor().settle() or step(). Surfaces are Lambert for it; what mirrors
    /// would show of other surfaces is left out.
    ///
    /// `albedo` is [num_receivers] what pictures multiply the radiance with, as bounce_albedo().
    /// Radiance stays that of the receivers' own surfaces, or for albedo 1. `more` is direct light
    /// for albedo 1, [num_receivers], that bounces as well but is no part of radiance() itself.
    ///
    /// Throws:  std::invalid_argument for a scene without bounces, and as
    ///          relight::BounceLight::set_albedo(); std::logic_error before the first light().
    /// Cost:    milliseconds, see docs/measurements.md.
    BounceReport bounce(std::span<const glm::vec3> albedo, const BounceLimits& limits = {},
                        std::span<const glm::vec3> more = {});

    /// The part of radiance() that bounce() added, [num_receivers]; empty without it.
    [[nodiscard]] std::span<const glm::vec3> bounced() const;

    /// Compares the radiance with exact integration, every shadow ray traced. Under an Environment
    /// from a file, its own pixels are integrated, each as a small area: so the error includes that
    /// of resampling. Under a map, or when layers or updates changed the environment, the map's
    /// texels are. After bounce() its light is compared with a path tracer, which shares nothing
    /// but the rays.
    ///
    /// Throws:  std::logic_error unless an environment lights the scene; Cancelled.
    /// Cost:    half a million rays for each receiver, or 6 R^2: seconds for 2000 of them.
    [[nodiscard]] Verification verify(const VerifyOptions& options = {}) const;

    /// What lights these receivers: the environment, each texel weighted by how much of it they
    /// reflect, in radiance per sr.
    ///
    /// Throws:  std::invalid_argument for no receivers or an index out of range; std::logic_error
    ///          unless an environment lights the scene.
    [[nodiscard]] cubemap::CubeMap contribution_map(std::span<const std::uint32_t> receivers) const;

    /// Returns what a region gives to the scene, as if the rest of the environment were black.
    ///
    /// Throws:  std::invalid_argument for a region that is not valid; std::logic_error as above.
    [[nodiscard]] Share lit_by(const cubemap::Region& region) const;

    /// Returns what a picture is drawn of. It points into this object, and is good until the light
    /// changes.
    ///
    /// Throws:  std::logic_error before the first light().
    [[nodiscard]] Lighting lighting() const;

    /// The scene in its light. For many pictures of one view see Painter.
    ///
    /// Throws:  as Painter; std::logic_error before the first light().
    [[nodiscard]] Picture draw(const OutputOptions& options = {}) const;

    /// Writes the lit scene by extension, as Painter::save().
    void save(const std::filesystem::path& path, const OutputOptions& options = {}) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine
