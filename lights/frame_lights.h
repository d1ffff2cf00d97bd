// Lights of a sequence of environments, frame by frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lights/light_list.h"

namespace relumine::lights {

/// Distant lights for every frame of a sequence. A light that lives over several frames appears in
/// each of them.
struct FrameLights {
    /// [num_frames], the lights of each frame.
    std::vector<std::vector<DistantLight>> frames;

    [[nodiscard]] std::size_t num_frames() const { return frames.size(); }
    /// Returns the lights of a frame, 0 <= frame < num_frames().
    [[nodiscard]] std::span<const DistantLight> at(std::size_t frame) const {
        return frames[frame];
    }
};

} // namespace relumine::lights
