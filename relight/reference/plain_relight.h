// [JN, Eq. 8] as it is written, to be read first: what every kernel that lights is held to.
// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN].
#pragma once

#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/transfer/transfer.h"
#include "relight/kernels/cluster_lights.h"

namespace relumine::relight {

/// What a receiver gets of a cluster that it sees whole: by its place in the transfer's order, the
/// cluster, and the cluster's light.
using ClusterIrradiance = std::function<glm::dvec3(std::size_t place, std::size_t cluster,
                                                   const VectorIrradiance& light)>;

/// Returns B(x) = sum over C of c/16 max(n.E_C, 0)/pi, [num_receivers] in the receivers' own order.
/// `irradiance` stands in place of max(n.E_C, 0), where it is given.
///
/// Cost:    O(6 R^2 + receivers * clusters), on one thread.
[[nodiscard]] std::vector<glm::vec3> plain_relight(const prt::Transfer& transfer,
                                                   const cubemap::CubeMap& environment,
                                                   const ClusterIrradiance& irradiance = {});

} // namespace relumine::relight
