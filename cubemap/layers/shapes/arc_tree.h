// A line of great-circle arcs in a tree of balls. The tree finds the distance to the nearest arc in
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

/// A tree over the arcs of a line. Distances are chords, straight through the sphere: they obey the
/// triangle inequality and need no arctangents.
class ArcTree {
public:
    /// Makes arcs between neighbouring unit points, and from the last to the first point if closed.
    /// A single point is an arc without length.
    ArcTree(std::span<const glm::dvec3> points, bool closed);

    /// Returns the squared chord from a unit direction to the nearest arc, or `limit` if no arc is
    /// nearer.
    [[nodiscard]] double squared_distance(const glm::dvec3& w,
                                          double limit = std::numeric_limits<double>::max()) const;

    /// Returns true if two or more arcs come within a chord of a unit direction.
    [[nodiscard]] bool several_within(const glm::dvec3& w, double chord) const;

    /// Sets plane coordinates of the arcs' ends. Arc i ends where arc i + 1 starts.
    /// Shape:   `starts` is [number of arcs].
    void set_plane(std::span<const glm::dvec2> starts);

    /// Returns true if the line encloses a point of the plane of set_plane(), by the even-odd rule.
    /// Only for closed lines.
    [[nodiscard]] bool encloses(const glm::dvec2& point) const;

private:
    friend class NearArcs;
    struct Arc {
        glm::dvec3 from{0.0}, to{0.0};
        /// Unit normal of the great circle; zero for an arc without length.
        glm::dvec3 normal{0.0};
        /// Normals of the planes that bound the arc's lune.
        glm::dvec3 after_from{0.0}, before_to{0.0};
        glm::dvec3 middle{0.0};
        /// Chord from the middle to an end.
        double half_chord = 0.0;
        glm::dvec2 plane_from{0.0}, plane_to{0.0};
        [[nodiscard]] double squared_distance(const glm::dvec3& w) const;
    };
    /// Arcs [begin, end) within a ball. The first child follows the node; the second child is at
    /// `second` (0: the node is a leaf).
    struct Node {
        glm::dvec3 centre{0.0};
        double radius = 0.0;
        /// Range of the second plane coordinate.
        double low = 0.0, high = 0.0;
        std::uint32_t begin = 0, end = 0, second = 0;
    };
    void build(std::uint32_t begin, std::uint32_t end);
    /// Calls `visit(arc)` for the arcs within a chord of a unit direction, until `visit` returns
    /// false.
    template<typename Visit>
    void visit_within(const glm::dvec3& w, double chord, const Visit& visit) const;

    std::vector<Arc> arcs_;
    std::vector<Node> nodes_;
};

/// The arcs of a tree that matter for directions in a ball: arcs that may be the nearest of such a
/// direction, and arcs within the ball's radius of one. For directions in the ball the answers are
/// the tree's answers, bit by bit, from a few arcs instead of a search. The tree must outlive the
/// object.
class NearArcs {
public:
    /// Takes all arcs.
    explicit NearArcs(const ArcTree& tree) : tree_(&tree), count_(MaxArcs + 1) {}
    /// Takes the ball of all directions within a chord of a unit direction, from the arcs of a ball
    /// that holds this ball.
    NearArcs(const NearArcs& wider, const glm::dvec3& w, double chord);

    /// Chord from the ball's centre to the nearest arc, of a ball.
    [[nodiscard]] double distance() const { return distance_; }

    /// Returns ArcTree::squared_distance() of a direction in the ball.
    [[nodiscard]] double squared_distance(const glm::dvec3& w,
                                          double limit = std::numeric_limits<double>::max()) const;
    /// Returns ArcTree::several_within() of a direction in the ball, for chords up to its radius.
    [[nodiscard]] bool several_within(const glm::dvec3& w, double chord) const;
    /// Returns ArcTree::encloses(). The tree answers this question.
    [[nodiscard]] bool encloses(const glm::dvec2& point) const { return tree_->encloses(point); }

private:
    /// Testing more arcs than these costs as much as asking the tree, so a ball with more arcs asks
    /// the tree.
    static constexpr std::size_t MaxArcs = 64;
    [[nodiscard]] bool too_many() const { return count_ > MaxArcs; }
    void collect_from_tree(const glm::dvec3& w, double reach);

    const ArcTree* tree_;
    double distance_ = 0.0;
    /// MaxArcs + 1: there are more arcs than arcs_ holds.
    std::size_t count_ = 0;
    std::array<std::uint32_t, MaxArcs> arcs_;
};

} // namespace relumine::cubemap
