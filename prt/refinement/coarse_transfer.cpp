#include "prt/refinement/coarse_transfer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "cubemap/cube_map.h"
#include "cubemap/face.h"
#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/horizon.h"
#include "prt/receivers/receiver_order.h"

namespace relumine::prt {

CoarseDirections::CoarseDirections() {
    constexpr std::uint32_t TileSide = 4, PatchSide = 8;
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(Resolution);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y0 = 0; y0 < Resolution; y0 += PatchSide)
            for (std::uint32_t x0 = 0; x0 < Resolution; x0 += PatchSide) {
                DirectionPatch& patch = patches_.emplace_back();
                for (std::uint32_t j = 0; j < DirectionPatch::Size; ++j) {
                    // Packets of 4 x 4 texels.
                    const std::uint32_t tile = j / PacketSize, lane = j % PacketSize;
                    const std::uint32_t x = x0 + tile % 2 * TileSide + lane % TileSide;
                    const std::uint32_t y = y0 + tile / 2 * TileSide + lane / TileSide;
                    patch.add(cubemap::texel_direction(face, x, y, Resolution));
                    shares_.push_back(static_cast<float>(
                        solid_angles[std::size_t{y} * Resolution + x] / (4.0 * std::numbers::pi)));
                }
            }
}

std::vector<CoarseDirections::Bits> CoarseDirections::trace(const Receivers& receivers,
                                                            const Blockers& blockers, float bias,
                                                            const Progress& progress) const {
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    std::vector<glm::vec3> origins, normals;
    for (const std::uint32_t receiver : order) {
        normals.push_back(receivers.normals[receiver]);
        origins.push_back(ray_origin(receivers.positions[receiver], normals.back(), bias));
    }
    const NormalArrays arrays(normals);
    std::vector<Bits> result(order.size());
    const std::size_t num_groups =
        (order.size() + ReceiverGroup::MaxSize - 1) / ReceiverGroup::MaxSize;
    tbb::parallel_for(std::size_t{0}, num_groups, [&](std::size_t group) {
        progress.poll();
        const std::size_t first = group * ReceiverGroup::MaxSize;
        const std::size_t size = std::min(order.size() - first, ReceiverGroup::MaxSize);
        std::array<std::uint64_t, ReceiverGroup::MaxSize> words{};
        for (std::size_t p = 0; p < NumPatches; ++p) {
            const std::span<std::uint64_t> rays(words.data(), size);
            std::fill(rays.begin(), rays.end(), 0u);
            directions_above_horizon(arrays, first, patches_[p], rays);
            glm::vec3 mean_normal(0.0f);
            for (std::size_t i = 0; i < size; ++i)
                if (rays[i] != 0)
                    mean_normal += normals[first + i];
            if (std::any_of(rays.begin(), rays.end(), [](std::uint64_t r) { return r != 0; }))
                blockers.clear_blocked({std::span(origins).subspan(first, size), mean_normal},
                                       patches_[p], rays);
            for (std::size_t i = 0; i < size; ++i)
                result[order[first + i]][p] = rays[i];
        }
    });
    return result;
}

float CoarseDirections::difference(const Point& point, std::span<const Point> others,
                                   float weight) const {
    const bool is_flat = std::all_of(others.begin(), others.end(), [&](const Point& other) {
        return other.normal == point.normal;
    });
    double sum = 0.0;
    for (std::size_t p = 0; p < NumPatches; ++p) {
        // On a flat surface only directions that not all points see differ.
        std::uint64_t any = (*point.lit)[p], all = any;
        for (const Point& other : others) {
            any |= (*other.lit)[p];
            all &= (*other.lit)[p];
        }
        float sum_of_patch = 0.0f;
        for (std::uint64_t left = is_flat ? any & ~all : any; left != 0; left &= left - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(left));
            const glm::vec3 w = patches_[p].direction(j);
            const auto transfer = [&](const Point& at) {
                const float cosine = at.normal.x * w.x + at.normal.y * w.y + at.normal.z * w.z;
                return ((*at.lit)[p] >> j & 1u) != 0 ? cosine : 0.0f;
            };
            float difference = transfer(point);
            for (const Point& other : others)
                difference -= weight * transfer(other);
            sum_of_patch += difference * difference * shares_[p * DirectionPatch::Size + j];
        }
        sum += static_cast<double>(sum_of_patch);
    }
    return static_cast<float>(std::sqrt(sum) / std::numbers::pi);
}

} // namespace relumine::prt
