// How files write colours of vertices and faces.
#pragma once

namespace relumine::mesh {

/// What the numbers of a colour mean.
enum class ColorCurve {
    /// A screen's values, IEC 61966-2-1
    Srgb,
    /// Light
    Linear,
};

} // namespace relumine::mesh
