#include "prt/refinement/refine.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "mesh/half_edge/curved_surface.h"
#include "mesh/half_edge/split_mesh.h"
#include "prt/refinement/coarse_transfer.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

using mesh::SplitMesh;
using Bits = CoarseDirections::Bits;
using Neighbours = CoarseDirections::Neighbours;

/// Middles that are traced together: 50 MB.
constexpr std::size_t PointsPerStep = std::size_t{1} << 18;

/// Of the mesh's diagonal. Edges longer than this are asked at once, and triangles with such a side
/// at points inside that are about as far from each other. What hides between the points is small.
constexpr float LargeTriangle = 1.0f / 24.0f;
/// So many parts of a side at most.
constexpr std::uint32_t MostParts = 24;

/// Parts of the mesh's diagonal. What is narrower than an edge may hide between its ends, so
/// middles of edges are asked in all directions. Along edges shorter than this, whose ends face
/// alike, they are asked only in directions on which the ends do not agree: few on a fine mesh.
constexpr float FineEdge = 1.0f / 256.0f;
constexpr float LeastCosineOfAlike = 0.97f;

/// Of the mesh's diagonal.
constexpr float ShortestEdge = 1e-3f;

/// With a limit of vertices, a round takes this part of what is left. Fewer rounds would split
/// edges that the next round finds to matter less; measured. The last rounds take at least a part
/// of the whole, since every round looks at all edges.
constexpr std::size_t RoundsToLimit = 6;
constexpr std::size_t FewestOfRound = 32, PartsOfWhole = 64;

/// Bounds of edges give way to errors until so small a part of the first edges has bounds only.
constexpr std::size_t PartsWithBounds = 16;

/// As vertex_receivers() does it: a part of the way to the triangle's centre, or the bias.
constexpr float LargestPartOfWay = 0.25f;

/// Parts of automatic_bias(). Smaller lifts are none.
constexpr float LeastLift = 0.25f;

float longest_side(const mesh::TriangleMesh& mesh, const mesh::Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    const std::vector<glm::vec3>& at = mesh.positions;
    return std::max(
        {glm::distance(at[a], at[b]), glm::distance(at[b], at[c]), glm::distance(at[c], at[a])});
}

/// Returns which triangles are coarse for an edge, if there is one; all otherwise.
std::vector<bool> triangles_to_refine(const mesh::TriangleMesh& mesh, std::optional<float> edge) {
    std::vector<bool> result;
    for (const mesh::Triangle& triangle : mesh.triangles)
        result.push_back(!edge || longest_side(mesh, triangle) > *edge);
    return result;
}

mesh::TriangleMesh without_lifts(mesh::TriangleMesh mesh) {
    mesh.lifts.clear();
    return mesh;
}

class Refinement {
public:
    Refinement(const mesh::TriangleMesh& mesh, const Blockers& blockers,
               const RefineOptions& options, const Work& work, RefineReport& report)
        : base_(mesh), blockers_(blockers), options_(options), report_(report),
          split_(without_lifts(mesh)), progress_(work), step_(automatic_bias(mesh)),
          bias_(options.bias.value_or(step_)),
          directions_(options.light ? &*options.light : nullptr),
          large_(LargeTriangle * mesh::bounds(mesh).diagonal()),
          fine_(FineEdge * mesh::bounds(mesh).diagonal()),
          min_edge_(options.min_edge.value_or(ShortestEdge * mesh::bounds(mesh).diagonal())),
          is_refined_(triangles_to_refine(mesh, options.coarse_edge)), lifts_(mesh.lifts) {}

    mesh::TriangleMesh run() {
        progress_.start_stage(0.0, 1.0);
        if (options_.max_edge)
            while (split_long_edges())
                ++report_.num_rounds;
        if (options_.error) {
            trace_vertices();
            for (;;) {
                bound_new_edges();
                ask_large_triangles();
                if (!split_by_error())
                    break;
                ++report_.num_rounds;
                trace_vertices();
                report_progress();
            }
        }
        report_.num_added = num_vertices() - base_.num_vertices();
        if (options_.curved)
            return bent();
        if (!options_.error)
            return split_.take();
        const std::vector<Way> ways = ways_out();
        mesh::TriangleMesh mesh = split_.take();
        if (std::any_of(lifts_.begin(), lifts_.end(),
                        [](const glm::vec3& lift) { return lift != glm::vec3(0.0f); }))
            mesh.lifts = lifts_;
        return moved_out(std::move(mesh), ways);
    }

private:
    [[nodiscard]] std::size_t num_vertices() const { return split_.mesh().num_vertices(); }
    [[nodiscard]] std::size_t room() const { return options_.max_vertices - num_vertices(); }

    void report_progress() {
        const auto num_new = static_cast<double>(num_vertices() - base_.num_vertices());
        const auto most = static_cast<double>(options_.max_vertices - base_.num_vertices());
        progress_.report(
            std::max(most > 0.0 ? num_new / most : 1.0,
                     1.0 - std::exp2(-0.25 * static_cast<double>(report_.num_rounds))));
    }

    /// Splits edges that are too long, in each round those nearly as long as the longest: so edges
    /// are even also where the limit of vertices ends the work.
    bool split_long_edges() {
        constexpr float NearlyAsLong = 0.7f;
        float longest = 0.0f;
        for (std::uint32_t edge = 0; edge < split_.num_edges(); ++edge)
            if (!split_.is_split(edge))
                longest = std::max(longest, split_.length(edge));
        const float least = std::max(*options_.max_edge, NearlyAsLong * longest);
        if (!(longest > *options_.max_edge))
            return false;
        std::vector<std::uint32_t> edges;
        for (std::uint32_t edge = 0; edge < split_.num_edges(); ++edge)
            if (!split_.is_split(edge) && split_.length(edge) > least)
                edges.push_back(edge);
        std::stable_sort(edges.begin(), edges.end(), [&](std::uint32_t a, std::uint32_t b) {
            return split_.length(a) > split_.length(b);
        });
        for (const std::uint32_t edge : edges)
            if (!split_.mark(edge, room()))
                report_.is_at_limit = true;
        if (split_.num_marked() == 0)
            return false;
        progress_.poll();
        split_.split();
        return true;
    }

    /// Finds what reaches the vertices that are not known yet, of triangles that are refined.
    void trace_vertices() {
        lift_new_vertices();
        Receivers all = vertex_receivers(split_.mesh());
        for (std::size_t vertex = 0; vertex < all.size(); ++vertex)
            all.positions[vertex] += lifts_[vertex];
        is_traced_.resize(all.size());
        vertex_bits_.resize(all.size());
        std::vector<Neighbours> ends_of(all.size());
        for (const SplitMesh::Middle& middle : split_.new_vertices())
            if (is_traced_[middle.low] && is_traced_[middle.high])
                ends_of[middle.vertex] = neighbours(middle.low, middle.high);
        std::vector<std::uint32_t> vertices;
        for (const std::uint32_t triangle : split_.changed_triangles())
            if (is_refined_[split_.origin(triangle).triangle])
                for (const std::uint32_t vertex : split_.mesh().triangles[triangle])
                    if (!is_traced_[vertex]) {
                        is_traced_[vertex] = true;
                        vertices.push_back(vertex);
                    }
        Receivers added;
        std::vector<Neighbours> ends;
        for (const std::uint32_t vertex : vertices) {
            added.positions.push_back(all.positions[vertex]);
            added.normals.push_back(all.normals[vertex]);
            ends.push_back(ends_of[vertex]);
        }
        const std::vector<Bits> bits = trace(added, ends);
        for (std::size_t i = 0; i < vertices.size(); ++i)
            vertex_bits_[vertices[i]] = bits[i];
        find_movable();
    }

    /// Finds the smooth surface over new vertices: where the triangles beside one do not agree, the
    /// highest.
    void lift_new_vertices() {
        lifts_.resize(num_vertices(), glm::vec3(0.0f));
        if (options_.curved)
            return;
        std::vector<bool> is_new(num_vertices());
        for (const SplitMesh::Middle& middle : split_.new_vertices())
            is_new[middle.vertex] = true;
        for (const std::uint32_t triangle : split_.changed_triangles())
            for (std::size_t k = 0; k < 3; ++k) {
                std::array<float, 3> weights{};
                weights[k] = 1.0f;
                glm::vec3& own = lifts_[split_.mesh().triangles[triangle][k]];
                if (const glm::vec3 lift = lift_at(triangle, weights);
                    is_new[split_.mesh().triangles[triangle][k]] &&
                    glm::length(lift) > glm::length(own))
                    own = lift;
            }
    }

    /// Returns how far the smooth surface lies above a point of a triangle.
    [[nodiscard]] glm::vec3 lift_at(std::uint32_t triangle,
                                    const std::array<float, 3>& weights) const {
        const SplitMesh::Origin& origin = split_.origin(triangle);
        const MeshPoint point{.triangle = origin.triangle,
                              .barycentric = weights[0] * origin.corners[0] +
                                             weights[1] * origin.corners[1] +
                                             weights[2] * origin.corners[2]};
        const glm::vec3 lift =
            smooth_position(base_, point) - value_at(base_, base_.positions, point);
        // Of a flat triangle it is rounding.
        return glm::length(lift) > LeastLift * step_ ? lift : glm::vec3(0.0f);
    }

    /// A new vertex may move where the surface around it is flat and goes on to all sides.
    void find_movable() {
        constexpr float LeastCosine = 0.99999f;
        constexpr double LargestGap = 1e-3;
        const mesh::TriangleMesh& mesh = split_.mesh();
        std::vector<double> angles(mesh.num_vertices(), 0.0);
        std::vector<glm::vec3> faces(mesh.num_vertices(), glm::vec3(0.0f));
        is_movable_.resize(mesh.num_vertices());
        for (const std::uint32_t triangle : split_.changed_triangles()) {
            const glm::vec3 face = face_normal(mesh, triangle);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = mesh.triangles[triangle][k];
                const glm::dvec3 at(mesh.positions[vertex]);
                const auto way = [&](std::size_t other) {
                    return glm::normalize(
                        glm::dvec3(mesh.positions[mesh.triangles[triangle][other % 3]]) - at);
                };
                angles[vertex] +=
                    std::acos(std::clamp(glm::dot(way(k + 1), way(k + 2)), -1.0, 1.0));
                if (faces[vertex] == glm::vec3(0.0f))
                    faces[vertex] = face;
                else if (!(glm::dot(faces[vertex], face) > LeastCosine))
                    angles[vertex] = std::numeric_limits<double>::infinity();
            }
        }
        for (const SplitMesh::Middle& middle : split_.new_vertices())
            is_movable_[middle.vertex] =
                std::abs(angles[middle.vertex] - 2.0 * std::numbers::pi) < LargestGap;
    }

    [[nodiscard]] bool is_hidden(std::uint32_t vertex) const {
        return CoarseDirections::is_hidden(vertex_bits_[vertex]);
    }
    [[nodiscard]] bool moves_to(std::uint32_t hidden, std::uint32_t lit) const {
        return is_movable_[hidden] && is_hidden(hidden) && !is_hidden(lit);
    }

    /// Whether one end of a short edge will move towards the other. There is no need to split it.
    [[nodiscard]] bool is_left_to_move(std::uint32_t edge) {
        if (split_.length(edge) >= 4.0f * min_edge_ || options_.curved)
            return false;
        ends_.clear();
        split_.append_ends(edge, ends_);
        return ends_.size() == 1 &&
               (moves_to(ends_[0].low, ends_[0].high) || moves_to(ends_[0].high, ends_[0].low));
    }

    /// From a vertex that is hidden in another solid, along an edge to the first place that light
    /// reaches.
    struct Way {
        std::uint32_t vertex, towards;
        /// The last part of the way that is known to be hidden, and the first that is not.
        float hidden = 0.0f, lit = 1.0f;
    };

    /// Returns the ways along which hidden vertices may leave, by bisection.
    std::vector<Way> ways_out() {
        constexpr int Bisections = 6;
        const mesh::TriangleMesh& mesh = split_.mesh();
        is_movable_.resize(mesh.num_vertices());
        is_traced_.resize(mesh.num_vertices());
        std::vector<Way> ways;
        for (const mesh::Triangle& triangle : mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
                // Around a vertex that may move, each edge leaves in one triangle.
                if (is_movable_[a] && is_traced_[a] && is_traced_[b] && moves_to(a, b))
                    ways.push_back({a, b});
            }
        for (int i = 0; i < Bisections; ++i) {
            Receivers receivers;
            for (const Way& way : ways) {
                const float part = 0.5f * (way.hidden + way.lit);
                add_mean(std::array{way.vertex, way.towards}, std::array{1.0f - part, part},
                         receivers);
            }
            const std::vector<Bits> bits = trace(receivers);
            for (std::size_t j = 0; j < ways.size(); ++j) {
                // Beside a solid half of the light is left. Gaps between solids let in little.
                const int least =
                    std::max(CoarseDirections::FewestDirections,
                             CoarseDirections::num_lit(vertex_bits_[ways[j].towards]) / 4);
                (CoarseDirections::num_lit(bits[j]) < least ? ways[j].hidden : ways[j].lit) =
                    0.5f * (ways[j].hidden + ways[j].lit);
            }
        }
        return ways;
    }

    /// Moves vertices out of other solids, each by the shortest way that turns no triangle over:
    /// their darkness would spread over the triangles beside them.
    static mesh::TriangleMesh moved_out(mesh::TriangleMesh mesh, const std::vector<Way>& ways) {
        const auto length = [&](const Way& way) {
            return way.lit * glm::distance(mesh.positions[way.vertex], mesh.positions[way.towards]);
        };
        std::vector<std::pair<float, Way>> sorted;
        sorted.reserve(ways.size());
        for (const Way& way : ways)
            sorted.emplace_back(length(way), way);
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<std::vector<std::uint32_t>> around(ways.empty() ? 0 : mesh.num_vertices());
        std::vector<bool> is_done(around.size());
        for (const Way& way : ways)
            is_done[way.vertex] = true;
        if (!ways.empty())
            for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
                for (const std::uint32_t vertex : mesh.triangles[i])
                    if (is_done[vertex])
                        around[vertex].push_back(i);
        is_done.assign(around.size(), false);
        for (const auto& [distance, way] : sorted)
            if (!is_done[way.vertex])
                is_done[way.vertex] = move(mesh, way, around[way.vertex]);
        return mesh;
    }

    /// Moves a vertex of a flat surface, with all that it carries. Returns false where a triangle
    /// would turn over.
    static bool move(mesh::TriangleMesh& mesh, const Way& way,
                     std::span<const std::uint32_t> triangles) {
        const glm::vec3 before = mesh.positions[way.vertex];
        const glm::vec3 after = before + way.lit * (mesh.positions[way.towards] - before);
        const auto cross = [&](std::uint32_t triangle, const glm::vec3& at) {
            std::array<glm::dvec3, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = mesh.triangles[triangle][k];
                corners[k] = glm::dvec3(vertex == way.vertex ? at : mesh.positions[vertex]);
            }
            return glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        };
        constexpr double LeastPart = 1e-3;
        for (const std::uint32_t triangle : triangles) {
            const glm::dvec3 old = cross(triangle, before);
            if (!(glm::dot(cross(triangle, after), old) > LeastPart * glm::dot(old, old)))
                return false;
        }
        // A triangle's uvs go on evenly beyond its corner.
        if (!mesh.corner_uvs.empty())
            for (const std::uint32_t triangle : triangles) {
                const mesh::Triangle corners = mesh.triangles[triangle];
                const auto k = static_cast<std::size_t>(
                    std::find(corners.begin(), corners.end(), way.vertex) - corners.begin());
                const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
                const glm::dvec3 normal = cross(triangle, before);
                const glm::dvec3 origin(before), to(after);
                const glm::dvec3 u = glm::dvec3(mesh.positions[corners[next]]) - origin;
                const glm::dvec3 v = glm::dvec3(mesh.positions[corners[last]]) - origin;
                const double square = glm::dot(normal, normal);
                const auto part_u =
                    static_cast<float>(glm::dot(glm::cross(to - origin, v), normal) / square);
                const auto part_v =
                    static_cast<float>(glm::dot(glm::cross(u, to - origin), normal) / square);
                auto& uvs = mesh.corner_uvs[triangle];
                uvs[k] += part_u * (uvs[next] - uvs[k]) + part_v * (uvs[last] - uvs[k]);
            }
        const auto follow = [&](auto& values) {
            if (!values.empty())
                values[way.vertex] += way.lit * (values[way.towards] - values[way.vertex]);
        };
        follow(mesh.uvs);
        follow(mesh.colors);
        follow(mesh.lifts);
        mesh.positions[way.vertex] = after;
        return true;
    }

    std::vector<Bits> trace(const Receivers& receivers,
                            std::span<const Neighbours> neighbours = {}) {
        report_.num_points += receivers.size();
        return directions_.trace(receivers, blockers_, bias_, progress_, neighbours);
    }

    /// Returns what the ends of an edge tell of its middle.
    [[nodiscard]] Neighbours neighbours(std::uint32_t low, std::uint32_t high) const {
        const mesh::TriangleMesh& mesh = split_.mesh();
        if (glm::distance(mesh.positions[low], mesh.positions[high]) > fine_ ||
            glm::dot(mesh.normals[low], mesh.normals[high]) < LeastCosineOfAlike)
            return {};
        return {&vertex_bits_[low], &vertex_bits_[high]};
    }

    [[nodiscard]] CoarseDirections::Point vertex(std::uint32_t index, float weight = 1.0f) const {
        return {split_.mesh().normals[index], &vertex_bits_[index], weight};
    }

    /// A point with the weighted mean of vertices' positions and normals.
    void add_mean(std::span<const std::uint32_t> vertices, std::span<const float> weights,
                  Receivers& receivers) const {
        const mesh::TriangleMesh& mesh = split_.mesh();
        glm::dvec3 position(0.0), normal(0.0);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const double weight = double{weights[i]};
            position += weight * glm::dvec3(mesh.positions[vertices[i]]);
            normal += weight * glm::dvec3(mesh.normals[vertices[i]]);
        }
        const double length = glm::length(normal);
        constexpr double Shortest = 1e-4;
        receivers.positions.emplace_back(position);
        receivers.normals.push_back(length > Shortest ? glm::vec3(normal / length)
                                                      : mesh.normals[vertices.front()]);
    }

    /// The same on a triangle's smooth surface.
    void add_inside(std::uint32_t triangle, const std::array<float, 3>& weights,
                    Receivers& receivers) const {
        add_mean(split_.mesh().triangles[triangle], weights, receivers);
        if (!options_.curved)
            receivers.positions.back() += lift_at(triangle, weights);
    }

    [[nodiscard]] bool may_split(std::uint32_t edge) const {
        return is_candidate_[edge] && !split_.is_split(edge);
    }

    /// The pairs of vertices of some edges.
    struct Pair {
        std::uint32_t edge;
        SplitMesh::Ends ends;
    };

    /// Bounds the errors of the edges that are new: where light changes once along an edge, its
    /// middle is half of the change away from the mean. Long edges are asked at once, since light
    /// may change there and back.
    void bound_new_edges() {
        const auto first = static_cast<std::uint32_t>(errors_.size());
        errors_.resize(split_.num_edges(), 0.0f);
        is_asked_.resize(split_.num_edges(), true);
        is_candidate_.resize(split_.num_edges());
        std::vector<Pair> pairs;
        std::vector<std::uint32_t> long_edges;
        for (std::uint32_t edge = first; edge < split_.num_edges(); ++edge) {
            // An edge that a triangle which stays has on its other side is a candidate, too.
            ends_.clear();
            split_.append_ends(edge, ends_);
            is_candidate_[edge] =
                !is_left_to_move(edge) && !split_.is_split(edge) &&
                split_.length(edge) >= 2.0f * min_edge_ && split_.length(edge) > 0.0f &&
                std::all_of(ends_.begin(), ends_.end(), [this](const SplitMesh::Ends& ends) {
                    return is_traced_[ends.low] && is_traced_[ends.high];
                });
            if (!may_split(edge))
                continue;
            if (split_.length(edge) > large_) {
                long_edges.push_back(edge);
                continue;
            }
            is_asked_[edge] = false;
            append_pairs(edge, pairs);
        }
        std::vector<float> bounds(pairs.size());
        files::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
            const CoarseDirections::Point high = vertex(pairs[i].ends.high);
            bounds[i] = directions_.difference(vertex(pairs[i].ends.low), {&high, 1},
                                               CoarseDirections::Signs::Dropped) /
                        2.0f;
        });
        set_errors(pairs, bounds);
        ask(long_edges);
    }

    void append_pairs(std::uint32_t edge, std::vector<Pair>& pairs) {
        ends_.clear();
        split_.append_ends(edge, ends_);
        for (const SplitMesh::Ends& ends : ends_)
            pairs.push_back({edge, ends});
    }

    void set_errors(std::span<const Pair> pairs, std::span<const float> errors) {
        for (std::size_t i = 0; i < pairs.size(); ++i)
            errors_[pairs[i].edge] = std::max(errors_[pairs[i].edge], errors[i]);
    }

    /// Finds the errors of edges at their middles.
    void ask(std::span<const std::uint32_t> edges) {
        for (std::size_t next = 0; next < edges.size();) {
            std::vector<Pair> pairs;
            Receivers receivers;
            for (; next < edges.size() && pairs.size() < PointsPerStep; ++next) {
                append_pairs(edges[next], pairs);
                errors_[edges[next]] = 0.0f;
                is_asked_[edges[next]] = true;
            }
            std::vector<Neighbours> ends;
            for (const Pair& pair : pairs) {
                const mesh::Triangle& corners = split_.mesh().triangles[pair.ends.triangle];
                std::array<float, 3> weights{};
                for (std::size_t k = 0; k < 3; ++k)
                    weights[k] =
                        corners[k] == pair.ends.low || corners[k] == pair.ends.high ? 0.5f : 0.0f;
                add_inside(pair.ends.triangle, weights, receivers);
                ends.push_back(neighbours(pair.ends.low, pair.ends.high));
                if (pair.ends.is_rim)
                    move_inside(pair.ends.triangle, receivers.positions.back());
            }
            const std::vector<Bits> bits = trace(receivers, ends);
            std::vector<float> errors(pairs.size());
            files::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
                const std::array both = {vertex(pairs[i].ends.low, 0.5f),
                                         vertex(pairs[i].ends.high, 0.5f)};
                errors[i] = directions_.difference({receivers.normals[i], &bits[i]}, both);
            });
            set_errors(pairs, errors);
        }
    }

    void move_inside(std::uint32_t triangle, glm::vec3& position) const {
        const mesh::Triangle& corners = split_.mesh().triangles[triangle];
        const std::vector<glm::vec3>& positions = split_.mesh().positions;
        const glm::vec3 way =
            (positions[corners[0]] + positions[corners[1]] + positions[corners[2]]) / 3.0f -
            position;
        if (const float length = glm::length(way); length > 0.0f)
            position += std::min(step_ / length, LargestPartOfWay) * way;
    }

    /// A point inside of a triangle, by the weights of its corners.
    struct Inside {
        std::uint32_t triangle;
        std::array<float, 3> weights;
    };

    /// The centres of the k x k triangles that parallels to the sides cut a triangle into.
    static void append_points(std::uint32_t triangle, std::uint32_t k, std::vector<Inside>& all) {
        const auto add = [&](std::uint32_t i, std::uint32_t j, float part) {
            const float b = (static_cast<float>(i) + part) / static_cast<float>(k);
            const float c = (static_cast<float>(j) + part) / static_cast<float>(k);
            all.push_back({triangle, {1.0f - b - c, b, c}});
        };
        for (std::uint32_t i = 0; i < k; ++i)
            for (std::uint32_t j = 0; i + j < k; ++j) {
                add(i, j, 1.0f / 3.0f);
                if (i + j + 1 < k)
                    add(i, j, 2.0f / 3.0f);
            }
    }

    /// What lies in the middle of a large triangle may throw no shadow on its edges, and light may
    /// fall there where its edges are hidden.
    void ask_large_triangles() {
        std::vector<Inside> points;
        for (const std::uint32_t triangle : split_.changed_triangles()) {
            const std::uint32_t edge = split_.longest_edge(triangle);
            if (split_.length(edge) > large_ && may_split(edge))
                append_points(triangle,
                              std::min(MostParts, static_cast<std::uint32_t>(
                                                      std::ceil(split_.length(edge) / large_))),
                              points);
        }
        for (std::size_t first = 0; first < points.size(); first += PointsPerStep)
            ask_inside(
                std::span(points).subspan(first, std::min(PointsPerStep, points.size() - first)));
    }

    void ask_inside(std::span<const Inside> points) {
        Receivers receivers;
        for (const Inside& point : points)
            add_inside(point.triangle, point.weights, receivers);
        const std::vector<Bits> bits = trace(receivers);
        std::vector<float> errors(points.size());
        files::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            const auto& [a, b, c] = split_.mesh().triangles[points[i].triangle];
            const std::array<float, 3>& weights = points[i].weights;
            const std::array corners = {vertex(a, weights[0]), vertex(b, weights[1]),
                                        vertex(c, weights[2])};
            errors[i] = directions_.difference({receivers.normals[i], &bits[i]}, corners);
        });
        for (std::size_t i = 0; i < points.size(); ++i) {
            float& error = errors_[split_.longest_edge(points[i].triangle)];
            error = std::max(error, errors[i]);
        }
    }

    struct Candidate {
        double weight;
        std::uint32_t edge;
        bool operator<(const Candidate& other) const {
            return weight != other.weight ? weight > other.weight : edge < other.edge;
        }
    };

    [[nodiscard]] Candidate candidate(std::uint32_t edge) const {
        return {double{errors_[edge]} * double{errors_[edge]} * split_.area_beside(edge), edge};
    }

    /// Returns the edges beyond the error, at most so many, those that matter most first. The error
    /// of each was asked. An edge that has a bound only may stay behind for the next round.
    std::vector<Candidate> candidates(std::size_t most) {
        std::vector<Candidate> all;
        for (std::uint32_t edge = 0; edge < split_.num_edges(); ++edge)
            if (errors_[edge] > error_ && may_split(edge))
                all.push_back(candidate(edge));
        for (;;) {
            const std::size_t size = std::min(all.size(), most);
            if (size < all.size())
                std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(size),
                                 all.end());
            const auto end = all.begin() + static_cast<std::ptrdiff_t>(size);
            std::vector<std::uint32_t> unknown;
            for (auto first = all.begin(); first != end; ++first)
                if (!is_asked_[first->edge])
                    unknown.push_back(first->edge);
            ask(unknown);
            for (auto first = all.begin(); first != end; ++first)
                *first = candidate(first->edge);
            const auto last = std::remove_if(all.begin(), end, [this](const Candidate& each) {
                return !(errors_[each.edge] > error_);
            });
            if (size == all.size() || unknown.size() <= size / PartsWithBounds) {
                all.erase(last, all.end());
                std::sort(all.begin(), all.end());
                return all;
            }
            all.erase(last, end);
        }
    }

    /// Splits the edges beyond the error, or those of them that matter most.
    bool split_by_error() {
        const std::size_t num_added = num_vertices() - base_.num_vertices();
        if (options_.error_of_few && num_added < options_.few) {
            error_ = *options_.error_of_few;
            if (split_worst(std::min(room(), options_.few - num_added)))
                return true;
        }
        error_ = *options_.error;
        return split_worst(room());
    }

    bool split_worst(std::size_t most) {
        // Without a limit that is near, all of them.
        const std::size_t whole = options_.max_vertices - base_.num_vertices();
        const std::size_t of_round =
            std::max({most / RoundsToLimit, FewestOfRound, whole / PartsOfWhole});
        const std::vector<Candidate> found = candidates(2 * of_round);
        const std::size_t wanted = found.size() < of_round ? most : of_round;
        report_.is_at_limit = false;
        for (const Candidate& candidate : found) {
            if (split_.num_marked() >= wanted)
                break;
            if (!split_.mark(candidate.edge, most))
                report_.is_at_limit = true;
        }
        if (split_.num_marked() == 0) {
            report_.largest_error = largest_error();
            return false;
        }
        split_.split();
        return true;
    }

    [[nodiscard]] float largest_error() const {
        float result = 0.0f;
        for (std::uint32_t edge = 0; edge < split_.num_edges(); ++edge)
            if (is_asked_[edge] && errors_[edge] > error_ && may_split(edge))
                result = std::max(result, errors_[edge]);
        return result;
    }

    /// The mesh with the new vertices on the smooth surface.
    mesh::TriangleMesh bent() {
        mesh::TriangleMesh mesh = split_.mesh();
        const mesh::CurvedSurface surface(base_);
        std::vector<bool> is_done(mesh.num_vertices());
        std::fill_n(is_done.begin(), base_.num_vertices(), true);
        for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = mesh.triangles[i][k];
                if (is_done[vertex])
                    continue;
                is_done[vertex] = true;
                mesh.positions[vertex] =
                    surface.at(split_.origin(i).triangle, split_.origin(i).corners[k]);
            }
        return mesh;
    }

    const mesh::TriangleMesh& base_;
    const Blockers& blockers_;
    const RefineOptions& options_;
    RefineReport& report_;
    SplitMesh split_;
    Progress progress_;
    float step_;
    float bias_;
    CoarseDirections directions_;
    float large_, fine_;
    /// RefineOptions::error, or error_of_few while few vertices are added.
    float error_ = 0.0f;
    float min_edge_;
    /// [num_triangles of the beginning].
    std::vector<bool> is_refined_;
    /// [num_vertices]. Only vertices of triangles that are refined are traced.
    std::vector<Bits> vertex_bits_;
    std::vector<bool> is_traced_, is_movable_;
    std::vector<glm::vec3> lifts_;
    /// [num_edges]. Of edges that were not asked, a bound.
    std::vector<float> errors_;
    std::vector<bool> is_asked_, is_candidate_;
    /// Scratch of append_pairs().
    std::vector<SplitMesh::Ends> ends_;
};

void check(const mesh::TriangleMesh& mesh, const RefineOptions& options) {
    const auto require = [](bool condition, const std::string& message) {
        if (!condition)
            throw std::invalid_argument(message);
    };
    require(!options.error || (std::isfinite(*options.error) && *options.error >= 0.0f),
            fmt::format("expected an error >= 0, got {}", options.error.value_or(0.0f)));
    require(!options.max_edge || *options.max_edge > 0.0f,
            fmt::format("expected edges longer than 0, got {}", options.max_edge.value_or(0.0f)));
    require(!options.error_of_few || *options.error_of_few >= 0.0f,
            fmt::format("expected an error >= 0, got {}", options.error_of_few.value_or(0.0f)));
    const float min_edge = options.min_edge.value_or(0.0f);
    require(min_edge >= 0.0f, fmt::format("expected a shortest edge >= 0, got {}", min_edge));
    require(!options.max_edge || min_edge <= *options.max_edge,
            fmt::format("expected a shortest edge that is not above the longest of {}, got {}",
                        options.max_edge.value_or(0.0f), min_edge));
    require(options.max_vertices >= mesh.num_vertices(),
            fmt::format("expected a limit of at least the mesh's {} vertices, got {}",
                        mesh.num_vertices(), options.max_vertices));
    require(!options.light || options.light->resolution != 0,
            "expected a light with texels, got none");
    require(std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                        [&](const mesh::Triangle& triangle) {
                            const glm::dvec3 origin(mesh.positions[triangle[0]]);
                            return glm::cross(glm::dvec3(mesh.positions[triangle[1]]) - origin,
                                              glm::dvec3(mesh.positions[triangle[2]]) - origin) !=
                                   glm::dvec3(0.0);
                        }),
            "expected a triangle with an area to refine, got none");
}

} // namespace

mesh::TriangleMesh refine(const mesh::TriangleMesh& mesh, const Blockers& blockers,
                          const RefineOptions& options, const Work& work, RefineReport* report) {
    check(mesh, options);
    const auto start = std::chrono::steady_clock::now();
    RefineReport local;
    mesh::TriangleMesh result = Refinement(mesh, blockers, options, work, local).run();
    local.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (report != nullptr)
        *report = local;
    return result;
}

bool has_coarse_triangles(const mesh::TriangleMesh& mesh, float edge) {
    return std::any_of(
        mesh.triangles.begin(), mesh.triangles.end(),
        [&](const mesh::Triangle& triangle) { return longest_side(mesh, triangle) > edge; });
}

} // namespace relumine::prt
