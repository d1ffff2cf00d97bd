// The option --lit-by: a part of the environment, and what of the scene it lights.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/layers/light_layer.h"
#include "relight/relighter.h"

namespace relumine::app {

/// The region of the layer of that name, or "X,Y,Z,RADIUS": a disc with a hard edge. Throws
/// UsageError for anything else.
[[nodiscard]] cubemap::Region lit_by_region(const std::string& text,
                                            std::span<const cubemap::LightLayer> layers);

/// What a region of the environment, all layers included, gives to the scene.
struct LitBy {
    /// [num_receivers], albedo 1
    std::vector<glm::vec3> radiance = {};
    /// The rest is black
    cubemap::CubeMap environment = {};
    /// Of the sum of all receivers' radiance (RGB together)
    double share = 0.0;
};
[[nodiscard]] LitBy lit_by(const relight::Relighter& relighter, const cubemap::Region& region);

} // namespace relumine::app
