#include "prt/refinement/edge_errors.h"

#include <algorithm>
#include <array>

#include "files/parallel.h"
#include "mesh/subject.h"
#include "prt/refinement/large_triangles.h"

namespace relumine::prt {

namespace {

using mesh::SplitMesh;
using Bits = CoarseDirections::Bits;
using Neighbours = CoarseDirections::Neighbours;

/// Middles that are traced together: 50 MB.
constexpr std::size_t PointsPerStep = std::size_t{1} << 18;

/// The shortest edge, in parts of the mesh's diagonal.
constexpr float ShortestEdge = 1e-3f;

/// Bounds of edges give way to errors until so small a part of the first edges has bounds only.
constexpr std::size_t PartsWithBounds = 16;

} // namespace

EdgeErrors::EdgeErrors(LitSurface& surface, const HiddenVertices& hidden,
                       const RefineOptions& options)
    : surface_(surface), hidden_(hidden), large_(large_side(surface.mesh())),
      min_edge_(options.min_edge.value_or(ShortestEdge * mesh::scale(surface.mesh()))),
      is_curved_(options.curved), subject_(mesh::subject_bounds(surface.mesh())) {}

void EdgeErrors::add_new_edges() {
    bound_new_edges();
    ask_large_triangles();
}

/// Whether one end of a short edge will move towards the other. There is no need to split it.
bool EdgeErrors::is_left_to_move(std::uint32_t edge) {
    if (surface_.split().length(edge) >= 4.0f * min_edge_ || is_curved_)
        return false;
    ends_.clear();
    surface_.split().append_ends(edge, ends_);
    return ends_.size() == 1 && (hidden_.moves_to(ends_[0].low, ends_[0].high) ||
                                 hidden_.moves_to(ends_[0].high, ends_[0].low));
}

/// Bounds the errors of the edges that are new: where light changes once along an edge, its
/// middle is half of the change away from the mean. Edges on which light may change there and back
/// are asked at once: long ones, and those that other solids hide at both ends.
void EdgeErrors::bound_new_edges() {
    const auto first = static_cast<std::uint32_t>(errors_.size());
    errors_.resize(surface_.split().num_edges(), 0.0f);
    is_asked_.resize(surface_.split().num_edges(), true);
    is_candidate_.resize(surface_.split().num_edges());
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> asked;
    for (std::uint32_t edge = first; edge < surface_.split().num_edges(); ++edge) {
        // An edge that a triangle which stays has on its other side is a candidate, too.
        ends_.clear();
        surface_.split().append_ends(edge, ends_);
        is_candidate_[edge] =
            !is_left_to_move(edge) && !surface_.split().is_split(edge) &&
            surface_.split().length(edge) >= 2.0f * min_edge_ &&
            surface_.split().length(edge) > 0.0f &&
            std::all_of(ends_.begin(), ends_.end(), [this](const SplitMesh::Ends& ends) {
                return surface_.is_traced(ends.low) && surface_.is_traced(ends.high);
            });
        if (!may_split(edge))
            continue;
        if (surface_.split().length(edge) > large_ || hidden_.hides_ends(ends_)) {
            asked.push_back(edge);
            continue;
        }
        is_asked_[edge] = false;
        append_pairs(edge, pairs);
    }
    std::vector<float> bounds(pairs.size());
    files::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
        const CoarseDirections::Point high = surface_.vertex(pairs[i].ends.high);
        bounds[i] = surface_.directions().difference(surface_.vertex(pairs[i].ends.low), {&high, 1},
                                                     CoarseDirections::Signs::Dropped) /
                    2.0f;
    });
    set_errors(pairs, bounds);
    ask(asked);
}

void EdgeErrors::append_pairs(std::uint32_t edge, std::vector<Pair>& pairs) {
    ends_.clear();
    surface_.split().append_ends(edge, ends_);
    for (const SplitMesh::Ends& ends : ends_)
        pairs.push_back({edge, ends});
}

void EdgeErrors::set_errors(std::span<const Pair> pairs, std::span<const float> errors) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
        errors_[pairs[i].edge] = std::max(errors_[pairs[i].edge], errors[i]);
}

/// Finds the errors of edges at their middles.
void EdgeErrors::ask(std::span<const std::uint32_t> edges) {
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
            surface_.add_middle(pair.ends, receivers);
            ends.push_back(surface_.neighbours(pair.ends.low, pair.ends.high));
        }
        const std::vector<Bits> bits = surface_.trace(receivers, ends);
        const std::vector<float> lamps = surface_.lamps_at(receivers);
        std::vector<float> errors(pairs.size());
        files::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
            const std::array both = {surface_.vertex(pairs[i].ends.low, 0.5f),
                                     surface_.vertex(pairs[i].ends.high, 0.5f)};
            errors[i] = surface_.directions().difference(
                {receivers.normals[i], &bits[i], 1.0f, lamps[i]}, both);
        });
        set_errors(pairs, errors);
    }
}

/// What lies in the middle of a large triangle may throw no shadow on its edges, and light may
/// fall there where its edges are hidden.
void EdgeErrors::ask_large_triangles() {
    std::vector<Inside> points;
    for (const std::uint32_t triangle : surface_.split().changed_triangles()) {
        const std::uint32_t edge = surface_.split().longest_edge(triangle);
        const float parts = surface_.split().length(edge) / large_;
        if (!(parts > 1.0f) || !may_split(edge))
            continue;
        const auto add = [&](const std::vector<glm::vec2>& inside) {
            for (const glm::vec2& at : inside)
                points.push_back({triangle, {1.0f - at.x - at.y, at.x, at.y}});
        };
        add(points_inside(parts));
        if (parts > MostParts)
            add(points_near(surface_.mesh(), surface_.mesh().triangles[triangle], subject_));
    }
    for (std::size_t first = 0; first < points.size(); first += PointsPerStep)
        ask_inside(
            std::span(points).subspan(first, std::min(PointsPerStep, points.size() - first)));
}

void EdgeErrors::ask_inside(std::span<const Inside> points) {
    Receivers receivers;
    for (const Inside& point : points)
        surface_.add_inside(point.triangle, point.weights, receivers);
    const std::vector<Bits> bits = surface_.trace(receivers);
    const std::vector<float> lamps = surface_.lamps_at(receivers);
    std::vector<float> errors(points.size());
    files::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        const auto& [a, b, c] = surface_.mesh().triangles[points[i].triangle];
        const std::array<float, 3>& weights = points[i].weights;
        const std::array corners = {surface_.vertex(a, weights[0]), surface_.vertex(b, weights[1]),
                                    surface_.vertex(c, weights[2])};
        errors[i] = surface_.directions().difference(
            {receivers.normals[i], &bits[i], 1.0f, lamps[i]}, corners);
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
        float& error = errors_[surface_.split().longest_edge(points[i].triangle)];
        error = std::max(error, errors[i]);
    }
}

EdgeErrors::Candidate EdgeErrors::candidate(std::uint32_t edge) const {
    return {double{errors_[edge]} * double{errors_[edge]} * surface_.split().area_beside(edge),
            edge};
}

std::vector<EdgeErrors::Candidate> EdgeErrors::beyond(float error, std::size_t most) {
    std::vector<Candidate> all;
    for (std::uint32_t edge = 0; edge < surface_.split().num_edges(); ++edge)
        if (errors_[edge] > error && may_split(edge))
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
        const auto last = std::remove_if(
            all.begin(), end, [&](const Candidate& each) { return !(errors_[each.edge] > error); });
        if (size == all.size() || unknown.size() <= size / PartsWithBounds) {
            all.erase(last, all.end());
            std::sort(all.begin(), all.end());
            return all;
        }
        all.erase(last, end);
    }
}

float EdgeErrors::largest_beyond(float error) const {
    float result = 0.0f;
    for (std::uint32_t edge = 0; edge < surface_.split().num_edges(); ++edge)
        if (is_asked_[edge] && errors_[edge] > error && may_split(edge))
            result = std::max(result, errors_[edge]);
    return result;
}

} // namespace relumine::prt
