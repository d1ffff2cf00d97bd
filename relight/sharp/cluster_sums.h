// The light of an environment or a list, by clusters.
#pragma once

#include <cstddef>
#include <span>

#include "relight/kernels/cluster_lights.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

struct ClusterSums {
    /// [num_clusters] all light of each cluster.
    std::span<const VectorIrradiance> all;
    /// The part of it that is traced, clusters ascending.
    std::span<const SharpLight> sharp;

    /// Returns the light of a cluster: all light of its cell minus the sharp lights in it.
    [[nodiscard]] VectorIrradiance without_sharp(std::size_t cluster) const;
};

} // namespace relumine::relight
