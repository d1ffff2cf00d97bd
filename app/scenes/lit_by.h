// Regions of the environment as options: --lit-by and --disc.
#pragma once

#include <span>
#include <string>

#include "relumine/light/layers.h"

namespace relumine::app {

/// "X,Y,Z,RADIUS": a disc around a direction, its angular radius in degrees.
struct DiscText {
    static constexpr const char* Type = "X,Y,Z,RADIUS";
    static cubemap::Disc read(const std::string& text);
    static std::string show(const cubemap::Disc& disc);
};

/// The region of the layer of that name, or "X,Y,Z,RADIUS": a disc with a hard edge. Throws
/// UsageError for anything else.
[[nodiscard]] cubemap::Region lit_by_region(const std::string& text,
                                            std::span<const cubemap::LightLayer> layers);

} // namespace relumine::app
