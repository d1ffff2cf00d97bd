#include "prt/bounces/similar_receivers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

/// A balanced tree of points: the middle of each range splits it along the axis at which it is
/// widest, down to a few points that are asked one after the other.
class PointTree {
public:
    explicit PointTree(std::span<const glm::vec3> points)
        : order_(points.size()), axes_(points.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        split(points, 0, order_.size());
        points_.reserve(points.size());
        for (const std::uint32_t place : order_)
            points_.push_back(points[place]);
    }

    /// Calls visit(place, squared distance) for every point within the radius, which `visit`
    /// returns anew, squared.
    template<typename Visit>
    void visit_near(const glm::vec3& center, float& squared_radius, const Visit& visit) const {
        visit_range(0, order_.size(), center, squared_radius, visit);
    }

private:
    static constexpr std::size_t Few = 8;

    void split(std::span<const glm::vec3> points, std::size_t begin, std::size_t end) {
        if (end - begin <= Few)
            return;
        glm::vec3 low = points[order_[begin]], high = low;
        for (std::size_t i = begin; i < end; ++i) {
            low = glm::min(low, points[order_[i]]);
            high = glm::max(high, points[order_[i]]);
        }
        const glm::vec3 size = high - low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) {
            return order_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(points[a][axis], a) < std::pair(points[b][axis], b);
        });
        axes_[middle] = static_cast<std::uint8_t>(axis);
        split(points, begin, middle);
        split(points, middle + 1, end);
    }

    template<typename Visit>
    void visit_range(std::size_t begin, std::size_t end, const glm::vec3& center,
                     float& squared_radius, const Visit& visit) const {
        const auto ask = [&](std::size_t i) {
            const glm::vec3 offset = points_[i] - center;
            const float squared_distance = glm::dot(offset, offset);
            if (squared_distance <= squared_radius)
                visit(order_[i], squared_distance);
        };
        if (end - begin <= Few) {
            for (std::size_t i = begin; i < end; ++i)
                ask(i);
            return;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        ask(middle);
        const float across = center[axes_[middle]] - points_[middle][axes_[middle]];
        const auto [near_begin, near_end] =
            across < 0.0f ? std::pair(begin, middle) : std::pair(middle + 1, end);
        visit_range(near_begin, near_end, center, squared_radius, visit);
        if (across * across > squared_radius)
            return;
        const auto [far_begin, far_end] =
            across < 0.0f ? std::pair(middle + 1, end) : std::pair(begin, middle);
        visit_range(far_begin, far_end, center, squared_radius, visit);
    }

    /// [n] by order_
    std::vector<glm::vec3> points_;
    std::vector<std::uint32_t> order_;
    /// [n] of the point in the middle of a range.
    std::vector<std::uint8_t> axes_;
};

} // namespace

PlaceLists similar_receivers(std::span<const glm::vec3> positions,
                             std::span<const glm::vec3> normals, std::span<const float> distances,
                             const SimilarityLimits& limits, std::span<const std::uint32_t> wanted,
                             const SimilarBefore& before) {
    const PointTree tree(positions);
    std::vector<std::vector<std::uint32_t>> lists(wanted.size());
    files::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
        const std::size_t place = wanted[i];
        // The nearest so far, the farthest of them first; equal distances by place.
        std::vector<std::pair<float, std::uint32_t>> nearest;
        nearest.reserve(limits.max_size);
        bool is_bounded = false; // by those of before
        const float radius = limits.max_error * distances[place];
        float squared_radius = radius * radius;
        const auto is_similar = [&](std::size_t other, float squared_distance) {
            const float turn =
                std::sqrt(std::max(0.0f, 1.0f - glm::dot(normals[place], normals[other])));
            const float distance = std::min(distances[place], distances[other]);
            return other != place &&
                   std::sqrt(squared_distance) <= (limits.max_error - turn) * distance;
        };
        const auto consider = [&](std::uint32_t other, float squared_distance) {
            if (!is_similar(other, squared_distance))
                return;
            nearest.emplace_back(squared_distance, other);
            if (is_bounded)
                return;
            std::push_heap(nearest.begin(), nearest.end());
            if (nearest.size() >= limits.max_size) {
                std::pop_heap(nearest.begin(), nearest.end());
                nearest.pop_back();
            }
            if (nearest.size() + 1 == limits.max_size)
                squared_radius = std::min(squared_radius, nearest.front().first);
        };
        // Where enough of before are similar still, none is farther than the farthest of them.
        if (before.lists != nullptr) {
            constexpr float Rounding = 1.0f + 1e-5f;
            std::size_t count = 1;
            float farthest = 0.0f;
            for (const std::uint32_t known : (*before.lists)[before.first + place]) {
                const std::size_t other = known - before.first; // modulo 2^64
                if (other >= positions.size())
                    continue;
                const glm::vec3 offset = positions[other] - positions[place];
                const float squared_distance = glm::dot(offset, offset);
                if (!is_similar(other, squared_distance))
                    continue;
                farthest = std::max(farthest, squared_distance);
                ++count;
            }
            is_bounded = count == limits.max_size;
            if (is_bounded)
                squared_radius = std::min(squared_radius, Rounding * farthest);
        }
        if (radius > 0.0f && limits.max_size > 1)
            tree.visit_near(positions[place], squared_radius, consider);
        if (nearest.size() >= limits.max_size) {
            const auto end = nearest.begin() + static_cast<std::ptrdiff_t>(limits.max_size - 1);
            std::nth_element(nearest.begin(), end, nearest.end());
            nearest.erase(end, nearest.end());
        }
        std::vector<std::uint32_t>& list = lists[i];
        list.reserve(nearest.size() + 1);
        list.push_back(static_cast<std::uint32_t>(place));
        for (const auto& [distance, other] : nearest)
            list.push_back(other);
        std::sort(list.begin(), list.end());
    });
    PlaceLists result;
    for (const std::vector<std::uint32_t>& list : lists)
        result.append(list);
    return result;
}

PlaceLists similar_receivers(std::span<const glm::vec3> positions,
                             std::span<const glm::vec3> normals, std::span<const float> distances,
                             const SimilarityLimits& limits) {
    std::vector<std::uint32_t> all(positions.size());
    std::iota(all.begin(), all.end(), 0u);
    return similar_receivers(positions, normals, distances, limits, all);
}

} // namespace relumine::prt
