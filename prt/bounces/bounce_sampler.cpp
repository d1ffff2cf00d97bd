#include "prt/bounces/bounce_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "cubemap/face.h"
#include "cubemap/frame.h"
#include "cubemap/r2_sequence.h"
#include "cubemap/split_mix64.h"
#include "prt/clusters/lattice.h"
#include "prt/receivers/mesh_point.h"

namespace relumine::prt {

namespace {

/// Sets the choice of vertices apart from the shift of directions.
constexpr std::uint64_t ChoiceSeed = 0x5851f42d4c957f2du;

/// Returns what chooses a vertex, in [0, 1).
double choice_of(std::uint32_t receiver, std::uint32_t direction) {
    return cubemap::unit_interval(
        cubemap::SplitMix64((std::uint64_t{receiver} << 32u | direction) ^ ChoiceSeed).next());
}

/// Cosine-distributed directions around a normal: Roberts' R2 sequence, shifted by the receiver, so
/// that any beginning of it is stratified.
class CosineDirections {
public:
    CosineDirections(const glm::vec3& normal, std::uint32_t receiver)
        : frame_(cubemap::frame_of(glm::dvec3(normal))),
          shift_(
              cubemap::unit_interval(cubemap::SplitMix64(2 * std::uint64_t{receiver}).next()),
              cubemap::unit_interval(cubemap::SplitMix64(2 * std::uint64_t{receiver} + 1).next())) {
    }

    [[nodiscard]] glm::dvec3 operator[](std::uint32_t i) const {
        return cubemap::cosine_direction(frame_, cubemap::r2_place(i, shift_));
    }

    /// Calls visit(i) for those of the first so many directions that lie in a cone, and for some
    /// beside it: much faster than finding the directions.
    template<typename Visit>
    void for_near(std::uint32_t count, std::span<const DirectionCone> cones,
                  const Visit& visit) const {
        std::vector<NearCone> near;
        for (const DirectionCone& cone : cones)
            if (const NearCone own(glm::vec3(glm::dvec3(cone.axis) * frame_), cone.cosine);
                own.is_above())
                near.push_back(own);
        if (near.empty())
            return;
        // The plain ranges first, of many directions at a time: compilers make vectors of that.
        constexpr std::uint32_t NumAtATime = 32;
        const std::uint32_t step_s = fixed(cubemap::R2StepS), step_t = fixed(cubemap::R2StepT);
        std::uint32_t s = fixed(shift_.x), t = fixed(shift_.y);
        for (std::uint32_t begin = 0; begin < count; begin += NumAtATime) {
            std::array<std::uint32_t, NumAtATime> are_near{};
            for (const NearCone& cone : near) {
                const Range heights = cone.heights, turns = cone.turns;
                for (std::uint32_t i = 0; i < NumAtATime; ++i)
                    are_near[i] |= static_cast<std::uint32_t>(heights.has(s + i * step_s)) &
                                   static_cast<std::uint32_t>(turns.has(t + i * step_t));
            }
            const std::uint32_t size = std::min(NumAtATime, count - begin);
            for (std::uint32_t i = 0; i < size; ++i)
                if (are_near[i] != 0 && is_near(s + i * step_s, t + i * step_t, near))
                    visit(begin + i);
            s += NumAtATime * step_s;
            t += NumAtATime * step_t;
        }
    }

private:
    /// Values in 2^-32, which may go through 1 to 0.
    struct Range {
        std::uint32_t low = 0, size = ~std::uint32_t{0};
        [[nodiscard]] bool has(std::uint32_t value) const { return value - low <= size; }
    };
    static Range range(double low, double high) {
        constexpr double Margin = 1e-5; // of fixed() and of floats
        const double size = high - low + 2.0 * Margin;
        return size < 1.0 ? Range{fixed(glm::fract(low - Margin)), fixed(size)} : Range{};
    }

    /// A cone in the frame, and what places its directions above the horizon have.
    struct NearCone {
        NearCone(const glm::vec3& own_axis, float cosine)
            : axis(own_axis), least(std::max(cosine - Slack, -1.0f)) {
            const float sine = std::sqrt(1.0f - least * least);
            const float across = std::sqrt(std::max(1.0f - axis.z * axis.z, 0.0f));
            const bool has_top = axis.z >= least, has_bottom = -axis.z >= least;
            highest = has_top ? 1.0f : axis.z * least + across * sine;
            const float lowest = has_bottom ? 0.0f : std::max(axis.z * least - across * sine, 0.0f);
            heights = range(1.0f - highest * highest, 1.0f - lowest * lowest);
            if (has_top || has_bottom)
                return;
            constexpr float Turn = 2.0f * std::numbers::pi_v<float>;
            const float middle = std::atan2(axis.y, axis.x) / Turn;
            const float half = std::asin(std::min(sine / across, 1.0f)) / Turn;
            turns = range(middle - half, middle + half);
        }
        [[nodiscard]] bool is_above() const { return highest >= 0.0f; }

        // Angles in 2^-12 of a turn make an error of 8e-4, heights near 0 one of 3e-4.
        static constexpr float Slack = 2e-3f;
        glm::vec3 axis;
        float least, highest = 0.0f;
        Range heights, turns;
    };

    static bool is_near(std::uint32_t s, std::uint32_t t, std::span<const NearCone> cones) {
        const float squared = 0x1p-32f * static_cast<float>(s);
        const float radius = std::sqrt(squared), height = std::sqrt(1.0f - squared);
        const glm::vec2& turn = turns()[t >> (32u - TurnBits)];
        const glm::vec3 direction(radius * turn.x, radius * turn.y, height);
        return std::ranges::any_of(cones, [&](const NearCone& cone) {
            return glm::dot(direction, cone.axis) >= cone.least;
        });
    }

    static constexpr std::uint32_t TurnBits = 12;

    /// Returns a part of 1 in 2^-32.
    static std::uint32_t fixed(double value) {
        return static_cast<std::uint32_t>(static_cast<std::uint64_t>(value * 0x1p32));
    }
    /// Cosines and sines of the middles of equal parts of a turn
    static const std::vector<glm::vec2>& turns() {
        static const std::vector<glm::vec2> values = [] {
            std::vector<glm::vec2> result;
            for (std::uint32_t i = 0; i < 1u << TurnBits; ++i) {
                const double angle = 2.0 * std::numbers::pi * (i + 0.5) / (1u << TurnBits);
                result.emplace_back(std::cos(angle), std::sin(angle));
            }
            return result;
        }();
        return values;
    }

    glm::dmat3 frame_;
    glm::dvec2 shift_;
};

} // namespace

BounceSampler::BounceSampler(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                             const Transfer& transfer, const BounceProbes& probes,
                             const RayScene& rays, const BounceOptions& options)
    : mesh_(mesh), receivers_(receivers), transfer_(transfer), probes_(probes), rays_(rays),
      options_(options), place_of_(mesh.num_vertices(), NoEmitter), twins_(mesh) {
    for (std::uint32_t place = 0; place < transfer.order.size(); ++place) {
        const std::uint32_t receiver = transfer.order[place];
        if (receivers.points.empty())
            place_of_[receiver] = place;
        else if (receiver >= receivers.num_own())
            place_of_[vertex_at(mesh, receivers.points[receiver])] = place;
    }
}

/// What a receiver looks with.
class BounceSampler::Look {
public:
    Look(const BounceSampler& sampler, const PartReceiver& of_part)
        : sampler_(sampler), index_(of_part.index),
          receiver_(sampler.transfer_.order[of_part.place]),
          directions_(sampler.transfer_.normals[of_part.place], receiver_) {
        const Receivers& receivers = sampler.receivers_;
        const mesh::TriangleMesh& mesh = sampler.mesh_;
        const glm::vec3& normal = sampler.transfer_.normals[of_part.place];
        origin_ = ray_origin(receivers.positions[receiver_], normal, sampler.options_.bias);
        // A receiver that touches another surface looks from inside of its own solid, and gets no
        // light: it must not meet the other surface from there (lit_position.h).
        const glm::vec3 own = receivers.points.empty()
                                  ? mesh.positions[receiver_]
                                  : value_at(mesh, mesh.positions, receivers.points[receiver_]);
        is_inside_ = glm::dot(origin_ - own, normal) < 0.0f;
    }

    [[nodiscard]] const CosineDirections& directions() const { return directions_; }
    [[nodiscard]] std::uint32_t leaf_at(const glm::dvec3& direction) const {
        return sampler_.transfer_.quadtree.leaf_at(cubemap::face_point(direction));
    }

    /// Looks into direction i, which is in that leaf. Returns the number of rays.
    template<typename Visit>
    std::uint64_t into(std::uint32_t i, const glm::dvec3& direction, std::uint32_t leaf,
                       const Visit& visit) const {
        if (sampler_.transfer_.counts.count(index_, leaf) == FullCount)
            return 0;
        const auto met = sampler_.rays_.closest_hit(origin_, glm::vec3(direction));
        if (!met)
            return 1;
        const Hit hit = sampler_.twins_.facing(*met, glm::vec3(direction));
        const mesh::TriangleMesh& mesh = sampler_.mesh_;
        const auto distance = static_cast<double>(glm::distance(
            value_at(mesh, mesh.positions, MeshPoint{hit.triangle, hit.barycentric}), origin_));
        visit(i, RayFate{is_inside_ ? NoEmitter
                                    : sampler_.emitter_of(hit, glm::vec3(direction),
                                                          choice_of(receiver_, i)),
                         1.0 / distance});
        return 1;
    }

private:
    const BounceSampler& sampler_;
    std::size_t index_;
    std::uint32_t receiver_;
    CosineDirections directions_;
    glm::vec3 origin_{0.0f};
    bool is_inside_ = false;
};

/// Looks into `count` directions: `number_of(i)` is the number of the i-th.
template<typename NumberOf, typename Visit>
std::uint64_t BounceSampler::look_at(const PartReceiver& of_part, std::size_t count,
                                     const NumberOf& number_of, const Visit& visit) const {
    if (closure_of(of_part) == 0.0)
        return 0;
    const Look look(*this, of_part);
    std::uint64_t num_rays = 0;
    for (std::size_t place = 0; place < count; ++place) {
        const std::uint32_t i = number_of(place);
        const glm::dvec3 direction = look.directions()[i];
        num_rays += look.into(i, direction, look.leaf_at(direction), visit);
    }
    return num_rays;
}

std::uint64_t BounceSampler::look(const PartReceiver& receiver, std::uint32_t num_directions,
                                  RayHits& hits) const {
    const std::uint32_t begin = std::exchange(hits.num_directions, num_directions);
    return look_at(
        receiver, num_directions - std::min(begin, num_directions),
        [begin](std::size_t i) { return begin + static_cast<std::uint32_t>(i); },
        [&hits](std::uint32_t i, const RayFate& fate) {
            hits.halves[i % 2].push_back(fate.emitter);
            hits.sum_inverse_distances += fate.inverse_distance;
        });
}

std::uint64_t
BounceSampler::look(const PartReceiver& receiver, std::span<const std::uint32_t> directions,
                    const std::function<void(std::uint32_t, const RayFate&)>& visit) const {
    return look_at(
        receiver, directions.size(), [directions](std::size_t i) { return directions[i]; }, visit);
}

void BounceSampler::look_near(
    const PartReceiver& receiver, std::uint32_t num_directions,
    std::span<const DirectionCone> cones,
    const std::function<bool(std::uint32_t, const glm::dvec3&, std::uint32_t)>& is_wanted,
    const std::function<void(std::uint32_t, const RayFate&)>& visit) const {
    const Look look(*this, receiver);
    look.directions().for_near(num_directions, cones, [&](std::uint32_t i) {
        const glm::dvec3 direction = look.directions()[i];
        const std::uint32_t leaf = look.leaf_at(direction);
        if (is_wanted(i, direction, leaf))
            look.into(i, direction, leaf, visit);
    });
}

std::uint64_t BounceSampler::look_around(const PartReceiver& point,
                                         std::span<const glm::dvec3> directions,
                                         std::span<std::uint32_t> emitters) const {
    const std::uint32_t receiver = transfer_.order[point.place];
    const glm::vec3& origin = receivers_.positions[receiver];
    std::uint64_t num_rays = 0;
    for (std::uint32_t i = 0; i < directions.size(); ++i) {
        emitters[i] = NoEmitter;
        const std::uint32_t leaf = transfer_.quadtree.leaf_at(cubemap::face_point(directions[i]));
        if (transfer_.counts.count(point.index, leaf) == FullCount)
            continue;
        ++num_rays;
        const glm::vec3 direction(directions[i]);
        if (const auto met = rays_.closest_hit(origin, direction))
            emitters[i] =
                emitter_of(twins_.facing(*met, direction), direction, choice_of(receiver, i));
    }
    return num_rays;
}

double BounceSampler::squared_error(const PartReceiver& receiver, const RayHits& hits) const {
    const double closure = closure_of(receiver);
    if (hits.num_hits() == 0)
        return closure * closure;
    std::array<std::array<double, NumProbeLights>, 2> means{};
    for (std::size_t half = 0; half < 2; ++half) {
        for (const std::uint32_t emitter : hits.halves[half])
            if (emitter != NoEmitter)
                for (std::size_t light = 0; light < NumProbeLights; ++light)
                    means[half][light] += static_cast<double>(probes_.at(emitter)[light]);
        for (double& mean : means[half])
            mean /= std::max(static_cast<double>(hits.halves[half].size()), 1.0);
    }
    double worst = 0.0;
    for (std::size_t light = 0; light < NumProbeLights; ++light)
        worst = std::max(worst, std::abs(means[0][light] - means[1][light]));
    return 0.25 * closure * closure * worst * worst;
}

/// Draws a vertex of the triangle by its barycentric weight; `choice` is in [0, 1).
std::uint32_t BounceSampler::emitter_of(const Hit& hit, const glm::vec3& direction,
                                        double choice) const {
    const mesh::Triangle& corners = mesh_.triangles[hit.triangle];
    const float u = hit.barycentric.x;
    const float v = hit.barycentric.y;
    if (!options_.two_sided && !meets_front(mesh_, {hit.triangle, hit.barycentric}, direction))
        return NoEmitter;
    const std::size_t corner = choice < static_cast<double>(u)       ? 1
                               : choice < static_cast<double>(u + v) ? 2
                                                                     : 0;
    return place_of_[corners[corner]];
}

} // namespace relumine::prt
