#include "cubemap/layers/shapes/arc_tree.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

constexpr std::uint32_t LeafSize = 3;
/// Halving 2^32 arcs gives 32 levels, and one node per level waits on the stack.
constexpr std::size_t StackSize = 40;

double squared_length(const glm::dvec3& v) {
    return glm::dot(v, v);
}

} // namespace

double ArcTree::Arc::squared_distance(const glm::dvec3& w) const {
    if (glm::dot(w, after_from) > 0.0 && glm::dot(w, before_to) > 0.0) {
        // The foot of w on the great circle lies on the arc. The squared chord is 2 - 2 cos with
        // sin = w.n, written without cancellation.
        const double sine = glm::dot(w, normal);
        return 2.0 * sine * sine / (1.0 + std::sqrt(std::max(0.0, 1.0 - sine * sine)));
    }
    return std::min(squared_length(w - from), squared_length(w - to));
}

ArcTree::ArcTree(std::span<const glm::dvec3> points, bool closed) {
    const std::size_t num_arcs = closed || points.size() == 1 ? points.size() : points.size() - 1;
    arcs_.resize(num_arcs);
    for (std::size_t i = 0; i < num_arcs; ++i) {
        Arc& arc = arcs_[i];
        arc.from = points[i];
        arc.to = points[(i + 1) % points.size()];
        const glm::dvec3 normal = glm::cross(arc.from, arc.to);
        const double sine = glm::length(normal);
        if (sine > 1e-14) {
            arc.normal = normal / sine;
            arc.after_from = glm::cross(arc.normal, arc.from);
            arc.before_to = glm::cross(arc.to, arc.normal);
        }
        arc.middle = glm::normalize(arc.from + arc.to);
        arc.half_chord = glm::length(arc.middle - arc.from);
    }
    nodes_.reserve(2 * num_arcs);
    build(0, static_cast<std::uint32_t>(num_arcs));
}

void ArcTree::build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t index = nodes_.size();
    nodes_.emplace_back();
    Node node;
    node.begin = begin;
    node.end = end;
    for (std::uint32_t i = begin; i < end; ++i)
        node.centre += arcs_[i].middle / static_cast<double>(end - begin);
    for (std::uint32_t i = begin; i < end; ++i)
        node.radius =
            std::max(node.radius, glm::length(arcs_[i].middle - node.centre) + arcs_[i].half_chord);
    if (end - begin > LeafSize) {
        const std::uint32_t middle = begin + (end - begin) / 2;
        build(begin, middle);
        node.second = static_cast<std::uint32_t>(nodes_.size());
        build(middle, end);
    }
    nodes_[index] = node;
}

double ArcTree::squared_distance(const glm::dvec3& w, double limit) const {
    struct Waiting {
        std::uint32_t node;
        /// Distance to the ball's centre less the ball's radius.
        double distance;
    };
    const auto waiting = [&](std::uint32_t node) {
        return Waiting{node, glm::length(w - nodes_[node].centre) - nodes_[node].radius};
    };
    std::array<Waiting, StackSize> stack;
    std::size_t size = 0;
    stack[size++] = waiting(0);
    double nearest = limit;
    while (size > 0) {
        const Waiting next = stack[--size];
        if (next.distance > 0.0 && next.distance * next.distance >= nearest)
            continue;
        const Node& node = nodes_[next.node];
        if (node.second == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                nearest = std::min(nearest, arcs_[i].squared_distance(w));
            continue;
        }
        // The nearer node comes first, so the other one is mostly skipped.
        Waiting near = waiting(next.node + 1), far = waiting(node.second);
        if (far.distance < near.distance)
            std::swap(near, far);
        stack[size++] = far;
        stack[size++] = near;
    }
    return nearest;
}

template<typename Visit>
void ArcTree::visit_within(const glm::dvec3& w, double chord, const Visit& visit) const {
    std::array<std::uint32_t, StackSize> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::uint32_t index = stack[--size];
        const Node& node = nodes_[index];
        const double reach = chord + node.radius;
        if (squared_length(w - node.centre) > reach * reach)
            continue;
        if (node.second != 0) {
            stack[size++] = node.second;
            stack[size++] = index + 1;
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i)
            if (arcs_[i].squared_distance(w) <= chord * chord && !visit(i))
                return;
    }
}

bool ArcTree::several_within(const glm::dvec3& w, double chord) const {
    int found = 0;
    visit_within(w, chord, [&](std::uint32_t) { return ++found < 2; });
    return found == 2;
}

void ArcTree::set_plane(std::span<const glm::dvec2> starts) {
    assert(starts.size() == arcs_.size() && "a closed line has as many arcs as points");
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
        arcs_[i].plane_from = starts[i];
        arcs_[i].plane_to = starts[(i + 1) % starts.size()];
    }
    for (Node& node : nodes_) {
        node.low = std::numeric_limits<double>::max();
        node.high = std::numeric_limits<double>::lowest();
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            node.low = std::min({node.low, arcs_[i].plane_from.y, arcs_[i].plane_to.y});
            node.high = std::max({node.high, arcs_[i].plane_from.y, arcs_[i].plane_to.y});
        }
    }
}

bool ArcTree::encloses(const glm::dvec2& point) const {
    // Counts the edges that a ray along the first coordinate crosses.
    std::array<std::uint32_t, StackSize> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    bool inside = false;
    while (size > 0) {
        const std::uint32_t index = stack[--size];
        const Node& node = nodes_[index];
        if (point.y < node.low || point.y > node.high)
            continue;
        if (node.second != 0) {
            stack[size++] = node.second;
            stack[size++] = index + 1;
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const glm::dvec2& a = arcs_[i].plane_from;
            const glm::dvec2& b = arcs_[i].plane_to;
            if ((a.y > point.y) != (b.y > point.y) &&
                point.x < a.x + (point.y - a.y) * ((b.x - a.x) / (b.y - a.y)))
                inside = !inside;
        }
    }
    return inside;
}

namespace {

/// Returns how far from a ball's centre an arc may be to matter in the ball. At any w in the ball,
/// the nearest arc is within distance + chord of w, so within distance + 2 chord of the centre. An
/// arc within `chord` of w is within 2 chord of the centre. The result is a little larger, for
/// rounding.
double reach_of(double distance, double chord) {
    return (distance + 2.0 * chord) * (1.0 + 1e-9) + 1e-12;
}

} // namespace

NearArcs::NearArcs(const NearArcs& wider, const glm::dvec3& w, double chord) : tree_(wider.tree_) {
    if (wider.too_many()) {
        distance_ = std::sqrt(tree_->squared_distance(w));
        collect_from_tree(w, reach_of(distance_, chord));
        return;
    }
    std::array<double, MaxArcs> squared;
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < wider.count_; ++i) {
        squared[i] = tree_->arcs_[wider.arcs_[i]].squared_distance(w);
        nearest = std::min(nearest, squared[i]);
    }
    distance_ = std::sqrt(nearest);
    const double reach = reach_of(distance_, chord);
    for (std::size_t i = 0; i < wider.count_; ++i)
        if (squared[i] <= reach * reach)
            arcs_[count_++] = wider.arcs_[i];
}

void NearArcs::collect_from_tree(const glm::dvec3& w, double reach) {
    tree_->visit_within(w, reach, [&](std::uint32_t arc) {
        if (count_ == MaxArcs) {
            count_ = MaxArcs + 1;
            return false;
        }
        arcs_[count_++] = arc;
        return true;
    });
}

double NearArcs::squared_distance(const glm::dvec3& w, double limit) const {
    if (too_many())
        return tree_->squared_distance(w, limit);
    double nearest = limit;
    for (std::size_t i = 0; i < count_; ++i)
        nearest = std::min(nearest, tree_->arcs_[arcs_[i]].squared_distance(w));
    return nearest;
}

bool NearArcs::several_within(const glm::dvec3& w, double chord) const {
    if (too_many())
        return tree_->several_within(w, chord);
    int found = 0;
    for (std::size_t i = 0; i < count_; ++i)
        if (tree_->arcs_[arcs_[i]].squared_distance(w) <= chord * chord && ++found == 2)
            return true;
    return false;
}

} // namespace relumine::cubemap
