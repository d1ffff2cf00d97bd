#include "relight/sharp/cluster_sums.h"

#include <algorithm>

namespace relumine::relight {

VectorIrradiance ClusterSums::without_sharp(std::size_t cluster) const {
    VectorIrradiance rest = all[cluster];
    const auto first =
        std::lower_bound(sharp.begin(), sharp.end(), cluster,
                         [](const SharpLight& light, std::size_t c) { return light.cluster < c; });
    for (auto light = first; light != sharp.end() && light->cluster == cluster; ++light)
        rest -= light->irradiance;
    return rest;
}

} // namespace relumine::relight
