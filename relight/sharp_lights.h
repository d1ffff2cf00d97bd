// Lights too small and bright for their cluster, the sun above all: found when the environment is known and lit by shadow rays of
// their own. A cluster knows how much of its cell a receiver sees, not which part; that is enough for light spread over the cell
// (whatever it is, the precompute's tolerance bounds the error), but half a degree of sun in a cell of three degrees would
// get shadows three degrees soft.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/blockers.h"
#include "prt/quadtree.h"
#include "relight/cluster_lights.h"

namespace relumine::relight {

/// What tracing lights one by one takes. Without blockers no light is traced.
struct ShadowRays {
    const prt::Blockers* blockers = nullptr; ///< must outlive its user
    std::span<const glm::vec3> positions =
        {};                    ///< [num_receivers] in the receivers' own order; must outlive its user
    float bias = 0.0f;         ///< lift of the rays' origins, as in prt::PrecomputeOptions
    float tolerance = 0.0135f; ///< of the precompute, RMS form, 1/sr
};

/// One such light: a part of a cluster's cell, at most 0.2 degrees wide (or one texel) where the power is.
struct SharpLight {
    std::uint32_t cluster = 0;
    prt::Cell cell = {};
    glm::dvec3 direction{0.0, 0.0, 1.0}; ///< unit
    VectorIrradiance irradiance;         ///< taken out of the cluster's own
    bool operator==(const SharpLight&) const = default;
};

/// The sharp lights of an environment, clusters ascending. A cell two levels below its cluster is sharp when it holds so much of the
/// map's power P that the error a point light may make in the cluster, tolerance times its power, exceeds 0.25 % of the mean
/// radiance P / (4 pi), and it or a sister more than an eighth of the cluster's power. There are a few dozen at most: large sources have no such cells.
/// `powers`: the length of each cluster's full vector irradiance, in luminance, [clusters.size()]. Deterministic. O(clusters + texels of the brightest clusters).
[[nodiscard]] std::vector<SharpLight> find_sharp_lights(const cubemap::CubeMap& environment,
                                                        const LightBinning& binning,
                                                        std::span<const prt::Cell> clusters,
                                                        std::span<const double> powers, float tolerance);

/// Sharp lights arranged for tracing, sixteen rays at a time.
class SharpLightPackets {
public:
    explicit SharpLightPackets(std::span<const SharpLight> lights);
    /// Radiance (albedo 1) that a receiver gets: one shadow ray for each light above its horizon.
    [[nodiscard]] glm::dvec3 radiance(const glm::vec3& position, const glm::vec3& normal,
                                      const ShadowRays& rays) const;

private:
    struct Packet {
        prt::DirectionPacket directions;
        std::array<VectorIrradiance, prt::PacketSize> irradiance{};
    };
    std::vector<Packet> packets_;
};

} // namespace relumine::relight
