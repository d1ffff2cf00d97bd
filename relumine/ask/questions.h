// Questions about the light of a scene: how right it is, and where it comes from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "prt/receivers/mesh_point.h"
#include "prt/work.h"
#include "relight/reference/exact.h"
#include "relight/sharp/sharp_lights.h"
#include "relumine/light/lighting.h"
#include "relumine/light/lit_scene.h"
#include "relumine/light/live_eye.h"
#include "relumine/out/output_options.h"

namespace relumine {

struct VerifyOptions {
    /// Receivers chosen at random, 0 for all
    std::size_t num_samples = 2000;
    std::uint64_t seed = 1;
    /// Points of the surface chosen at random, evenly by area, where the light is compared that a
    /// renderer would interpolate from the vertices; 0 for none. Only for vertices.
    std::size_t num_surface_points = 500;
    /// Paths of each receiver that bounces and lamps are compared with; only after bounce(), and of
    /// scenes with lamps
    std::uint32_t num_paths = 256;
    /// Where the scene has live highlights (relumine/light/live_eye.h): light towards this eye is
    /// compared, at the vertices alone and without bounces, and how its cuts are made.
    std::optional<glm::vec3> eye = {};
    EyeOptions eye_options = {};
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
    /// The light at points that a picture of the whole mesh shows, as it shows them: lights that it
    /// traces pixel by pixel are traced. At most num_surface_points. Only for vertices.
    std::optional<Surface> picture = {};
    /// Standard error of the paths that bounces were compared with, relative to the radiance, L2
    /// over the receivers; it is a part of error.relative_l2. 0 without bounces.
    double noise = 0.0;
    /// Whether the pixels of the environment's file were integrated, not the texels of the map
    bool of_file = false;
    /// LiveEye::num_too_smooth(), of light towards an eye
    std::size_t num_too_smooth = 0;
};

/// The parts of a verification, as people say them.
inline constexpr std::array<std::string_view, 3> VerifiedPlaces = {
    "at the vertices", "between the vertices", "in a picture of the whole mesh"};

/// The largest relative L2 error of the parts.
struct WorstError {
    double relative_l2 = 0.0;
    std::string_view place = VerifiedPlaces[0];
};
[[nodiscard]] WorstError worst_of(const Verification& verification);

/// What a part of the environment gives to a scene.
struct Share {
    /// [num_receivers], albedo 1
    std::vector<glm::vec3> radiance;
    /// The environment times the region's coverage: black outside of the region.
    cubemap::CubeMap environment;
    /// The part of the scene's reflected light that comes from the region, 0 to 1.
    double share = 0.0;
    /// The lights that are traced one by one, and [num_receivers] radiance without them (Lighting).
    std::vector<relight::SharpLight> lights = {};
    std::vector<glm::vec3> soft = {};

    /// Returns what a picture is drawn of. It points into this object.
    [[nodiscard]] Lighting lighting() const;
};

/// Compares the radiance with exact integration, every shadow ray traced. Under an Environment from
/// a file, its own pixels are integrated, each as a small area: so the error includes that of
/// resampling. Under a map, or when edits changed the environment, the map's texels are. After
/// bounce() its light is compared with a path tracer, which shares nothing but the rays. Processes
/// that share the work have the whole scene in the same light: each integrates some of the points,
/// and all get the same result.
///
/// Throws:  std::logic_error unless an environment lights the scene; Cancelled;
///          std::invalid_argument for an eye where there are no live highlights, or other light
///          than the environment's.
/// Cost:    130,000 rays for each receiver, or 6 R^2: seconds for 2000 of them.
[[nodiscard]] Verification verify(const LitScene& lit, const VerifyOptions& options = {},
                                  const prt::Work& work = {});

/// What lights these receivers: the environment, each texel weighted by how much of it they
/// reflect, in radiance per sr.
///
/// Throws:  std::invalid_argument for no receivers or an index out of range; std::logic_error
///          unless an environment lights the scene.
[[nodiscard]] cubemap::CubeMap contribution_map(const LitScene& lit,
                                                std::span<const std::uint32_t> receivers);

/// Returns the derivative of a number by the environment's texels, given its derivative by
/// radiance(): the transpose T* of a relight, at two to three times its cost. After bounce() light
/// that bounces counts. The environment is environment_of(): with its layers and its turn.
/// docs/operator.md
///
/// Shape:   weights is [num_receivers] in the receivers' order.
/// Throws:  std::invalid_argument for another number of weights, weights that are not finite, and
///          receivers with highlights; std::logic_error unless an environment lights the scene.
[[nodiscard]] cubemap::CubeMap adjoint(const LitScene& lit, std::span<const glm::vec3> weights);

/// Returns the derivative by the pixels of a lat-long in the world's axes, which becomes a cube
/// map, given the derivative by the map's texels: the transpose of cubemap::resample().
///
/// Shape:   [height * width].
/// Throws:  std::invalid_argument for a width or height of 0.
[[nodiscard]] std::vector<glm::vec3> lat_long_adjoint(const cubemap::CubeMap& by_texels,
                                                      std::uint32_t width, std::uint32_t height);

/// Returns adjoint(), given the derivative by the pixels of a scene of pixels: of draw() before
/// nothing, as linear radiance. The radiance of the receivers and the albedo of the options make
/// the picture.
///
/// Shape:   weights is [height * width] of the picture.
/// Throws:  as adjoint(), and std::invalid_argument for receivers that are no pixels and for a
///          scene with an added floor, which pictures may show in other ways.
[[nodiscard]] cubemap::CubeMap picture_adjoint(const LitScene& lit,
                                               std::span<const glm::vec3> weights,
                                               const OutputOptions& options = {});

/// Returns adjoint(), given the derivative by harmonics().
///
/// Shape:   weights is [num_receivers][order^2] in the receivers' order.
/// Throws:  as adjoint(), and std::logic_error for a scene without LightOptions::harmonics.
[[nodiscard]] cubemap::CubeMap harmonics_adjoint(const LitScene& lit,
                                                 std::span<const glm::vec3> weights);

/// Lights the scene with one environment after the other, and leaves its own light as it is. Direct
/// light, as it is after LitScene::light() of the map.
///
/// Shape:   radiance is [environments][num_receivers] in the receivers' order.
/// Throws:  as relight::relight_batch(), and std::invalid_argument for a scene without clusters.
void relight_batch(const LitScene& lit, std::span<const cubemap::CubeMap> environments,
                   std::span<glm::vec3> radiance);

/// Returns what a region gives to the scene, as if the rest of the environment were black.
///
/// Throws:  std::invalid_argument for a region that is not valid; std::logic_error as above.
[[nodiscard]] Share lit_by(const LitScene& lit, const cubemap::Region& region);

/// Whether the straight way from a receiver to a point in space is free: 1, else 0. A point behind
/// the receiver's surface is not seen.
///
/// Shape:   [num_receivers * points.size()], all points of the first receiver first.
/// Throws:  std::invalid_argument for a point that is not finite.
/// Cost:    num_receivers * points.size() rays; points that lie close together are cheap.
[[nodiscard]] std::vector<std::uint8_t> sees(const LitScene& lit,
                                             std::span<const glm::vec3> points);

/// Whether a point is inside of the mesh: in most directions it sees backs of surfaces. A small
/// hole, as of scans, does not matter; a room is open to its inside.
///
/// Cost:    64 rays.
[[nodiscard]] bool is_inside(const LitScene& lit, const glm::vec3& point);

/// Where a light stands for a point that is seen.
enum class Aim {
    /// In front of the surface: it lights the point most.
    Facing,
    /// Where the eye sees it mirrored in the surface: its highlight is at the point.
    Mirrored,
};

/// Returns the unit direction from the scene to a light that is aimed at the first surface on a
/// ray; nothing where the ray meets none. Of a surface that is seen from behind, the side that is
/// seen counts.
[[nodiscard]] std::optional<glm::vec3> light_direction(const LitScene& lit, const glm::vec3& eye,
                                                       const glm::vec3& view_direction, Aim aim);

} // namespace relumine
