// Relights a precomputed scene: full relighting and updates of a part of the environment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/texel_rectangle.h"
#include "lights/light_list.h"
#include "prt/transfer.h"
#include "relight/binned_environment.h"
#include "relight/shadow_rays.h"
#include "relight/sharp_lights.h"

namespace relumine::relight {

using cubemap::TexelRectangle;

struct ClusterLights;

/// Where the time of set_environment() went.
struct RelightTimes {
    /// Summing the environment into clusters
    double seconds_bin = 0.0;
    /// Summing the clusters into radiance [JN, Eq. 8]
    double seconds_relight = 0.0;
    /// Finding sharp lights and tracing their shadow rays; next to nothing where there are none
    double seconds_trace = 0.0;
    std::size_t num_sharp_lights = 0;
};

/// What an update did.
struct UpdateReport {
    /// Whose light was summed anew
    std::size_t num_clusters = 0;
    /// That see any of them (counted in whole blocks of 16)
    std::size_t num_receivers = 0;
    /// Traced anew; 0 where the edit changed none
    std::size_t num_sharp_lights = 0;
    double seconds = 0.0;
    /// Of them, tracing sharp lights
    double seconds_trace = 0.0;
    /// All clusters were summed, as that was less work
    bool resummed = false;
};

/// Keeps the light of a scene's receivers under an environment that may change. Parallel inside
/// (TBB); every result is the same bit by bit for any number of threads. One thread at a time may
/// call anything that is not const.
class Relighter {
public:
    /// The transfer must outlive the Relighter. With shadow rays, lights too small for their
    /// cluster are traced; without, all light goes through the clusters. Memory: about 1 KB per
    /// block of 16 receivers.
    explicit Relighter(const prt::Transfer& transfer, const ShadowRays& rays = {});
    /// Refuses a temporary transfer, which would not outlive the Relighter.
    explicit Relighter(const prt::Transfer&& transfer, const ShadowRays& rays = {}) = delete;
    ~Relighter();
    Relighter(Relighter&&) noexcept;
    Relighter& operator=(Relighter&&) noexcept;

    /// Lights all receivers [JN, Eq. 8]. Any resolution: clusters are cells of the continuous
    /// sphere. O(6 R^2 + size of the transfer). Throws std::invalid_argument for a map without
    /// texels or a radiance that require_radiance() refuses.
    RelightTimes set_environment(cubemap::CubeMap environment);

    /// The next frame of a sequence, binned by an EnvironmentBinner of the same transfer and
    /// ShadowRays::tolerance (0 without shadow rays). Only clusters whose vector irradiance E
    /// differs from what they light the scene with by more than `bound` |E| are updated
    /// (|E|: Frobenius norm over the channels), sharp lights only where any changed. Unupdated
    /// clusters keep the light they had, and are compared with that, so errors do not add up over
    /// frames: each cluster's light is never off by more than the bound. With bound 0 the radiance
    /// equals that of set_environment() to 1e-5 relative, as after update_region(). Where many
    /// clusters changed, or there was no environment, all are summed: bit by bit set_environment().
    /// Throws std::invalid_argument for one binned for another scene, or a bound that is negative
    /// or NaN.
    UpdateReport set_frame(BinnedEnvironment frame, double bound = 0.0);

    /// Lights all receivers with distant lights in place of an environment: one shadow ray each,
    /// or, without shadow rays, each with its cluster's visible counts. There is no environment to
    /// update then. Throws std::invalid_argument for irradiance that require_radiance() refuses or
    /// a direction that is not of unit length.
    RelightTimes set_lights(std::span<const lights::DistantLight> lights);

    /// Replaces a rectangle of the environment's texels by `radiance`, row by row [(x1 - x0) * (y1
    /// - y0)], and updates what the clusters it touches contribute [JN, Section 5.2, Eq. 15]. Equal
    /// to set_environment() of the changed map to 1e-5 relative, however many updates went before.
    /// Throws std::invalid_argument for a rectangle that is not inside the face, a wrong size, a
    /// radiance as above, or no environment; nothing has changed then.
    UpdateReport update_region(const TexelRectangle& rectangle,
                               std::span<const glm::vec3> radiance);

    /// The general form: `edit` changes texels of the environment, inside the rectangles only (they
    /// may overlap), and what the clusters under them contribute is updated once. Radiance must
    /// stay finite and >= 0; it is not looked at here.
    UpdateReport update_regions(std::span<const TexelRectangle> rectangles,
                                const std::function<void(cubemap::CubeMap&)>& edit);

    /// Sums all clusters anew. Updates leave the radiance equal to a full relighting but for the
    /// last bits; after this it is bit by bit what set_environment() of the same map gives. Costs a
    /// relighting without the binning.
    void resum();

    /// Outgoing radiance, [num_receivers] in the receivers' own order; the unit of the
    /// environment's radiance. With the transfer's surfaces, toward the eye where it has a glossy
    /// part; for albedo 1 where it has none.
    [[nodiscard]] std::span<const glm::vec3> radiance() const;

    [[nodiscard]] const cubemap::CubeMap& environment() const;

    [[nodiscard]] const prt::Transfer& transfer() const;
    /// Clusters' light without the sharp lights.
    [[nodiscard]] const ClusterLights& cluster_lights() const;
    [[nodiscard]] std::span<const SharpLight> sharp_lights() const;
    [[nodiscard]] const ShadowRays& shadow_rays() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// The one-call form: radiance of all receivers under an environment, albedo 1.
[[nodiscard]] std::vector<glm::vec3> relight(const prt::Transfer& transfer,
                                             const cubemap::CubeMap& environment,
                                             const ShadowRays& rays = {});

} // namespace relumine::relight
