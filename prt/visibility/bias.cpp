#include "prt/visibility/bias.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/subject.h"

namespace relumine::prt {

float automatic_bias(const mesh::TriangleMesh& blockers) {
    const mesh::Bounds bounds = mesh::extent(blockers).box;
    float largest = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
    // A sum is rounded by up to half a spacing on each axis. The other half of the four is for the
    // triangles' own rounding.
    return std::max(1e-4f * mesh::scale(blockers),
                    4.0f * std::numeric_limits<float>::epsilon() * largest);
}

} // namespace relumine::prt
