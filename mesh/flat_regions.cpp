#include "mesh/flat_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include "files/parallel.h"
#include "mesh/exact_sign.h"

namespace relumine::mesh {

namespace {

/// An edge in the direction of its triangle.
struct HalfEdge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    std::uint32_t triangle = 0;
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> ends() const {
        return std::minmax(from, to);
    }
};

/// Disjoint sets that can be joined.
class Regions {
public:
    explicit Regions(std::size_t n) : parents_(n) {
        std::iota(parents_.begin(), parents_.end(), 0u);
    }
    std::uint32_t root(std::uint32_t i) {
        while (parents_[i] != i)
            i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        parents_[std::max(root(a), root(b))] = std::min(root(a), root(b));
    }

private:
    std::vector<std::uint32_t> parents_;
};

/// Returns a point's two coordinates other than `axis`. Turns of points in one plane all keep their
/// direction in this projection, or all reverse it.
glm::vec2 without(int axis, const glm::vec3& point) {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

/// Returns how a triangle turns, seen along each axis. Triangles of one plane that turn the same
/// way on every axis have the same side up.
std::array<int, 3> turns(const TriangleMesh& mesh, const Triangle& triangle) {
    std::array<int, 3> result{};
    for (int axis = 0; axis < 3; ++axis)
        result[static_cast<std::size_t>(axis)] = turn(without(axis, mesh.positions[triangle[0]]),
                                                      without(axis, mesh.positions[triangle[1]]),
                                                      without(axis, mesh.positions[triangle[2]]));
    return result;
}

/// Returns the vertices of half-edges in order if they are one loop. Returns nothing otherwise.
std::optional<std::vector<std::uint32_t>> loop_of(std::vector<HalfEdge> outline) {
    std::sort(outline.begin(), outline.end(),
              [](const HalfEdge& a, const HalfEdge& b) { return a.from < b.from; });
    const auto leaving = [&](std::uint32_t vertex) {
        return std::lower_bound(
            outline.begin(), outline.end(), vertex,
            [](const HalfEdge& edge, std::uint32_t v) { return edge.from < v; });
    };
    std::vector<std::uint32_t> loop;
    std::uint32_t vertex = outline.front().from;
    do {
        const auto edge = leaving(vertex);
        const bool one_way_on = edge != outline.end() && edge->from == vertex &&
                                (edge + 1 == outline.end() || (edge + 1)->from != vertex);
        if (!one_way_on || loop.size() == outline.size())
            return std::nullopt;
        loop.push_back(vertex);
        vertex = edge->to;
    } while (vertex != outline.front().from);
    if (loop.size() != outline.size())
        return std::nullopt; // there are holes
    return loop;
}

/// Returns the corners of the convex polygon that half-edges enclose. Returns nothing unless they
/// are one loop that turns one way and goes around once.
///
/// All triangles of the region turn the same way. So each point off their edges is covered as often
/// as the outline winds around it: once inside such a loop, never outside.
std::optional<std::vector<std::uint32_t>> convex_outline(const TriangleMesh& mesh,
                                                         std::vector<HalfEdge> outline,
                                                         const std::array<int, 3>& orientation) {
    const auto seen =
        std::find_if(orientation.begin(), orientation.end(), [](int t) { return t != 0; });
    if (seen == orientation.end())
        return std::nullopt;
    const auto axis = static_cast<int>(seen - orientation.begin());
    const auto loop = loop_of(std::move(outline));
    if (!loop)
        return std::nullopt;
    const auto at = [&](std::size_t i) {
        return without(axis, mesh.positions[(*loop)[i % loop->size()]]);
    };

    // Corners turn like the triangles. A vertex between two sides of one line must lie between
    // their ends.
    std::vector<std::uint32_t> corners;
    // Reversals of the direction along the first coordinate. An outline that goes around once has
    // two.
    int num_reversals = 0;
    int last_direction = 0;
    int first_direction = 0;
    for (std::size_t i = 0; i < loop->size(); ++i) {
        const glm::vec2 before = at(i + loop->size() - 1);
        const glm::vec2 here = at(i);
        const glm::vec2 after = at(i + 1);
        const int t = turn(before, here, after);
        if (t == -*seen)
            return std::nullopt;
        if (t != 0)
            corners.push_back((*loop)[i]);
        else if ((before.x < here.x) != (here.x < after.x) ||
                 (before.y < here.y) != (here.y < after.y) ||
                 (before.x > here.x) != (here.x > after.x) ||
                 (before.y > here.y) != (here.y > after.y))
            return std::nullopt; // the outline turns back on itself
        // For a side that goes straight up or down, the second coordinate decides.
        const int direction =
            here.x != after.x ? (here.x < after.x ? 1 : -1) : (here.y < after.y ? 1 : -1);
        num_reversals += static_cast<int>(last_direction != 0 && direction != last_direction);
        last_direction = direction;
        if (first_direction == 0)
            first_direction = direction;
    }
    num_reversals += static_cast<int>(last_direction != first_direction);
    if (num_reversals != 2 || corners.size() < 3)
        return std::nullopt;
    return corners;
}

/// All edges of all triangles, by their lower vertices.
class Edges {
public:
    explicit Edges(const TriangleMesh& mesh)
        : begins_(mesh.positions.size() + 1), all_(3 * mesh.num_triangles()) {
        const auto for_each = [&](const auto& visit) {
            for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
                for (std::size_t k = 0; k < 3; ++k)
                    visit(HalfEdge{mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3], i});
        };
        for_each([&](const HalfEdge& edge) { ++begins_[edge.ends().first + 1]; });
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
        std::vector<std::size_t> places(begins_.begin(), begins_.end() - 1);
        for_each([&](const HalfEdge& edge) { all_[places[edge.ends().first]++] = edge; });
        files::parallel_for(std::size_t{0}, places.size(), [&](std::size_t vertex) {
            const auto begin = all_.begin() + static_cast<std::ptrdiff_t>(begins_[vertex]);
            const auto end = all_.begin() + static_cast<std::ptrdiff_t>(begins_[vertex + 1]);
            std::sort(begin, end, [](const HalfEdge& a, const HalfEdge& b) {
                return std::pair(a.ends().second, a.triangle) <
                       std::pair(b.ends().second, b.triangle);
            });
        });
    }

    /// Edges between the same two vertices follow each other.
    [[nodiscard]] const std::vector<HalfEdge>& all() const { return all_; }

    /// Calls `visit(begin, end)` with the places in all() of the edges between the same two
    /// vertices, in parallel.
    template<typename Visit>
    void for_each_line(const Visit& visit) const {
        files::parallel_for(std::size_t{0}, begins_.size() - 1, [&](std::size_t vertex) {
            for (std::size_t begin = begins_[vertex], end = begin; begin < begins_[vertex + 1];
                 begin = end) {
                while (end < begins_[vertex + 1] && all_[end].ends() == all_[begin].ends())
                    ++end;
                visit(begin, end);
            }
        });
    }

private:
    /// [num_vertices + 1] number of edges whose lower vertex comes before each vertex.
    std::vector<std::size_t> begins_;
    std::vector<HalfEdge> all_;
};

/// Returns true if the triangles on both sides of an edge lie in one plane with the same side up.
bool lie_flat(const TriangleMesh& mesh, const HalfEdge& a, const HalfEdge& b) {
    const auto has_three_corners = [&](const HalfEdge& edge) {
        const auto& [i, j, k] = mesh.triangles[edge.triangle];
        return i != j && j != k && k != i;
    };
    const auto opposite = [&](const HalfEdge& edge) {
        const Triangle& t = mesh.triangles[edge.triangle];
        return mesh.positions[*std::find_if(
            t.begin(), t.end(), [&](std::uint32_t v) { return v != edge.from && v != edge.to; })];
    };
    if (!has_three_corners(a) || !has_three_corners(b) ||
        !coplanar(mesh.positions[a.from], mesh.positions[a.to], opposite(a), opposite(b)))
        return false;
    const std::array<int, 3> orientation = turns(mesh, mesh.triangles[a.triangle]);
    return orientation != std::array<int, 3>{} && // it has area, and is not folded over
           orientation == turns(mesh, mesh.triangles[b.triangle]);
}

/// Returns whether each edge lies between two triangles that lie flat, and so is inside a region.
/// Edges with one triangle or with many stay outlines.
std::vector<std::uint8_t> inner_edges(const TriangleMesh& mesh, const Edges& edges) {
    std::vector<std::uint8_t> is_inner(edges.all().size(), 0); // not bool: many threads write
    edges.for_each_line([&](std::size_t begin, std::size_t end) {
        if (end - begin != 2)
            return;
        const HalfEdge &a = edges.all()[begin], &b = edges.all()[begin + 1];
        if (a.from == b.to && lie_flat(mesh, a, b))
            is_inner[begin] = is_inner[begin + 1] = 1;
    });
    return is_inner;
}

} // namespace

std::vector<Triangle> with_flat_regions_merged(const TriangleMesh& mesh) {
    const std::size_t num_triangles = mesh.num_triangles();
    const Edges edges(mesh);
    const std::vector<std::uint8_t> is_inner = inner_edges(mesh, edges);
    Regions regions(num_triangles);
    for (std::size_t i = 0; i < edges.all().size(); ++i)
        if (is_inner[i] != 0) {
            regions.join(edges.all()[i].triangle, edges.all()[i + 1].triangle);
            ++i; // the other side of the same edge
        }

    // The outlines of regions with more than two triangles, region by region.
    std::vector<std::uint32_t> sizes(num_triangles, 0);
    for (std::uint32_t i = 0; i < num_triangles; ++i)
        ++sizes[regions.root(i)];
    if (std::ranges::all_of(sizes, [](std::uint32_t size) { return size <= 2; }))
        return mesh.triangles;
    std::vector<std::pair<std::uint32_t, HalfEdge>> outlines;
    for (std::size_t i = 0; i < edges.all().size(); ++i)
        if (const std::uint32_t region = regions.root(edges.all()[i].triangle);
            is_inner[i] == 0 && sizes[region] > 2)
            outlines.emplace_back(region, edges.all()[i]);
    std::sort(outlines.begin(), outlines.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first, a.second.from) < std::pair(b.first, b.second.from);
    });

    std::vector<bool> is_merged(num_triangles, false); // by region
    std::vector<Triangle> fans;
    for (std::size_t begin = 0, end = 0; begin < outlines.size(); begin = end) {
        std::vector<HalfEdge> outline;
        while (end < outlines.size() && outlines[end].first == outlines[begin].first)
            outline.push_back(outlines[end++].second);
        const std::uint32_t region = outlines[begin].first;
        const auto corners =
            convex_outline(mesh, std::move(outline), turns(mesh, mesh.triangles[region]));
        if (!corners || corners->size() - 2 >= sizes[region])
            continue;
        is_merged[region] = true;
        for (std::size_t i = 2; i < corners->size(); ++i)
            fans.push_back({(*corners)[0], (*corners)[i - 1], (*corners)[i]});
    }
    std::vector<Triangle> result;
    for (std::uint32_t i = 0; i < num_triangles; ++i)
        if (!is_merged[regions.root(i)])
            result.push_back(mesh.triangles[i]);
    result.insert(result.end(), fans.begin(), fans.end());
    return result;
}

} // namespace relumine::mesh
