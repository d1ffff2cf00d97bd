// Lights that are too small and bright for their cluster, the sun above all. They are found when
// the environment is known, and lit by shadow rays of their own.
//
// A cluster knows how much of its cell a receiver sees, not which part. For light spread over the
// cell this is enough: the precompute's tolerance bounds the error, whatever the light is. But half
// a degree of sun in a cell of three degrees would get shadows three degrees soft.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/transfer/transfer.h"
#include "relight/kernels/cluster_lights.h"

namespace relumine::relight {

/// A sharp light: a part of a cluster's cell, at most 0.2 degrees wide (or one texel) where the
/// power is.
struct SharpLight {
    std::uint32_t cluster = 0;
    prt::Cell cell = {};
    /// Unit length.
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Taken out of the cluster's own irradiance.
    VectorIrradiance irradiance;
    /// Whether it stands in a light list, where no cluster answers for it.
    bool is_of_list = false;
    bool operator==(const SharpLight&) const = default;
};

/// Returns the sharp lights of an environment, clusters ascending. Deterministic.
///
/// Cells two levels below a cluster are candidates. A candidate of power p is sharp when p is large
/// beside the map's power P. In the cluster, a point light of power p may make an error of
/// tolerance p. This error must exceed 0.25 % of the mean radiance P / (4 pi).
///
/// Also, the candidate or a sister must hold more than an eighth of the cluster's power, unless
/// cells with even light are to count, too (`even_too`). It is cut into lights of 0.2 degrees, but
/// no further than a 64th of its own power and, unless `even_too`, a 256th of the map's.
///
/// There are at most 64 lights, unless `even_too`. Where there would be more, the strongest cells
/// are cut where it matters most: a light's power times its width is the harm of not cutting it.
/// The light of weaker cells stays in their clusters.
///
/// Shape:   powers is [clusters.size()]: the length of each cluster's full vector irradiance, in
///          luminance.
/// Cost:    O(clusters + texels of the brightest clusters).
[[nodiscard]] std::vector<SharpLight> find_sharp_lights(const cubemap::CubeMap& environment,
                                                        const LightBinning& binning,
                                                        std::span<const prt::Cell> clusters,
                                                        std::span<const double> powers,
                                                        float tolerance, bool even_too = false);

/// Returns the lights that are sharp to a scene's receivers. Highlights may be smaller than any
/// cluster, and a cluster of points is all that divides their light, so to both, bright cells are
/// sharp even where the cluster's light is even. To points, lights of half the power are.
[[nodiscard]] std::vector<SharpLight>
find_sharp_lights(const cubemap::CubeMap& environment, const LightBinning& binning,
                  const prt::Transfer& transfer, std::span<const double> powers, float tolerance);

/// Returns at most `most` lights of the same light: those of one small cell become one, in the
/// middle of their power, where there are more. Returns none where cells of 0.7 degrees are not
/// enough: shadows of such lights are soft.
///
/// Shape:   `lights` as find_sharp_lights() returns them.
[[nodiscard]] std::vector<SharpLight> merged(std::span<const SharpLight> lights, std::size_t most);

} // namespace relumine::relight
