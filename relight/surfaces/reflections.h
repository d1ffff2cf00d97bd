// What glossy surfaces mirror, found by rays from the points that a picture shows: any eye, and
// other surfaces in the mirror.
//
// Based on: E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018 (directions);
// J. Krivanek and M. Colbert, "Real-time Shading with Filtered Importance Sampling", EGSR 2008 (a
// ray that leaves sees the mean over half of its share of the lobe).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/glossy/lobes.h"
#include "prt/receivers/surface.h"
#include "prt/visibility/ray_scene.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

struct LobeRays;
struct RayFan;

/// A point that mirrors.
struct MirrorPoint {
    glm::vec3 position;
    /// Unit length, as `to_eye`. A coat has that of its surface, if it has one.
    glm::vec3 normal;
    glm::vec3 to_eye;
    /// Shifts the rays against those of other points, in [0, 1)^2.
    glm::vec2 shift;
};

/// Returns a shift for the rays of point i, far from those of the points before and after: Roberts'
/// R2 sequence.
[[nodiscard]] glm::vec2 ray_shift(std::uint64_t i);

/// Mean radiance in a highlight's lobes, which points of nearly the same normal share.
struct MirroredLight {
    /// Weighted by S and by Sc (prt/glossy/brdf.h).
    glm::vec3 all{0.0f}, grazing{0.0f};
    /// What S sends of a white sky, as the rays found it.
    float whole = 0.0f;
    /// Weighted by the lobes of a clear coat and of sheen.
    glm::vec3 coat{0.0f}, sheen{0.0f};
};

/// Returns the light through all lobes but the diffuse ones. Exact for GGX, measured BRDFs, coats
/// and sheen under a sky of one radiance: what their lobes send of it is known. A measured BRDF and
/// a film have their blue in the place of Dc.
[[nodiscard]] prt::Lobes<glm::vec3>
lobes_of(const prt::Surface& surface, const MirroredLight& light, const prt::EyeCosines& n_v);

/// A surface that a ray of a highlight meets.
struct MetSurface {
    const prt::Hit& hit;
    const glm::vec3& direction;
    /// What the ray stands for, in sr.
    float solid_angle = 0.0f;
    /// About half of the lobe that the surface is seen through, in sr.
    float half_lobe = 0.0f;
    /// Which ray of a fan it is, of how many, and MirrorPoint::shift of the fan
    std::uint32_t ray = 0, num_rays = 1;
    glm::vec2 fan_shift{0.0f};
    /// How many mirrors the light comes by, from this surface to the eye.
    std::uint32_t num_mirrors = 1;
};

/// Returns for how many rays of its fan this one asks what the surface mirrors that it met: those
/// in between take it for matte. 0: it does not ask. A metal is asked by all rays, what mirrors
/// little by fewer than 32. What the first mirror shows asks, and behind that metals, until light
/// has come by MostMirrors.
[[nodiscard]] std::uint32_t asked_for(const MetSurface& met, const prt::Surface& surface);

/// What so many mirrors show one in the other is matte.
inline constexpr std::uint32_t MostMirrors = 4;

class Reflections {
public:
    /// Returns the radiance of a surface that a ray meets. A ray that passes sees the mean of sky()
    /// over its solid angle.
    using Surfaces = std::function<glm::vec3(const MetSurface& met)>;

    /// `without` are lights of the environment that are lit in another way: they are not mirrored.
    /// `environment` may have no texels, which is black. `bias` is that of prt::PrecomputeOptions.
    /// The rays must outlive this object.
    ///
    /// Cost:    O(texels): a third more than a copy of the environment, with lights twice as much,
    ///          and a look at each texel of all levels but the first, with its neighbours.
    Reflections(const prt::RayScene& rays, float bias, std::uint32_t num_rays,
                const cubemap::CubeMap& environment, std::span<const SharpLight> without);

    /// Returns what the highlight, the coat and the sheen mirror: black for Highlight::None, and
    /// for points that look away from the eye.
    ///
    /// Cost:    num_rays rays, twice as many for a wide lobe; half as many for a coat, and twice as
    ///          many for sheen.
    /// Threads: any.
    [[nodiscard]] MirroredLight light(const prt::Surface& surface, const MirrorPoint& point,
                                      std::uint32_t num_rays, const Surfaces& surfaces) const;

    /// Returns what a surface sends on that a ray of a highlight met: of its diffuse light, which
    /// is the radiance of albedo 1, and of what it mirrors itself, which a ray of each lobe finds.
    /// All lights of the environment are in it, blurred over half of the lobe that the surface is
    /// seen through.
    ///
    /// Cost:    1 to 3 rays, and what `surfaces` asks.
    /// Threads: any.
    [[nodiscard]] glm::vec3 in_mirror(const MetSurface& met, const prt::Surface& surface,
                                      const glm::vec3& position, const glm::vec3& normal,
                                      const glm::vec3& diffuse, const Surfaces& surfaces) const;

    /// Returns the mean radiance of the environment around a direction, but of the lights that it
    /// is without.
    [[nodiscard]] glm::vec3 sky(const glm::vec3& direction, float solid_angle) const;

    /// Returns the mean over a parallelogram around a direction, which may be long and thin, and
    /// over `solid_angle` at least. Its sides are parts of a radian.
    ///
    /// Cost:    a look where the environment is even, else up to eight.
    [[nodiscard]] glm::vec3 sky(const glm::vec3& direction, glm::vec3 side, glm::vec3 other_side,
                                float solid_angle) const;

    [[nodiscard]] std::uint32_t num_rays() const { return num_rays_; }

    /// Returns the least roughness of highlights of lights that are points: they stand for cells of
    /// the environment, and a narrower lobe would show them one by one.
    [[nodiscard]] float least_roughness() const { return least_roughness_; }

private:
    /// The environment at R, R / 2, .. texels along an edge.
    using Levels = std::vector<cubemap::CubeMap>;
    /// Whether the light of a texel of a level and of those around it is even: one look tells its
    /// mean.
    struct Evenness {
        std::uint32_t resolution = 0;
        std::vector<std::uint8_t> is_even; // [6 x resolution x resolution]
        /// `finer` has the same map three levels finer, or the finest there is.
        Evenness(const cubemap::CubeMap& level, const cubemap::CubeMap& finer);
        [[nodiscard]] bool at(const glm::vec3& direction) const;
    };
    /// What rays see that leave, how wide they are at least, and how many mirrors the light comes
    /// by.
    struct Behind {
        const Levels& levels;
        float least_solid_angle = 0.0f;
        std::uint32_t num_mirrors = 1;
    };
    [[nodiscard]] static std::size_t level_of(const Levels& levels, float solid_angle);
    [[nodiscard]] static glm::vec3 mean(const Levels& levels, const glm::vec3& direction,
                                        float solid_angle);
    [[nodiscard]] MirroredLight sum(const prt::Surface& surface, const MirrorPoint& point,
                                    const LobeRays& rays, const Surfaces& surfaces,
                                    const Behind& behind) const;
    /// Whether one look cannot tell the mean about a direction.
    [[nodiscard]] bool has_detail(const glm::vec3& direction, float solid_angle) const;
    /// Calls add(direction, density of rays there, radiance) for each ray of a fan. Where one that
    /// leaves would see detail, it does so for 16 looks into its part of the lobe: one of the whole
    /// part's size has the shape of no part, and its error is grain.
    template<typename Add>
    void send(const glm::vec3& origin, const RayFan& fan, const Surfaces& surfaces,
              const Behind& behind, const Add& add) const;

    const prt::RayScene& rays_;
    float bias_;
    std::uint32_t num_rays_;
    float least_roughness_ = 0.0f;
    /// Without the lights
    Levels levels_;
    /// The evenness of levels 1 and on
    std::vector<Evenness> evenness_;
    /// With the lights, from a resolution on that is enough for what is mirrored twice. Empty:
    /// there are no lights.
    Levels whole_;
};

/// Returns the alpha of the GGX lobe that is about as wide as a surface's highlight, where it is
/// narrowest.
[[nodiscard]] float lobe_alpha(const prt::Surface& surface);

/// Returns an environment whose cells give no more than what the lights leave.
[[nodiscard]] cubemap::CubeMap without_lights(cubemap::CubeMap environment,
                                              std::span<const SharpLight> lights);

} // namespace relumine::relight
