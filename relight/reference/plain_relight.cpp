#include "relight/reference/plain_relight.h"

#include <cstddef>
#include <numbers>

#include <glm/common.hpp>

#include "prt/clusters/lattice.h"

namespace relumine::relight {

std::vector<glm::vec3> plain_relight(const prt::Transfer& transfer,
                                     const cubemap::CubeMap& environment,
                                     const ClusterIrradiance& irradiance) {
    // E_C = sum of L_j dw_j w_j over the texels of C
    const std::vector<VectorIrradiance> lights =
        LightBinning(environment.resolution).sums(environment, transfer.quadtree.leaves());
    std::vector<glm::vec3> radiance(transfer.num_receivers());
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place) {
        glm::dvec3 b(0.0);
        for (std::size_t cluster = 0; cluster < transfer.num_clusters(); ++cluster) {
            const glm::dvec3 whole = irradiance ? irradiance(place, cluster, lights[cluster])
                                                : lights[cluster].on(transfer.normals[place]);
            b += transfer.counts.count(place, cluster) / double{prt::FullCount} * whole;
        }
        radiance[transfer.order[place]] = glm::max(b / std::numbers::pi, 0.0);
    }
    return radiance;
}

} // namespace relumine::relight
