#include "relumine/out/first_sight.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "relumine/in/precompute.h"

namespace relumine {

Scene quick_scene(Mesh mesh) {
    PrecomputeOptions options;
    options.face_resolution = 8;
    options.tolerance = 1.0f; // no cell is split
    options.no_refine = true;
    options.bounce_tolerance = 0.0f;
    return precompute(std::move(mesh), options);
}

OutputOptions quick_picture(OutputOptions options) {
    constexpr std::uint32_t LongestSide = 400, FewRays = 4;
    const std::uint32_t longest = std::max(options.width, options.height);
    if (longest > LongestSide)
        for (std::uint32_t* const side : {&options.width, &options.height})
            *side = std::max(1u, *side * LongestSide / longest);
    options.samples_per_axis = 1;
    options.highlight_rays = std::min(options.highlight_rays, FewRays);
    return options;
}

} // namespace relumine
