#include "relight/light_fit/transfer_matrix.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::relight {

TransferMatrix::TransferMatrix(const Relighter& relighter, std::span<const glm::dvec3> directions,
                               const ScaledReceivers& receivers)
    : num_directions_(directions.size()), num_receivers_(receivers.places.size()),
      elements_(num_directions_ * num_receivers_) {
    const ShadowRays& rays = relighter.shadow_rays();
    const prt::Transfer& transfer = relighter.transfer();
    files::parallel_for(
        std::size_t{0}, (directions.size() + prt::PacketSize - 1) / prt::PacketSize,
        [&](std::size_t p) {
            const std::size_t begin = p * prt::PacketSize;
            const std::size_t end = std::min(begin + prt::PacketSize, directions.size());
            prt::DirectionPacket packet;
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane)
                packet.set(lane, directions[std::min(begin + lane, end - 1)]);
            packet.num_directions = static_cast<std::uint32_t>(end - begin);
            for (std::size_t i = 0; i < num_receivers_; ++i) {
                const std::size_t place = receivers.places[i];
                const glm::vec3& normal = transfer.normals[place];
                const glm::vec3 origin =
                    prt::ray_origin(rays.positions[transfer.order[place]], normal, rays.bias);
                const float scale = receivers.scales[i] * std::numbers::inv_pi_v<float>;
                const auto all = static_cast<std::uint32_t>((1u << (end - begin)) - 1);
                const std::uint32_t occluded = rays.blockers->occluded(origin, packet, all);
                for (std::size_t j = begin; j < end; ++j) {
                    const float cosine =
                        glm::dot(normal, glm::vec3(packet.x[j - begin], packet.y[j - begin],
                                                   packet.z[j - begin]));
                    if (cosine > 0.0f && (occluded >> (j - begin) & 1u) == 0)
                        elements_[j * num_receivers_ + i] = cosine * scale;
                }
            }
        });
}

std::vector<float> TransferMatrix::products(std::span<const float> vector) const {
    std::vector<float> result(num_directions_);
    files::parallel_for(files::IndexRange<std::size_t>(0, num_directions_, 64),
                        [&](const auto& some) {
                            for (std::size_t j = some.begin(); j < some.end(); ++j)
                                result[j] = dot(column(j), vector);
                        });
    return result;
}

float TransferMatrix::dot(std::span<const float> a, std::span<const float> b) {
    // Sixteen partial sums, which the compiler keeps in vector registers; always in the same order.
    std::array<float, 16> sums{};
    std::size_t i = 0;
    for (; i + sums.size() <= a.size(); i += sums.size())
        for (std::size_t lane = 0; lane < sums.size(); ++lane)
            sums[lane] += a[i + lane] * b[i + lane];
    for (; i < a.size(); ++i)
        sums[0] += a[i] * b[i];
    return std::accumulate(sums.begin(), sums.end(), 0.0f);
}

} // namespace relumine::relight
