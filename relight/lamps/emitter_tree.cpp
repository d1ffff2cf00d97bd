#include "relight/lamps/emitter_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::relight {

namespace {

constexpr double Pi = std::numbers::pi;

/// A node this wide, over its distance, counts as one point: what is left out is the square of it.
constexpr double LargestWidth = 0.12;
/// The limit of width over distance of a node that the horizon cuts.
constexpr double LargestCutWidth = 0.04;
/// Radians; so even a node's fronts must be.
constexpr double LargestTurn = 0.4;

glm::dvec3 middle_of(const EmitterTree::Glow& glow) {
    return (glow.corners[0] + glow.corners[1] + glow.corners[2]) / 3.0;
}

} // namespace

double triangle_light(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& normal) {
    // What is above the horizon has up to four corners.
    std::array<glm::dvec3, 4> above{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &from = corners[i], &to = corners[(i + 1) % 3];
        const double height = glm::dot(normal, from), next = glm::dot(normal, to);
        if (height >= 0.0)
            above[count++] = from;
        if ((height > 0.0 && next < 0.0) || (height < 0.0 && next > 0.0))
            above[count++] = glm::mix(from, to, height / (height - next));
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 &a = above[i], &b = above[(i + 1) % count];
        const glm::dvec3 side = glm::cross(a, b);
        const double sine = glm::length(side);
        if (sine > 0.0) // an edge that points at the receiver spans no angle
            sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, side) / sine;
    }
    return std::abs(sum) / (2.0 * Pi);
}

EmitterTree::EmitterTree(const mesh::TriangleMesh& mesh, std::span<const prt::Emitter> emitters,
                         bool two_sided) {
    for (const prt::Emitter& emitter : emitters) {
        Glow glow{.corners = prt::corners_of(mesh, emitter),
                  .front = prt::front_of(mesh, emitter.triangle),
                  .radiance = glm::dvec3(emitter.radiance)};
        glow.area = 0.5 * glm::length(glm::cross(glow.corners[1] - glow.corners[0],
                                                 glow.corners[2] - glow.corners[0]));
        if (!(glow.power() > 0.0) || glow.front == glm::dvec3(0.0))
            continue;
        glows_.push_back(glow);
        if (two_sided) {
            glow.front = -glow.front;
            glows_.push_back(glow);
        }
    }
    if (!glows_.empty()) {
        nodes_.push_back({.begin = 0, .end = glows_.size()});
        split(0);
    }
    powers_.push_back(0.0);
    for (const Glow& glow : glows_)
        powers_.push_back(powers_.back() + glow.power());
}

void EmitterTree::summarise(Node& node) const {
    double power = 0.0;
    glm::dvec3 low = glows_[node.begin].corners[0], high = low;
    for (std::size_t i = node.begin; i < node.end; ++i) {
        const Glow& glow = glows_[i];
        node.center += glow.power() * middle_of(glow);
        power += glow.power();
        node.axis += glow.area * glow.front;
        for (int color = 0; color < 3; ++color)
            node.fluxes[color] += glow.radiance[color] * glow.area * glow.front;
        for (const glm::dvec3& corner : glow.corners) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    node.center /= power;
    node.radius = glm::length(glm::max(high - node.center, node.center - low));
    node.middle = 0.5 * (low + high);
    node.half = 0.5 * (high - low);
    const double length = glm::length(node.axis);
    double cosine = -1.0;
    if (length > 0.0) {
        node.axis /= length;
        cosine = 1.0;
        for (std::size_t i = node.begin; i < node.end; ++i)
            cosine = std::min(cosine, glm::dot(node.axis, glows_[i].front));
    }
    node.half_angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    constexpr double Rounding = 1e-6; // of corners in float
    node.is_flat = cosine > 1.0 - Rounding * Rounding;
    for (std::size_t i = node.begin; i < node.end && node.is_flat; ++i)
        for (const glm::dvec3& corner : glows_[i].corners)
            node.is_flat = node.is_flat && std::abs(glm::dot(node.axis, corner - node.center)) <
                                               Rounding * node.radius;
}

EmitterTree::Fronts EmitterTree::fronts_seen(const Node& node, const glm::dvec3& way,
                                             double distance) {
    const double cosine = -glm::dot(node.axis, way) / distance;
    if (node.is_flat)
        return cosine > 0.0 ? Fronts::All : Fronts::None;
    if (distance <= node.radius)
        return Fronts::Some;
    const double turn = std::acos(std::clamp(cosine, -1.0, 1.0));
    const double spread = node.half_angle + std::asin(node.radius / distance);
    if (turn - spread >= 0.5 * Pi)
        return Fronts::None;
    return turn + spread < 0.5 * Pi ? Fronts::All : Fronts::Some;
}

/// Halves a node by the median along the longest side of its middles, or of its fronts where they
/// differ more, and so on.
void EmitterTree::split(std::size_t index) {
    summarise(nodes_[index]);
    const std::size_t begin = nodes_[index].begin, end = nodes_[index].end;
    if (end - begin == 1)
        return;
    glm::dvec3 low = middle_of(glows_[begin]), high = low;
    glm::dvec3 least_front = glows_[begin].front, largest_front = least_front;
    for (std::size_t i = begin; i < end; ++i) {
        low = glm::min(low, middle_of(glows_[i]));
        high = glm::max(high, middle_of(glows_[i]));
        least_front = glm::min(least_front, glows_[i].front);
        largest_front = glm::max(largest_front, glows_[i].front);
    }
    const auto longest = [](const glm::dvec3& size) {
        return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    };
    const glm::dvec3 size = high - low, turn = nodes_[index].radius * (largest_front - least_front);
    const bool by_front = turn[longest(turn)] > size[longest(size)];
    const int axis = longest(by_front ? turn : size);
    const auto key = [&](const Glow& glow) {
        return by_front ? glow.front[axis] : middle_of(glow)[axis];
    };
    const auto at = [&](std::size_t i) {
        return glows_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(at(begin), at(middle), at(end),
                     [&](const Glow& a, const Glow& b) { return key(a) < key(b); });
    const std::size_t child = nodes_.size();
    nodes_[index].first_child = child;
    nodes_.push_back({.begin = begin, .end = middle});
    nodes_.push_back({.begin = middle, .end = end});
    split(child);
    split(child + 1);
}

void EmitterTree::look(const glm::dvec3& position, const glm::dvec3& normal,
                       std::vector<Seen>& seen) const {
    seen.clear();
    if (nodes_.empty())
        return;
    // The depth of a halved tree is at most 64.
    std::array<std::size_t, 65> stack{};
    std::size_t size = 1;
    while (size > 0) {
        const Node& node = nodes_[stack[--size]];
        const double middle = glm::dot(normal, node.middle - position);
        const double reach = glm::dot(glm::abs(normal), node.half);
        if (middle + reach <= 0.0)
            continue;
        if (node.first_child == 0) {
            see_leaf(node, position, normal, seen);
            continue;
        }
        const glm::dvec3 way = node.center - position;
        const double distance = glm::length(way);
        const Fronts fronts = fronts_seen(node, way, distance);
        if (fronts == Fronts::None)
            continue;
        const double largest = middle >= reach ? LargestWidth : LargestCutWidth;
        if (fronts == Fronts::All && node.radius < largest * distance &&
            node.half_angle < LargestTurn) {
            // What the horizon cuts counts as if it were spread evenly over its heights.
            const double above = middle + reach;
            const double height =
                middle >= reach ? glm::dot(normal, way) : above * above / (4.0 * reach);
            const double squared = distance * distance;
            seen.push_back({.begin = node.begin,
                            .end = node.end,
                            .light = -(way * node.fluxes) * height / (Pi * squared * squared)});
        } else {
            stack[size++] = node.first_child + 1;
            stack[size++] = node.first_child;
        }
    }
}

void EmitterTree::see_leaf(const Node& node, const glm::dvec3& position, const glm::dvec3& normal,
                           std::vector<Seen>& seen) const {
    const Glow& glow = glows_[node.begin];
    if (glm::dot(glow.front, position - glow.corners[0]) <= 0.0)
        return;
    const double light = triangle_light(
        {glow.corners[0] - position, glow.corners[1] - position, glow.corners[2] - position},
        normal);
    if (light > 0.0)
        seen.push_back({.begin = node.begin, .end = node.end, .light = light * glow.radiance});
}

const EmitterTree::Glow& EmitterTree::choose(const Seen& seen, double choice) const {
    const double power = powers_[seen.begin] + choice * (powers_[seen.end] - powers_[seen.begin]);
    const auto begin = powers_.begin() + static_cast<std::ptrdiff_t>(seen.begin);
    const auto end = powers_.begin() + static_cast<std::ptrdiff_t>(seen.end);
    return glows_[static_cast<std::size_t>(std::upper_bound(begin + 1, end, power) -
                                           powers_.begin()) -
                  1];
}

} // namespace relumine::relight
