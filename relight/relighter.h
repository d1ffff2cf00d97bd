// Relights a precomputed scene: full relighting and updates of a part of the environment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/texel_rectangle.h"
#include "lights/light_list.h"
#include "prt/glossy/lobes.h"
#include "prt/transfer/transfer.h"
#include "relight/binned_environment.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::prt {
struct SceneChange;
} // namespace relumine::prt

namespace relumine::relight {

using cubemap::TexelRectangle;

/// The effect of new light.
struct UpdateReport {
    /// Clusters whose light was summed anew.
    std::size_t num_clusters = 0;
    /// Receivers that see any of these clusters, counted in whole blocks of 16.
    std::size_t num_receivers = 0;
    /// After an update those that were traced: where none stood before.
    std::size_t num_sharp_lights = 0;
    double seconds = 0.0;
    // Parts of `seconds`, where they are known.
    /// Summing the environment into clusters.
    double seconds_bin = 0.0;
    /// Finding sharp lights and tracing their shadow rays; next to nothing where there are none.
    double seconds_trace = 0.0;
    /// Summing the clusters into radiance [JN, Eq. 8].
    double seconds_relight = 0.0;
    /// Finding the light of a whole scene's lamps, and what highlights of receivers mirror by rays
    /// (LitScene).
    double seconds_lamps = 0.0;
    double seconds_highlights = 0.0;
    /// All clusters were summed, because that was less work.
    bool resummed = false;
    /// Rectangles of an edited scene, without overlaps, that hold every texel that changed; good
    /// until the next edit.
    std::span<const TexelRectangle> texels = {};
};

class ReceiverLight;

/// Keeps the direct light of receivers under an environment that may change.
///
/// Threads: parallel inside (TBB); every result is the same bit by bit for any number of threads.
///          One thread at a time may call functions that are not const.
class Relighter {
public:
    /// The transfer must outlive the Relighter. With shadow rays, lights that are too small for
    /// their cluster are traced. Without them, all light goes through the clusters.
    ///
    /// Memory:  about 1 KB per block of 16 receivers.
    /// With `harmonics`, 1 to 3, the arriving light is kept as spherical harmonics of this order,
    /// too. Radiance of points without a surface is the mean radiance over the sphere: the fluence
    /// over 4 pi.
    explicit Relighter(const prt::Transfer& transfer, const ShadowRays& rays = {},
                       std::uint32_t harmonics = 0);
    /// Refuses a temporary transfer, which would not outlive the Relighter.
    explicit Relighter(const prt::Transfer&& transfer, const ShadowRays& rays = {},
                       std::uint32_t harmonics = 0) = delete;
    ~Relighter();
    Relighter(Relighter&&) noexcept;

    /// Lights all receivers [JN, Eq. 8]. The map may have any resolution: clusters are cells of the
    /// continuous sphere.
    ///
    /// Cost:    O(6 R^2 + size of the transfer).
    /// Throws:  std::invalid_argument for a map without texels, or a radiance that
    ///          require_radiance() refuses.
    UpdateReport set_environment(cubemap::CubeMap environment);
    /// With a map that others hold, too. The first update copies it.
    UpdateReport set_environment(std::shared_ptr<const cubemap::CubeMap> environment);

    /// Gives the map's memory away, for the next map to be written in: new memory takes longer than
    /// to write it. Until return_environment() or new light the map must not be asked for. Returns
    /// a map without texels where others hold it, too.
    [[nodiscard]] cubemap::CubeMap lend_environment();
    /// Takes back a map with the same texels.
    void return_environment(cubemap::CubeMap environment);

    /// Takes the next frame of a sequence, binned by an EnvironmentBinner of the same transfer and
    /// ShadowRays::tolerance (0 without shadow rays).
    ///
    /// A cluster is updated only if its vector irradiance differs from its present light. Sharp
    /// lights are traced only if any changed.
    ///
    /// The radiance equals the result of set_environment() to 1e-5 relative, as after
    /// update_region(). Where many clusters changed, or there was no environment, all clusters are
    /// summed. The radiance is then bit by bit the result of set_environment().
    ///
    /// Throws:  std::invalid_argument for an environment binned for another scene.
    UpdateReport set_frame(BinnedEnvironment frame);

    /// Lights all receivers with distant lights in place of an environment. Each light gets one
    /// shadow ray per receiver, or its cluster's visible counts where there are no shadow rays.
    /// Afterwards there is no environment to update.
    ///
    /// Throws:  std::invalid_argument for irradiance that require_radiance() refuses, or a
    ///          direction that is not of unit length.
    UpdateReport set_lights(std::span<const lights::DistantLight> lights);

    /// Updates several rectangles at once; they may overlap. `edit` changes texels of the
    /// environment, inside the rectangles only. Its radiance must be finite and >= 0, which is not
    /// checked here.
    ///
    /// Throws:  std::invalid_argument for a rectangle outside the face, or no environment; nothing
    ///          has changed then.
    UpdateReport update_regions(std::span<const TexelRectangle> rectangles,
                                const std::function<void(cubemap::CubeMap&)>& edit);

    /// Takes a move of a group of the scene (prt/moves/scene_change.h), or its undo: transfer and
    /// shadow rays have changed. The radiance is then bit by bit that of another Relighter of the
    /// scene as it stands, under the same light.
    ///
    /// Cost:    only blocks of receivers whose counts, normals or sharp lights differ are summed
    ///          anew, unless there were updates, harmonics or points.
    void follow(const prt::SceneChange& change);

    /// Sums all clusters anew. After updates the radiance equals a full relighting except for the
    /// last bits. After this call it is bit by bit the result of set_environment() of the same map.
    ///
    /// Cost:    a relighting without the binning.
    void resum();

    /// Outgoing radiance in the environment's unit. With surfaces in the transfer, it is the
    /// radiance towards the eye where the transfer has a glossy part. Without surfaces it is for
    /// albedo 1.
    ///
    /// Shape:   [num_receivers] in the receivers' own order.
    [[nodiscard]] std::span<const glm::vec3> radiance() const;

    /// Radiance as if every receiver were Lambert of albedo 1: irradiance over pi.
    ///
    /// Shape:   [num_receivers] in the receivers' own order.
    [[nodiscard]] std::span<const glm::vec3> diffuse_radiance() const;

    /// Returns the light that arrives at each receiver, as spherical harmonics
    /// (docs/harmonics.md). Coefficients of surfaces are bound to diffuse_radiance(): at the
    /// surface's own normal their irradiance() is pi times that, as exactly as floats can say.
    ///
    /// Shape:   [num_receivers][order^2], receivers in their own order.
    /// Throws:  std::logic_error for a Relighter without harmonics.
    /// Cost:    O(receivers).
    [[nodiscard]] std::vector<glm::vec3> harmonics() const;

    /// Returns the radiance (albedo 1) of a surface that nothing shades: all light of each cluster,
    /// the sharp lights' included.
    [[nodiscard]] glm::dvec3 open_radiance(const glm::vec3& normal) const;

    /// Without texels under set_lights() and before the first light.
    [[nodiscard]] const cubemap::CubeMap& environment() const { return *environment_; }

    [[nodiscard]] const prt::Transfer& transfer() const { return transfer_; }
    /// What the radiance is summed from: for the other rooms of this folder.
    [[nodiscard]] const ReceiverLight& receiver_light() const { return *light_; }
    /// How environment() is summed into clusters; null where there is none.
    [[nodiscard]] const LightBinning* binning() const { return binning_.get(); }
    /// Returns the light of a cluster without its sharp lights.
    [[nodiscard]] VectorIrradiance cluster_light(std::size_t cluster) const;
    [[nodiscard]] std::span<const SharpLight> sharp_lights() const { return sharp_lights_; }
    [[nodiscard]] const ShadowRays& shadow_rays() const { return rays_; }

private:
    void hold_own(std::shared_ptr<cubemap::CubeMap> map);
    UpdateReport light_by(BinnedEnvironment binned, std::shared_ptr<cubemap::CubeMap> own);
    std::optional<std::size_t> replace_sharp_lights(std::vector<SharpLight> lights);
    void set_cells();
    void sum_all(UpdateReport& report);

    const prt::Transfer& transfer_;
    ShadowRays rays_;
    /// [num_clusters] all light of each cluster.
    std::vector<VectorIrradiance> sums_;
    /// [num_clusters] power of each cluster: the length of its luminance vector.
    std::vector<double> powers_;
    std::vector<SharpLight> sharp_lights_;
    EnvironmentBinner binner_;
    /// For environment_.
    std::shared_ptr<const LightBinning> binning_;
    std::shared_ptr<const cubemap::CubeMap> environment_ =
        std::make_shared<const cubemap::CubeMap>();
    /// environment_ for updates; null where others may hold it, too.
    std::shared_ptr<cubemap::CubeMap> own_environment_;
    std::unique_ptr<ReceiverLight> light_;
    /// Scratch: clusters whose light changes.
    std::vector<std::uint32_t> changed_;
};

/// Binds coefficients of surfaces to their radiance for albedo 1, as Relighter::harmonics() does;
/// points stay as they are.
///
/// Shape:   radiance is [num_receivers], harmonics [num_receivers][order^2], in the receivers' own
///          order.
void bind_to(const prt::Transfer& transfer, std::span<const glm::vec3> radiance,
             std::span<glm::vec3> harmonics);

/// Checks what is to replace a rectangle of a map.
///
/// Throws:  std::invalid_argument for a rectangle outside the face, a map without texels, a wrong
///          size, a radiance that require_radiance() refuses.
void require_texels(const TexelRectangle& rectangle, std::span<const glm::vec3> radiance,
                    const cubemap::CubeMap& map);
/// Writes the texels of a rectangle, row by row.
void put_texels(const TexelRectangle& rectangle, std::span<const glm::vec3> radiance,
                cubemap::CubeMap& map);

/// Replaces a rectangle of the environment and updates the radiance [JN, Section 5.2, Eq. 15].
/// The result equals set_environment() of the changed map to 1e-5 relative, after any number of
/// updates.
///
/// Shape:   radiance is [(x1 - x0) * (y1 - y0)], row by row.
/// Cost:    proportional to the transfer of the clusters under the rectangle. The first update
///          after set_frame() copies the map, because others may hold it.
/// Throws:  std::invalid_argument for a rectangle outside the face, a wrong size, a radiance
///          that require_radiance() refuses, or no environment; nothing has changed then.
UpdateReport update_region(Relighter& relighter, const TexelRectangle& rectangle,
                           std::span<const glm::vec3> radiance);

/// Returns the sharp lights, for a picture to trace at every point, merged to at most 64 where an
/// environment has more. Returns none where so few would not do: the shadows of so many lights are
/// soft, and the picture would take half a minute.
[[nodiscard]] std::vector<SharpLight> picture_lights(const Relighter& relighter);

/// Returns what bins environments for set_frame(). The Relighter's transfer must outlive it.
[[nodiscard]] EnvironmentBinner binner_of(const Relighter& relighter);

/// Returns the radiance of all receivers under an environment, in one call, as
/// Relighter::radiance().
[[nodiscard]] std::vector<glm::vec3> relight(const prt::Transfer& transfer,
                                             const cubemap::CubeMap& environment,
                                             const ShadowRays& rays = {});

} // namespace relumine::relight
