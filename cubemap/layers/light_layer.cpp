#include "cubemap/layers/light_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/region_shape.h"

namespace relumine::cubemap {

namespace {

constexpr double DegreesPerRadian = 180.0 / std::numbers::pi;
/// In degrees from the mean.
constexpr double LargestLassoAngle = 89.9;
constexpr double LargestGainEv = 100.0;

/// Returns the angle between unit vectors in degrees. It is accurate near 0 and 180 too.
double angle_degrees(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * DegreesPerRadian;
}

[[noreturn]] void refuse(std::string_view what, std::string_view expected, const std::string& got) {
    throw std::invalid_argument(fmt::format("expected {} {}, got {}", what, expected, got));
}

std::string text(const glm::dvec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}

void check_direction(std::string_view what, const glm::dvec3& direction) {
    // The square must also be finite and above 0, or normalising would fail.
    const double squared = glm::dot(direction, direction);
    if (!(squared > 0.0) || !std::isfinite(squared) || !std::isnormal(squared))
        refuse(what, "of finite length above 0", text(direction));
}

/// The size of a star. Texels are quartered until the shape is not small any more. For a shape
/// without size this would never end.
constexpr double SmallestSize = 1e-4;

void check_size(std::string_view what, double degrees, double up_to) {
    if (!(degrees >= SmallestSize && degrees <= up_to))
        refuse(what, fmt::format("from {} to {}", SmallestSize, up_to), fmt::format("{}", degrees));
}

void check_side(std::string_view what, double degrees) {
    if (!(degrees >= SmallestSize && degrees < 180.0))
        refuse(what, fmt::format("from {} to below 180", SmallestSize), fmt::format("{}", degrees));
}

void check_range(std::string_view what, double value, double from, double to) {
    if (!(value >= from && value <= to))
        refuse(what, fmt::format("from {} to {}", from, to), fmt::format("{}", value));
}

void check_points(const std::vector<glm::dvec3>& points, std::size_t at_least) {
    if (points.size() < at_least)
        refuse("points", fmt::format("of at least {} directions", at_least),
               fmt::format("{}", points.size()));
    for (const glm::dvec3& point : points)
        check_direction("points", point);
}

void check(const Disc& disc) {
    check_direction("direction", disc.direction);
    check_size("radius_degrees", disc.radius_degrees, 180.0);
    check_range("softness", disc.softness, 0.0, 1.0);
}

void check(const Rectangle& rectangle) {
    check_direction("direction", rectangle.direction);
    check_side("width_degrees", rectangle.width_degrees);
    check_side("height_degrees", rectangle.height_degrees);
    if (!std::isfinite(rectangle.roll_degrees))
        refuse("roll_degrees", "to be finite", fmt::format("{}", rectangle.roll_degrees));
    check_range("softness", rectangle.softness, 0.0, 1.0);
}

void check(const Lasso& lasso) {
    check_points(lasso.points, 3);
    check_range("softness_degrees", lasso.softness_degrees, 0.0, 90.0);
    glm::dvec3 mean(0.0);
    for (const glm::dvec3& point : lasso.points)
        mean += glm::normalize(point);
    if (!(glm::length(mean) > 1e-9))
        refuse("points", fmt::format("within {} degrees of their mean", LargestLassoAngle),
               "points all around");
    for (const glm::dvec3& point : lasso.points) {
        const double angle = angle_degrees(glm::normalize(point), glm::normalize(mean));
        if (!(angle <= LargestLassoAngle))
            refuse("points", fmt::format("within {} degrees of their mean", LargestLassoAngle),
                   fmt::format("one at {:.2f} degrees", angle));
    }
}

void check(const Stroke& stroke) {
    check_points(stroke.points, 1);
    check_size("radius_degrees", stroke.radius_degrees, 90.0);
    check_range("softness", stroke.softness, 0.0, 1.0);
    for (std::size_t i = 0; i + 1 < stroke.points.size(); ++i) {
        const double angle =
            angle_degrees(glm::normalize(stroke.points[i]), glm::normalize(stroke.points[i + 1]));
        if (angle > 179.999)
            refuse("points", "whose neighbours are not opposite each other",
                   fmt::format("points {} and {} that are", i, i + 1));
    }
}

void check_colour(std::string_view what, const glm::vec3& colour, double scale) {
    for (const float value : {colour.x, colour.y, colour.z}) {
        if (!(value >= 0.0f) || !std::isfinite(static_cast<float>(value * scale)))
            refuse(what, "to be finite and at least 0 (gain_ev included)",
                   text(glm::dvec3(colour)));
    }
}

struct CheckEffect {
    /// 2^gain_ev
    double scale;
    const Region& region;
    void operator()(const Emit& emit) const { check_colour("radiance", emit.radiance, scale); }
    void operator()(const Gain& gain) const {
        if (!(gain.factor >= 0.0f) || !std::isfinite(gain.factor))
            refuse("factor", "to be finite and at least 0", fmt::format("{}", gain.factor));
        check_colour("tint", gain.tint, scale * gain.factor);
    }
    void operator()(const ImagePatch& patch) const {
        if (!std::holds_alternative<Rectangle>(region))
            refuse("an image", "on a rectangle", "another region");
        if (!patch.picture)
            refuse("an image", "with its picture loaded", "none");
        // The last level is the mean, so edits need not visit all pixels.
        check_colour("the picture's mean radiance", patch.picture->levels().back().pixels.front(),
                     scale);
    }
};

struct BoundingCone {
    Cone operator()(const Disc& disc) const {
        return {glm::normalize(disc.direction), disc.radius_degrees};
    }
    Cone operator()(const Rectangle& rectangle) const {
        const double x = std::tan(0.5 * rectangle.width_degrees / DegreesPerRadian);
        const double y = std::tan(0.5 * rectangle.height_degrees / DegreesPerRadian);
        return {glm::normalize(rectangle.direction),
                std::atan(std::hypot(x, y)) * DegreesPerRadian};
    }
    Cone operator()(const Lasso& lasso) const {
        // A cap smaller than a hemisphere that holds the corners holds the edges too.
        return around(lasso.points, 0.0);
    }
    Cone operator()(const Stroke& stroke) const {
        double longest = 0.0;
        for (std::size_t i = 0; i + 1 < stroke.points.size(); ++i)
            longest = std::max(longest, angle_degrees(glm::normalize(stroke.points[i]),
                                                      glm::normalize(stroke.points[i + 1])));
        // A point of an arc is at most half the arc's length from its nearer end.
        const Cone cap = around(stroke.points, 0.0);
        return {cap.axis,
                std::min(180.0, (cap.radius_degrees < 90.0 ? cap.radius_degrees
                                                           : cap.radius_degrees + 0.5 * longest) +
                                    stroke.radius_degrees)};
    }

private:
    static Cone around(const std::vector<glm::dvec3>& points, double margin_degrees) {
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& point : points)
            sum += glm::normalize(point);
        if (!(glm::length(sum) > 1e-9))
            return {};
        Cone cone{glm::normalize(sum), 0.0};
        for (const glm::dvec3& point : points)
            cone.radius_degrees =
                std::max(cone.radius_degrees, angle_degrees(cone.axis, glm::normalize(point)));
        cone.radius_degrees = std::min(180.0, cone.radius_degrees + margin_degrees);
        return cone;
    }
};

} // namespace

bool ImagePatch::operator==(const ImagePatch& other) const {
    const bool same_picture =
        picture == other.picture || (picture && other.picture && *picture == *other.picture);
    return same_picture && path == other.path && blend == other.blend;
}

void validate(const Region& region) {
    std::visit([](const auto& kind) { check(kind); }, region);
}

void validate(const LightLayer& layer) {
    try {
        check_range("gain_ev", layer.gain_ev, -LargestGainEv, LargestGainEv);
        validate(layer.region);
        std::visit(CheckEffect{std::exp2(layer.gain_ev), layer.region}, layer.effect);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(
            fmt::format("light layer \"{}\": {}", layer.name, error.what()));
    }
}

double coverage(const Region& region, const glm::dvec3& direction) {
    check_direction("direction", direction);
    const glm::dvec3 w = glm::normalize(direction);
    return std::visit(
        [&](const auto& prepared) {
            double product = 1.0;
            for (const double ramp : prepared.ramps(w))
                product *= smoothstep(ramp);
            return product;
        },
        shape(region));
}

Cone bounding_cone(const Region& region) {
    validate(region);
    return std::visit(BoundingCone{}, region);
}

} // namespace relumine::cubemap
