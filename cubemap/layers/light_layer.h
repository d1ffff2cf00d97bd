// Light layers: what an artist puts over an environment. Each is a region of directions with a soft
// edge and what happens there: light is added, what lies below is dimmed or tinted, or a picture is
// placed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/layers/image_pyramid.h"

namespace relumine::cubemap {

/// Directions within an angle of one. Coverage is 1 within radius (1 - softness) and falls smoothly
/// (a smoothstep of the angle's cosine) to 0 at the radius.
struct Disc {
    /// To the centre, any length but zero
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Above 0, up to 180
    double radius_degrees = 5.0;
    /// [0, 1]
    double softness = 0.0;
    bool operator==(const Disc&) const = default;
};

/// A soft box: a rectangle on the plane that touches the unit sphere at `direction`, with half
/// sides tan(width / 2) and tan(height / 2). It stands upright (+Y up on that plane; straight above
/// its top points to +Z, straight below to -Z, as the cube faces lie) and is then turned by `roll`,
/// counter-clockwise as seen from the centre of the sphere. Coverage falls smoothly to 0 at the
/// sides over `softness` times the half side, horizontally and vertically (the product of both in
/// the corners).
struct Rectangle {
    /// To the centre, any length but zero
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Above 0, below 180
    double width_degrees = 20.0;
    /// Above 0, below 180
    double height_degrees = 20.0;
    double roll_degrees = 0.0;
    /// [0, 1]
    double softness = 0.0;
    bool operator==(const Rectangle&) const = default;
};

/// A polygon on the sphere, its edges arcs of great circles, closed from the last point to the
/// first. Where it overlaps itself, what it encloses twice is outside. Coverage rises smoothly from
/// 0 at the outline to 1 at `softness_degrees` inside it.
struct Lasso {
    /// At least 3 of any length but zero, all within 89.9 degrees of their mean.
    std::vector<glm::dvec3> points = {};
    /// [0, 90]
    double softness_degrees = 0.0;
    bool operator==(const Lasso&) const = default;
};

/// A brush stroke: all directions within `radius` of a line of great-circle arcs from point to
/// point; one point is a dab. Coverage as a disc's.
struct Stroke {
    /// At least 1 of any length but zero; no two neighbours opposite each other
    std::vector<glm::dvec3> points = {};
    /// Above 0, up to 90
    double radius_degrees = 2.0;
    /// [0, 1]
    double softness = 0.5;
    bool operator==(const Stroke&) const = default;
};

using Region = std::variant<Disc, Rectangle, Lasso, Stroke>;

/// Adds radiance, times the coverage.
struct Emit {
    /// Linear RGB, finite and not negative
    glm::vec3 radiance{1.0f};
    bool operator==(const Emit&) const = default;
};

/// Multiplies what lies below by factor x tint (by 1 where the coverage is 0, in between in
/// between).
struct Gain {
    /// Finite and not negative
    float factor = 1.0f;
    glm::vec3 tint{1.0f};
    bool operator==(const Gain&) const = default;
};

/// A picture placed on a Rectangle (no other region), seen upright from the centre of the sphere.
struct ImagePatch {
    enum class Blend : std::uint8_t { Replace, Add };
    /// As a layer file names it; only `picture` is drawn
    std::filesystem::path path;
    std::shared_ptr<const ImagePyramid> picture = nullptr;
    Blend blend = Blend::Replace;
    /// Pictures are compared by their pixels.
    bool operator==(const ImagePatch& other) const;
};

using Effect = std::variant<Emit, Gain, ImagePatch>;

struct LightLayer {
    std::string name;
    bool on = true;
    /// Stops: times 2^gain_ev for the radiance of Emit and ImagePatch and the factor of Gain;
    /// [-100, 100]
    double gain_ev = 0.0;
    Region region = Disc{};
    Effect effect = Emit{};
    bool operator==(const LightLayer&) const = default;
};

/// Throws std::invalid_argument with one line, `light layer "NAME": expected X, got Y`, for
/// anything the comments above exclude.
void validate(const LightLayer& layer);

/// The same for a region alone: `expected X, got Y`.
void validate(const Region& region);

/// How much of a direction (any length but zero) belongs to the region, [0, 1]. Prepares the region
/// on every call: for many directions use composite(). Throws like validate().
[[nodiscard]] double coverage(const Region& region, const glm::dvec3& direction);

struct Cone {
    /// unit
    glm::dvec3 axis{0.0, 0.0, 1.0};
    /// 180: the whole sphere
    double radius_degrees = 180.0;
};

/// A cone that holds every direction with coverage above 0; not always the smallest. Throws like
/// validate().
[[nodiscard]] Cone bounding_cone(const Region& region);

} // namespace relumine::cubemap
