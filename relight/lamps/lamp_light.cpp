#include "relight/lamps/lamp_light.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <glm/geometric.hpp>

#include "cubemap/r2_sequence.h"
#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "prt/visibility/blockers.h"
#include "relight/lamps/emitter_tree.h"
#include "relight/lamps/punctual.h"

namespace relumine::relight {

namespace {

using Seen = EmitterTree::Seen;

/// Which part of each emitter that a receiver sees its rays reach.
class Shadows {
public:
    Shadows(const EmitterTree& tree, const LampReceivers& receivers)
        : tree_(tree), receivers_(receivers) {}

    /// Returns the light of what is seen, without what is blocked.
    glm::dvec3 light(std::uint32_t receiver, const glm::vec3& origin, const glm::dvec3& normal) {
        tree_.look(glm::dvec3(origin), normal, seen_);
        glm::dvec3 light(0.0);
        double weight = 0.0;
        for (const Seen& seen : seen_) {
            light += seen.light;
            weight += seen.weight();
        }
        if (!(weight > 0.0))
            return glm::dvec3(0.0);
        constexpr std::size_t FewRays = prt::PacketSize, ManyRays = 128;
        trace(receiver, origin, normal, weight, FewRays);
        if (reached_ == 0.0)
            return glm::dvec3(0.0);
        if (reached_ == sent_)
            return light;
        trace(receiver, origin, normal, weight, ManyRays);
        const double mean = reached_ / sent_;
        light = glm::dvec3(0.0);
        for (std::size_t i = 0; i < seen_.size(); ++i)
            light +=
                seen_[i].light * (parts_[i].sent > 0.0 ? parts_[i].reached / parts_[i].sent : mean);
        return light;
    }

private:
    /// What rays to an emitter carry, and what of it arrives.
    struct Part {
        double sent = 0.0;
        double reached = 0.0;
    };

    /// Sends rays to points of the emitters, evenly by the light that each gives.
    void trace(std::uint32_t receiver, const glm::vec3& origin, const glm::dvec3& normal,
               double weight, std::size_t num_rays) {
        parts_.assign(seen_.size(), {});
        sent_ = reached_ = 0.0;
        cubemap::SplitMix64 random(std::uint64_t{receiver} << 32u | num_rays);
        const double shift = cubemap::unit_interval(random.next());
        const double shift_s = cubemap::unit_interval(random.next()),
                     shift_t = cubemap::unit_interval(random.next());
        const double shift_choice = cubemap::unit_interval(random.next());
        std::size_t at = 0;
        double before = 0.0;
        for (std::size_t begin = 0; begin < num_rays; begin += prt::PacketSize) {
            prt::DirectionPacket directions{.num_directions = prt::PacketSize};
            std::array<float, prt::PacketSize> distances{};
            std::array<double, prt::PacketSize> sent{};
            std::array<std::size_t, prt::PacketSize> of{};
            std::uint32_t active = 0;
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane) {
                const auto i = static_cast<double>(begin + lane);
                const double place = (i + shift) / static_cast<double>(num_rays) * weight;
                while (at + 1 < seen_.size() && before + seen_[at].weight() <= place)
                    before += seen_[at++].weight();
                // Kronecker sequences of the plastic number and of the golden ratio.
                const glm::dvec2 square = cubemap::r2_place(begin + lane, {shift_s, shift_t});
                const EmitterTree::Glow& glow =
                    tree_.choose(seen_[at], glm::fract(shift_choice + 0.6180339887498949 * i));
                const glm::dvec3 way = glow.at(in_triangle(square)) - glm::dvec3(origin);
                const double distance = glm::length(way);
                const double carried = glm::dot(normal, way) * -glm::dot(glow.front, way);
                directions.set(lane, glm::vec3(distance > 0.0 ? way / distance : normal));
                if (!(carried > 0.0) || glm::dot(normal, way) <= 0.0)
                    continue;
                of[lane] = at;
                sent[lane] = carried / (distance * distance * distance * distance);
                distances[lane] = std::max(static_cast<float>(distance) - receivers_.bias, 0.0f);
                active |= 1u << lane;
            }
            const std::uint32_t blocked =
                receivers_.rays.occluded(origin, directions, distances, active);
            for (std::size_t lane = 0; lane < prt::PacketSize; ++lane) {
                if ((active >> lane & 1u) == 0)
                    continue;
                parts_[of[lane]].sent += sent[lane];
                if ((blocked >> lane & 1u) == 0)
                    parts_[of[lane]].reached += sent[lane];
            }
        }
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            if (parts_[i].sent == 0.0)
                continue;
            sent_ += seen_[i].weight();
            reached_ += seen_[i].weight() * (parts_[i].reached / parts_[i].sent);
        }
    }

    /// Maps the square to the triangle, evenly [Heitz 2019, "A Low-Distortion Map Between Triangle
    /// and Square"].
    static glm::dvec2 in_triangle(glm::dvec2 square) {
        if (square.y > square.x) {
            square.x *= 0.5;
            square.y -= square.x;
        } else {
            square.y *= 0.5;
            square.x -= square.y;
        }
        return square;
    }

    const EmitterTree& tree_;
    const LampReceivers& receivers_;
    std::vector<Seen> seen_;
    /// [seen_]
    std::vector<Part> parts_;
    /// The light of the emitters that had rays, and what of it arrives.
    double sent_ = 0.0;
    double reached_ = 0.0;
};

} // namespace

std::vector<glm::vec3> lamp_light(const mesh::TriangleMesh& mesh,
                                  std::span<const prt::Emitter> emitters,
                                  std::span<const mesh::PunctualLight> lights,
                                  const LampReceivers& receivers) {
    const EmitterTree tree(mesh, emitters, receivers.two_sided);
    std::vector<glm::vec3> result(receivers.positions.size());
    constexpr std::size_t Grain = 64;
    files::parallel_for(files::IndexRange<std::size_t>(0, result.size(), Grain),
                        [&](const files::IndexRange<std::size_t>& range) {
                            Shadows shadows(tree, receivers);
                            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                if (receivers.normals[i] == glm::vec3(0.0f))
                                    continue;
                                const glm::dvec3 normal(receivers.normals[i]);
                                const glm::vec3 origin = prt::ray_origin(
                                    receivers.positions[i], receivers.normals[i], receivers.bias);
                                glm::dvec3 sum =
                                    shadows.light(static_cast<std::uint32_t>(i), origin, normal);
                                for (const mesh::PunctualLight& light : lights)
                                    sum += punctual_light(light, origin, normal, receivers.rays);
                                result[i] = glm::vec3(sum);
                            }
                        });
    return result;
}

} // namespace relumine::relight
