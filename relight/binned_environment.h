// An environment summed into the clusters of a scene, ready to relight it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/transfer.h"
#include "relight/cluster_lights.h"
#include "relight/sharp_lights.h"

namespace relumine::relight {

/// The brightest texel that sums over a whole sphere of it stay finite for, in float, with room to
/// spare.
inline constexpr float MaxRadiance = 1e30f;

/// Throws std::invalid_argument for a radiance that is NaN, negative or above MaxRadiance.
/// Parallel; at the speed of memory.
void require_radiance(std::span<const glm::vec3> texels);

/// All that relighting needs of an environment.
struct BinnedEnvironment {
    cubemap::CubeMap map;
    /// Of the map's resolution
    std::shared_ptr<const LightBinning> binning;
    /// [num_clusters] all light of each cluster
    std::vector<VectorIrradiance> sums;
    /// [num_clusters] length of its luminance
    std::vector<double> powers;
    /// None where they are not traced
    std::vector<SharpLight> sharp_lights;
    double seconds_bin = 0.0;
    /// Finding the sharp lights
    double seconds_sharp = 0.0;
};

/// Bins environments for one scene, apart from the Relighter: the next frame of a sequence may be
/// binned on another thread while this one is relit.
class EnvironmentBinner {
public:
    /// The transfer must outlive it. `sharp_tolerance`: ShadowRays::tolerance where sharp lights
    /// are traced, 0 where not.
    EnvironmentBinner(const prt::Transfer& transfer, float sharp_tolerance)
        : transfer_(transfer), sharp_tolerance_(sharp_tolerance) {}
    /// Refuses a temporary transfer.
    EnvironmentBinner(const prt::Transfer&& transfer, float sharp_tolerance) = delete;

    /// O(6 R^2); parallel inside, the same bits for any number of threads. One thread at a time.
    /// Throws std::invalid_argument for a map without texels or a radiance that require_radiance()
    /// refuses.
    [[nodiscard]] BinnedEnvironment bin(cubemap::CubeMap map);

private:
    const prt::Transfer& transfer_;
    float sharp_tolerance_;
    std::shared_ptr<const LightBinning> binning_;
};

} // namespace relumine::relight
