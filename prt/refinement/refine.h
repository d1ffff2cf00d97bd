// Meshes refined where their light needs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "cubemap/cube_map.h"
#include "mesh/triangle_mesh.h"
#include "prt/receivers/receivers.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

struct RefineOptions {
    /// An edge is split while the transfer at its middle differs by more from the mean of its ends:
    /// the root of the squares' mean over all directions, and 20 times the mean's square, since
    /// light from everywhere counts as small lights do; 1/sr, albedo 1. 0.046 is the edge of a
    /// floor at the foot of a wall. Empty: light is not asked.
    std::optional<float> error = 0.01f;
    /// The error in place of it while fewer vertices than `few` are added. Empty: the same.
    std::optional<float> error_of_few = {};
    std::size_t few = 0;
    /// Longer edges are split in any case. Empty: none.
    std::optional<float> max_edge = {};
    /// Triangles of the mesh without a side longer than this are left as they are, but for sides
    /// that they share with others, and cost nothing. Empty: all triangles are refined.
    std::optional<float> coarse_edge = {};
    /// Edges shorter than twice this are not split, in the mesh's unit. Empty: 1/1000 of the mesh's
    /// diagonal.
    std::optional<float> min_edge = {};
    /// The mesh grows to so many vertices at most. Then the edges are split first that matter most:
    /// error squared times the area beside them.
    std::size_t max_vertices = std::numeric_limits<std::uint32_t>::max() - 1;
    /// New vertices lie on mesh::CurvedSurface, not in the middle of the old edge. Light is asked
    /// for at the flat places, where no triangle is before them.
    bool curved = false;
    /// The environment that matters most: the error of the light that comes from it counts, too,
    /// as if its power were 1. So edges are split at the shadows of its sun. Empty: none does.
    std::optional<cubemap::CubeMap> light = {};
    /// Returns what the scene's own lamps give to points, [points], in any unit. Its error counts
    /// like the environment's, relative to what the lamps give there and to vertices on the mean.
    /// Empty: there are no lamps.
    std::function<std::vector<float>(const Receivers& points)> lamps = {};
    /// Lift of the rays' origins along the normal, as in PrecomputeOptions. Empty:
    /// automatic_bias().
    std::optional<float> bias = {};
};

struct RefineReport {
    std::size_t num_rounds = 0;
    /// Points whose transfer was asked for: vertices, and middles of edges.
    std::size_t num_points = 0;
    std::size_t num_added = 0;
    /// The largest error found of an edge that may be split and is not. Above RefineOptions::error
    /// only at the limit of vertices.
    float largest_error = 0.0f;
    bool is_at_limit = false;
    double seconds = 0.0;
};

/// Splits the edges of a mesh where light changes between their ends, whatever the environment will
/// be, and where that of its lamps does: mesh::SplitMesh says how. Transfer is found in 1,536
/// directions, horizons included, first at the vertices, then at new ones, round by round. Middles
/// of edges are asked where the ends differ enough, or the edge is long in the scene. Triangles
/// that are large in the scene are asked at points inside, too, so close to each other that nothing
/// of some size is missed. Along edges that are short in the scene, middles and new vertices are
/// traced only in directions on which the ends do not agree.
///
/// Where light is asked, a new vertex that is hidden in another solid moves along an edge to where
/// light begins, if the surface around it is flat and goes on to all sides: its darkness would
/// spread over the triangles beside it. So edges of four times min_edge with such an end are not
/// split, and a few edges become shorter than min_edge. With `curved` nothing moves.
///
/// Vertices of the mesh keep index and position; its triangles come first, too, each cut down.
///
/// Cost:    O(n log n).
/// Memory:  260 bytes for each vertex, 100 for each edge.
/// Threads: parallel inside; the result is the same bit by bit for any number of threads.
/// Throws:  std::invalid_argument for options out of range or against each other, for a mesh
///          without a triangle of positive area, and for a light without texels; Cancelled.
[[nodiscard]] mesh::TriangleMesh refine(const mesh::TriangleMesh& mesh, const Blockers& blockers,
                                        const RefineOptions& options = {}, const Work& work = {},
                                        RefineReport* report = nullptr);

/// Whether RefineOptions::coarse_edge leaves a triangle to be refined.
[[nodiscard]] bool has_coarse_triangles(const mesh::TriangleMesh& mesh, float edge);

} // namespace relumine::prt
