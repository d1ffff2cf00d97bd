#include "cubemap/image/footprint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relumine::cubemap {

ProjectionFootprints::ProjectionFootprints(const Projection& projection, std::uint32_t width,
                                           std::uint32_t height)
    : projection_(projection), width_(width), height_(height), is_disc_(projection.is_disc()),
      is_mirrored_(projection.is_mirrored()),
      tolerance_(1e-4 * std::sqrt(4.0 * std::numbers::pi / (width_ * height_))) {}

bool ProjectionFootprints::is_whole(std::uint32_t x, std::uint32_t y) const {
    if (!is_disc_)
        return true;
    const double far_x = std::max(std::abs(x / width_ - 0.5), std::abs((x + 1) / width_ - 0.5));
    const double far_y = std::max(std::abs(y / height_ - 0.5), std::abs((y + 1) / height_ - 0.5));
    return far_x * far_x + far_y * far_y <= 0.25;
}

bool ProjectionFootprints::clip(const Rectangle& rectangle) {
    const auto& [low, high] = rectangle;
    const std::array<glm::dvec2, 4> square = {low, {high.x, low.y}, high, {low.x, high.y}};
    corners_.clear();
    if (!is_disc_) {
        for (const glm::dvec2& corner : square)
            corners_.push_back({corner, false});
        return true;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        // The part [enter, leave] of the edge that lies in the disc: |a + t d|^2 = 1/4.
        const glm::dvec2 a = square[i] - 0.5, d = square[(i + 1) % 4] - square[i];
        const double dd = glm::dot(d, d), ad = glm::dot(a, d);
        const double root = ad * ad - dd * (glm::dot(a, a) - 0.25);
        if (root <= 0.0)
            continue;
        const double enter = std::max((-ad - std::sqrt(root)) / dd, 0.0);
        const double leave = std::min((-ad + std::sqrt(root)) / dd, 1.0);
        if (enter >= leave)
            continue;
        const glm::dvec2 first = enter > 0.0 ? square[i] + enter * d : square[i];
        const glm::dvec2 last = leave < 1.0 ? square[i] + leave * d : square[(i + 1) % 4];
        // Between edges that do not follow each other, the outline runs along the rim.
        if (corners_.empty() || corners_.back().point != first) {
            if (!corners_.empty())
                corners_.back().along_rim = true;
            corners_.push_back({first, false});
        }
        corners_.push_back({last, false});
    }
    if (corners_.size() > 1) {
        if (corners_.back().point == corners_.front().point)
            corners_.pop_back();
        else
            corners_.back().along_rim = true;
    }
    // The disc may lie inside the rectangle without touching its edges.
    const bool holds_middle = low.x < 0.5 && low.y < 0.5 && high.x > 0.5 && high.y > 0.5;
    return !corners_.empty() || holds_middle;
}

bool ProjectionFootprints::is_small(const Rectangle& rectangle) const {
    // Part of the picture's side. A larger rectangle might hold the whole disc.
    constexpr double LargestSide = 0.25;
    constexpr double LargestAngle = 0.3;
    if (corners_.empty() || rectangle.high.x - rectangle.low.x > LargestSide ||
        rectangle.high.y - rectangle.low.y > LargestSide)
        return false;
    const glm::dvec3 middle = projection_.direction(0.5 * (rectangle.low + rectangle.high));
    return std::all_of(corners_.begin(), corners_.end(), [&](const Corner& corner) {
        return glm::distance(corner.direction, middle) <= LargestAngle;
    });
}

void ProjectionFootprints::make_outline() {
    outline_.clear();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Corner& from = corners_[i];
        const Corner& to = corners_[(i + 1) % corners_.size()];
        outline_.push_back(from.direction);
        if (!from.along_rim)
            add_edge(from.point, from.direction, to.point, to.direction, 0);
    }
    if (is_mirrored_)
        std::reverse(outline_.begin(), outline_.end());
}

void ProjectionFootprints::add_edge(const glm::dvec2& from, const glm::dvec3& from_direction,
                                    const glm::dvec2& to, const glm::dvec3& to_direction,
                                    int depth) {
    constexpr int Deepest = 12;
    const glm::dvec2 middle = 0.5 * (from + to);
    const glm::dvec3 direction = projection_.direction(middle);
    const glm::dvec3 normal = glm::cross(from_direction, to_direction);
    const double length = glm::length(normal);
    // Distance from the great circle, or from the chord if its ends hardly differ.
    const double off = length > 1e-9
                           ? std::abs(glm::dot(direction, normal)) / length
                           : glm::distance(direction, 0.5 * (from_direction + to_direction));
    // The middle of a long edge may miss a bend elsewhere on the edge, as at the creases of an
    // octahedron.
    constexpr double LongEdge = 0.1;
    if (depth >= Deepest || (off <= tolerance_ && length <= LongEdge))
        return;
    add_edge(from, from_direction, middle, direction, depth + 1);
    outline_.push_back(direction);
    add_edge(middle, direction, to, to_direction, depth + 1);
}

double solid_angle(std::span<const glm::dvec3> corners) {
    // Van Oosterom and Strackee's formula for each triangle of a fan.
    double sum = 0.0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
        const glm::dvec3 &a = corners[0], &b = corners[i - 1], &c = corners[i];
        sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b - a, c - a)),
                                1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    }
    return sum;
}

} // namespace relumine::cubemap
