#include "relumine/out/first_sight.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "mesh/subject.h"
#include "relumine/in/precompute.h"

namespace relumine {

namespace {

/// Corners of large faces may lie inside of other solids: without more vertices they were black.
Mesh with_some_vertices(Mesh given) {
    constexpr float CoarseEdge = 1.0f / 20.0f, LeastEdge = 1.0f / 100.0f;
    constexpr std::size_t Budget = 6000;
    Mesh mesh = sound(std::move(given));
    const float size = mesh::subject_bounds(mesh.geometry).diagonal();
    if (!(size > 0.0f) || !prt::has_coarse_triangles(mesh.geometry, CoarseEdge * size))
        return mesh;
    const std::size_t most = mesh.geometry.num_vertices() + Budget;
    return refined(std::move(mesh), {.error = 0.03f,
                                     .coarse_edge = CoarseEdge * size,
                                     .min_edge = LeastEdge * size,
                                     .max_vertices = most});
}

} // namespace

Scene quick_scene(Mesh mesh) {
    PrecomputeOptions options;
    options.face_resolution = 8;
    options.tolerance = 1.0f; // no cell is split
    options.no_refine = true;
    options.bounce_tolerance = 0.0f;
    return precompute(with_some_vertices(std::move(mesh)), options);
}

OutputOptions quick_picture(OutputOptions options) {
    constexpr std::uint32_t LongestSide = 400, FewRays = 2;
    const std::uint32_t longest = std::max(options.width, options.height);
    if (longest > LongestSide)
        for (std::uint32_t* const side : {&options.width, &options.height})
            *side = std::max(1u, *side * LongestSide / longest);
    options.samples_per_axis = 1;
    options.highlight_rays = std::min(options.highlight_rays, FewRays);
    return options;
}

} // namespace relumine
