// Lights too small and bright for their cluster, the sun above all: found when the environment is
// known and lit by shadow rays of their own. A cluster knows how much of its cell a receiver sees,
// not which part; that is enough for light spread over the cell (whatever it is, the precompute's
// tolerance bounds the error), but half a degree of sun in a cell of three degrees would get
// shadows three degrees soft.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/clusters/quadtree.h"
#include "relight/cluster_lights.h"

namespace relumine::relight {

/// One such light: a part of a cluster's cell, at most 0.2 degrees wide (or one texel) where the
/// power is.
struct SharpLight {
    std::uint32_t cluster = 0;
    prt::Cell cell = {};
    /// unit
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Taken out of the cluster's own
    VectorIrradiance irradiance;
    bool operator==(const SharpLight&) const = default;
};

/// The sharp lights of an environment, clusters ascending. A cell two levels below its cluster is
/// sharp when it holds so much of the map's power P that the error a point light may make in the
/// cluster, tolerance times its power, exceeds 0.25 % of the mean radiance P / (4 pi), and it or a
/// sister more than an eighth of the cluster's power. There are a few dozen at most: large sources
/// have no such cells. `powers`: the length of each cluster's full vector irradiance, in luminance,
/// [clusters.size()]. Deterministic. O(clusters + texels of the brightest clusters). With `glossy`
/// receivers bright cells are sharp even where their cluster is lit evenly, as highlights may be
/// smaller than any cluster.
[[nodiscard]] std::vector<SharpLight> find_sharp_lights(const cubemap::CubeMap& environment,
                                                        const LightBinning& binning,
                                                        std::span<const prt::Cell> clusters,
                                                        std::span<const double> powers,
                                                        float tolerance, bool glossy = false);

} // namespace relumine::relight
