// Blockers in closed form, and one that watches another.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "prt/visibility/blockers.h"

namespace relumine::scenes {

/// Asks a predicate blocked(origin, direction) in double.
class AnalyticBlockers final : public prt::Blockers {
public:
    using Predicate = std::function<bool(const glm::dvec3& origin, const glm::dvec3& direction)>;
    explicit AnalyticBlockers(Predicate blocked) : blocked_(std::move(blocked)) {}

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin,
                                         const prt::DirectionPacket& directions,
                                         std::uint32_t active) const override {
        std::uint32_t blocked = 0;
        for (std::uint32_t i = 0; i < prt::PacketSize; ++i)
            if ((active >> i & 1u) != 0 &&
                blocked_(origin, {directions.x[i], directions.y[i], directions.z[i]}))
                blocked |= 1u << i;
        return blocked;
    }

private:
    Predicate blocked_;
};

/// Nothing in the way.
[[nodiscard]] inline AnalyticBlockers no_blockers() {
    return AnalyticBlockers([](const glm::dvec3&, const glm::dvec3&) { return false; });
}

/// A sphere that rays start outside of.
[[nodiscard]] inline AnalyticBlockers sphere_blocker(const glm::dvec3& centre, double radius) {
    return AnalyticBlockers(
        [centre, radius](const glm::dvec3& origin, const glm::dvec3& direction) {
            const glm::dvec3 to_centre = centre - origin;
            const double along = glm::dot(to_centre, direction);
            return along > 0.0 && glm::dot(to_centre, to_centre) - along * along < radius * radius;
        });
}

/// The half-plane y = height, x > edge.
[[nodiscard]] inline AnalyticBlockers half_plane_blocker(double height, double edge) {
    return AnalyticBlockers([height, edge](const glm::dvec3& origin, const glm::dvec3& direction) {
        const double distance = (height - origin.y) / direction.y;
        return direction.y != 0.0 && distance > 0.0 && origin.x + distance * direction.x > edge;
    });
}

/// Passes questions on and keeps a tally of the rays.
class CountingBlockers final : public prt::Blockers {
public:
    explicit CountingBlockers(const prt::Blockers& blockers) : blockers_(blockers) {}

    /// Origin, direction
    using Ray = std::array<float, 6>;

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin,
                                         const prt::DirectionPacket& directions,
                                         std::uint32_t active) const override {
        const std::scoped_lock lock(mutex_);
        for (std::uint32_t i = 0; i < prt::PacketSize; ++i)
            if ((active >> i & 1u) != 0)
                ++rays_[{origin.x, origin.y, origin.z, directions.x[i], directions.y[i],
                         directions.z[i]}];
        return blockers_.occluded(origin, directions, active);
    }

    [[nodiscard]] const std::map<Ray, int>& rays() const { return rays_; }

private:
    const prt::Blockers& blockers_;
    mutable std::mutex mutex_;
    mutable std::map<Ray, int> rays_;
};

} // namespace relumine::scenes
