// Great-circle arcs in the order of a line, in a tree of balls: the distance to the nearest in
// logarithmic time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::cubemap {

/// Distances are chords (straight through the sphere), so they obey the triangle inequality and
/// need no arctangents.
class ArcTree {
public:
    /// Arcs between neighbours of unit points, and from the last to the first if closed. One point
    /// is an arc of no length.
    ArcTree(std::span<const glm::dvec3> points, bool closed);

    /// Squared chord from a unit direction to the nearest arc, or `limit` if none is nearer.
    [[nodiscard]] double squared_distance(const glm::dvec3& w,
                                          double limit = std::numeric_limits<double>::max()) const;

    /// Whether two or more arcs come within a chord of a unit direction.
    [[nodiscard]] bool several_within(const glm::dvec3& w, double chord) const;

    /// Sets plane coordinates of the arcs' ends, [number of arcs] starts; arc i ends where arc i +
    /// 1 starts.
    void set_plane(std::span<const glm::dvec2> starts);

    /// Even-odd rule for a point of that plane. Only for closed lines.
    [[nodiscard]] bool encloses(const glm::dvec2& point) const;

private:
    friend class NearArcs;
    struct Arc {
        glm::dvec3 from{0.0}, to{0.0};
        /// Unit, of the great circle; zero for an arc of no length
        glm::dvec3 normal{0.0};
        /// Normals of the planes that bound the arc's lune
        glm::dvec3 after_from{0.0}, before_to{0.0};
        glm::dvec3 middle{0.0};
        /// From the middle to an end
        double half_chord = 0.0;
        glm::dvec2 plane_from{0.0}, plane_to{0.0};
        [[nodiscard]] double squared_distance(const glm::dvec3& w) const;
    };
    /// Arcs [begin, end) within a ball; its first child follows it, the second is at `second` (0: a
    /// leaf).
    struct Node {
        glm::dvec3 centre{0.0};
        double radius = 0.0;
        /// Range of the second plane coordinate
        double low = 0.0, high = 0.0;
        std::uint32_t begin = 0, end = 0, second = 0;
    };
    void build(std::uint32_t begin, std::uint32_t end);
    /// Calls `visit(arc)` for the arcs within a chord of a unit direction until it returns false.
    template<typename Visit>
    void visit_within(const glm::dvec3& w, double chord, const Visit& visit) const;

    std::vector<Arc> arcs_;
    std::vector<Node> nodes_;
};

/// The arcs of a tree that matter in a ball around a direction: those that may be the nearest of a
/// direction in it, or within the ball's radius of one. There the answers are the tree's, bit by
/// bit, from a few arcs instead of a search. The tree must outlive it.
class NearArcs {
public:
    /// Of all directions within a chord of a unit direction.
    NearArcs(const ArcTree& tree, const glm::dvec3& w, double chord);
    /// The same from the arcs of a ball that this one lies in.
    NearArcs(const NearArcs& wider, const glm::dvec3& w, double chord);

    /// From the ball's centre to the nearest arc.
    [[nodiscard]] double distance() const { return distance_; }

    /// As ArcTree's, for directions in the ball.
    [[nodiscard]] double squared_distance(const glm::dvec3& w,
                                          double limit = std::numeric_limits<double>::max()) const;
    /// As ArcTree's, for directions in the ball and chords up to its radius.
    [[nodiscard]] bool several_within(const glm::dvec3& w, double chord) const;
    /// As ArcTree's; this one question goes to the tree.
    [[nodiscard]] bool encloses(const glm::dvec2& point) const { return tree_->encloses(point); }

private:
    /// More than these are not fewer work than the tree: a ball this large asks it.
    static constexpr std::size_t MaxArcs = 64;
    [[nodiscard]] bool too_many() const { return count_ > MaxArcs; }
    void collect_from_tree(const glm::dvec3& w, double reach);

    const ArcTree* tree_;
    double distance_ = 0.0;
    /// MaxArcs + 1: too many
    std::size_t count_ = 0;
    std::array<std::uint32_t, MaxArcs> arcs_;
};

} // namespace relumine::cubemap
