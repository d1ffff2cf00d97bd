#include "prt/refinement/refine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/seconds.h"
#include "mesh/half_edge/curved_surface.h"
#include "mesh/half_edge/split_mesh.h"
#include "prt/refinement/edge_errors.h"
#include "prt/refinement/hidden_vertices.h"
#include "prt/refinement/large_triangles.h"
#include "prt/refinement/lit_surface.h"

namespace relumine::prt {

namespace {

using mesh::SplitMesh;

/// With a limit of vertices, a round takes this part of what is left. Fewer rounds would split
/// edges that the next round finds to matter less; measured. The last rounds take at least a part
/// of the whole, since every round looks at all edges.
constexpr std::size_t RoundsToLimit = 6;
constexpr std::size_t FewestOfRound = 32, PartsOfWhole = 64;

class Refinement {
public:
    Refinement(const mesh::TriangleMesh& mesh, const Blockers& blockers,
               const RefineOptions& options, const Work& work, RefineReport& report)
        : base_(mesh), options_(options), report_(report), progress_(work),
          surface_(mesh, blockers, options, progress_), hidden_(surface_),
          errors_(surface_, hidden_, options), split_(surface_.split()) {}

    mesh::TriangleMesh run() {
        progress_.start_stage(0.0, 1.0);
        if (options_.max_edge)
            while (split_long_edges())
                ++report_.num_rounds;
        if (options_.error) {
            trace_vertices();
            for (;;) {
                errors_.add_new_edges();
                if (!split_by_error())
                    break;
                ++report_.num_rounds;
                trace_vertices();
                report_progress();
            }
        }
        report_.num_added = num_vertices() - base_.num_vertices();
        mesh::TriangleMesh result = options_.curved   ? bent()
                                    : !options_.error ? split_.take()
                                                      : hidden_.moved_out();
        report_.num_points = surface_.num_points();
        return result;
    }

private:
    void trace_vertices() {
        surface_.trace_vertices();
        hidden_.find_movable();
    }

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

    /// Splits the edges beyond the error, or those of them that matter most.
    bool split_by_error() {
        const std::size_t num_added = num_vertices() - base_.num_vertices();
        if (options_.error_of_few && num_added < options_.few) {
            if (split_worst(*options_.error_of_few, std::min(room(), options_.few - num_added)))
                return true;
        }
        return split_worst(*options_.error, room());
    }

    bool split_worst(float error, std::size_t most) {
        // Without a limit that is near, all of them.
        const std::size_t whole = options_.max_vertices - base_.num_vertices();
        const std::size_t of_round =
            std::max({most / RoundsToLimit, FewestOfRound, whole / PartsOfWhole});
        const std::vector<EdgeErrors::Candidate> found = errors_.beyond(error, 2 * of_round);
        const std::size_t wanted = found.size() < of_round ? most : of_round;
        report_.is_at_limit = false;
        for (const EdgeErrors::Candidate& candidate : found) {
            if (split_.num_marked() >= wanted)
                break;
            if (!split_.mark(candidate.edge, most))
                report_.is_at_limit = true;
        }
        if (split_.num_marked() == 0) {
            report_.largest_error = errors_.largest_beyond(error);
            return false;
        }
        split_.split();
        return true;
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
    const RefineOptions& options_;
    RefineReport& report_;
    Progress progress_;
    LitSurface surface_;
    HiddenVertices hidden_;
    EdgeErrors errors_;
    SplitMesh& split_;
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
    local.seconds = files::seconds_since(start);
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
