#include "viewer/region_edit.h"

#include <algorithm>
#include <vector>

namespace relumine::viewer {

Grip grip_at(const cubemap::Region& region, const glm::dvec3& direction, double tolerance_degrees) {
    const std::vector<glm::dvec3> rim = outline(region);
    // With hard edges, so that all of the region can be held.
    const bool inside = coverage(hardened(region), direction) > 0.0;
    if (cubemap::distance_to(rim, direction) > tolerance_degrees)
        return inside ? Grip::Body : Grip::None;
    double size = 0.0;
    for (const glm::dvec3& point : rim)
        size = std::max(size, angle_between(middle(region), point));
    const bool near_middle = angle_between(middle(region), direction) < 0.5 * size;
    return inside && near_middle ? Grip::Body : Grip::Rim;
}

} // namespace relumine::viewer
