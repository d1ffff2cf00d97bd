#include "cubemap/layers/region_turn.h"

#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

namespace relumine::cubemap {

namespace {

struct Turn {
    double degrees;
    void operator()(Disc& disc) const { disc.direction = turned(disc.direction, degrees); }
    void operator()(Rectangle& box) const {
        if (box.direction.x == 0.0 && box.direction.z == 0.0)
            box.roll_degrees += box.direction.y > 0.0 ? -degrees : degrees;
        box.direction = turned(box.direction, degrees);
    }
    void operator()(Lasso& lasso) const { turn(lasso.points); }
    void operator()(Stroke& stroke) const { turn(stroke.points); }
    void turn(std::vector<glm::dvec3>& points) const {
        for (glm::dvec3& point : points)
            point = turned(point, degrees);
    }
};

} // namespace

glm::dvec3 turned(const glm::dvec3& direction, double degrees_about_y) {
    const double angle = degrees_about_y * std::numbers::pi / 180.0;
    return {std::cos(angle) * direction.x + std::sin(angle) * direction.z, direction.y,
            std::cos(angle) * direction.z - std::sin(angle) * direction.x};
}

Region turned(const Region& region, double degrees_about_y) {
    Region result = region;
    std::visit(Turn{degrees_about_y}, result);
    return result;
}

} // namespace relumine::cubemap
