// An environment summed into the clusters of a scene, ready to relight it.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "cubemap/cube_map.h"
#include "prt/transfer/transfer.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/radiance.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

/// Everything that relighting needs of an environment. Copies share the map.
struct BinnedEnvironment {
    std::shared_ptr<const cubemap::CubeMap> map;
    /// For the map's resolution.
    std::shared_ptr<const LightBinning> binning;
    /// [num_clusters] all light of each cluster.
    std::vector<VectorIrradiance> sums;
    /// [num_clusters] power of each cluster: the length of its luminance vector.
    std::vector<double> powers;
    /// Empty where sharp lights are not traced.
    std::vector<SharpLight> sharp_lights;
    double seconds_bin = 0.0;
    /// Time for finding the sharp lights.
    double seconds_sharp = 0.0;
};

/// Bins environments for one scene, apart from the Relighter. So another thread can bin the next
/// frame of a sequence while the current one is relit.
class EnvironmentBinner {
public:
    /// The transfer must outlive the binner. `sharp_tolerance` is ShadowRays::tolerance where sharp
    /// lights are traced, otherwise 0.
    EnvironmentBinner(const prt::Transfer& transfer, float sharp_tolerance)
        : transfer_(transfer), sharp_tolerance_(sharp_tolerance) {}
    /// Refuses a temporary transfer.
    EnvironmentBinner(const prt::Transfer&& transfer, float sharp_tolerance) = delete;

    /// Bins an environment.
    ///
    /// Cost:    O(6 R^2); parallel inside.
    /// Threads: one call at a time. The same bits for any number of threads inside.
    /// Throws:  std::invalid_argument for a map without texels, or a radiance that
    ///          require_radiance() refuses.
    [[nodiscard]] BinnedEnvironment bin(std::shared_ptr<const cubemap::CubeMap> map);
    [[nodiscard]] BinnedEnvironment bin(cubemap::CubeMap map) {
        return bin(std::make_shared<const cubemap::CubeMap>(std::move(map)));
    }

private:
    const prt::Transfer& transfer_;
    float sharp_tolerance_;
    std::shared_ptr<const LightBinning> binning_;
    std::shared_ptr<const BandSums> bands_;
};

} // namespace relumine::relight
