#include "prt/clusters/plain_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

#include "prt/clusters/lattice.h"

namespace relumine::prt {

namespace {

DirectionPacket nine_directions(const Cell& cell) {
    const auto points = lattice_points(cell);
    DirectionPacket packet;
    packet.num_directions = SamplesPerCell;
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        packet.set(l, direction(points[l]));
    return packet;
}

/// What one receiver has of the nine samples of a cell.
struct NineSamples {
    /// Whether a sample is above the receiver's horizon, and whether its light arrives.
    std::array<bool, SamplesPerCell> is_above{}, is_lit{};
    /// [JN, Eq. 9] T = V max(n.w, 0): the transfer times pi. V for points in space.
    std::array<double, SamplesPerCell> transfer{};

    NineSamples(const Receivers& receivers, std::size_t receiver, const Blockers& blockers,
                float bias, const DirectionPacket& packet) {
        const glm::vec3& normal = receivers.normals[receiver];
        const bool is_point = receiver < receivers.num_points(); // in space, without a horizon
        const std::uint32_t blocked =
            blockers.occluded(ray_origin(receivers.positions[receiver], normal, bias), packet,
                              (1u << SamplesPerCell) - 1);
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            const glm::vec3 w = packet.direction(l);
            is_above[l] = is_point || prt::is_above(normal, w);
            is_lit[l] = is_above[l] && (blocked >> l & 1u) == 0;
            if (is_lit[l])
                transfer[l] = is_point ? 1.0 : glm::dot(glm::dvec3(normal), glm::dvec3(w));
        }
    }

    [[nodiscard]] std::uint8_t
    count(const std::array<std::uint8_t, SamplesPerCell>& weights) const {
        double seen = 0.0, all = 0.0;
        for (std::size_t l = 0; l < SamplesPerCell; ++l) {
            seen += is_lit[l] ? weights[l] : 0.0;
            all += is_above[l] ? weights[l] : 0.0;
        }
        return all > 0.0 ? static_cast<std::uint8_t>(std::lround(FullCount * seen / all)) : 0;
    }
};

} // namespace

PlainClusters plain_clusters(const Receivers& receivers, const Blockers& blockers,
                             const PrecomputeOptions& options) {
    const auto n = static_cast<double>(receivers.size());
    // [JN, Eq. 11]; `tolerance` is a root of a mean square.
    const double most = options.epsilon ? static_cast<double>(*options.epsilon) * n
                                        : static_cast<double>(options.tolerance) * std::sqrt(n);
    const std::uint32_t texel = texel_level(options.face_resolution);
    PlainClusters result;
    const auto must_split = [&](const Cell& cell) {
        if (cell.level < std::min(options.min_level, texel))
            return true;
        std::array<double, SamplesPerCell> squares{}; // ||T_C - T_l||^2
        std::vector<std::uint8_t> counts;
        const DirectionPacket packet = nine_directions(cell);
        for (std::size_t receiver = 0; receiver < receivers.size(); ++receiver) {
            const NineSamples samples(receivers, receiver, blockers, options.bias, packet);
            double mean = 0.0; // [JN, Eq. 10]
            for (std::size_t l = 0; l < SamplesPerCell; ++l)
                mean += samples.transfer[l] * SampleWeights[l] / FullCount;
            for (std::size_t l = 0; l < SamplesPerCell; ++l)
                squares[l] += std::pow(samples.transfer[l] - mean, 2.0);
            counts.push_back(samples.count(cell.level == texel ? CentreWeights : SampleWeights));
        }
        const double distance = std::sqrt(*std::max_element(squares.begin(), squares.end()));
        if (cell.level < texel && distance >= most * std::numbers::pi)
            return true;
        result.counts.push_back(std::move(counts));
        return false;
    };
    result.quadtree = Quadtree::of(must_split);
    return result;
}

} // namespace relumine::prt
