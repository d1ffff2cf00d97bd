// Light layers: what an artist puts over an environment.
//
// A layer is a region of directions with a soft edge, and an effect in this region: it adds light,
// it dims or tints the light below, or it places a picture.
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

/// All directions within an angle of a centre. Coverage is 1 within radius (1 - softness). From
/// there it falls smoothly to 0 at the radius (a smoothstep of the angle's cosine).
struct Disc {
    /// Direction to the centre, of any length but zero.
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Above 0, up to 180.
    double radius_degrees = 5.0;
    /// In [0, 1]. 0: a hard edge.
    double softness = 0.0;
    bool operator==(const Disc&) const = default;
};

/// A soft box: a rectangle on the plane that touches the unit sphere at `direction`. Its half sides
/// are tan(width / 2) and tan(height / 2).
///
/// The rectangle stands upright on its plane: its top points to +Y, straight above to +Z, straight
/// below to -Z, as the cube faces lie. It is then turned by `roll`, counter-clockwise as seen from
/// the centre of the sphere.
///
/// Coverage falls smoothly to 0 at the sides, over `softness` times the half side. In the corners
/// it is the product of both directions.
struct Rectangle {
    /// Direction to the centre, of any length but zero.
    glm::dvec3 direction{0.0, 0.0, 1.0};
    /// Above 0, below 180.
    double width_degrees = 20.0;
    /// Above 0, below 180.
    double height_degrees = 20.0;
    double roll_degrees = 0.0;
    /// In [0, 1]. 0: a hard edge.
    double softness = 0.0;
    bool operator==(const Rectangle&) const = default;
};

/// A polygon on the sphere. Its edges are arcs of great circles; the last point joins the first. An
/// area that the polygon encloses twice is outside. Coverage rises smoothly from 0 at the outline
/// to 1 at `softness_degrees` inside it.
struct Lasso {
    /// At least 3 directions of any length but zero, all within 89.9 degrees of their mean.
    std::vector<glm::dvec3> points = {};
    /// In [0, 90]. 0: a hard edge.
    double softness_degrees = 0.0;
    bool operator==(const Lasso&) const = default;
};

/// A brush stroke: all directions within `radius` of a line of great-circle arcs from point to
/// point. One point is a dab. Coverage depends on the distance to the line as in a Disc.
struct Stroke {
    /// At least 1 direction of any length but zero. No two neighbours are opposite each other.
    std::vector<glm::dvec3> points = {};
    /// Above 0, up to 90.
    double radius_degrees = 2.0;
    /// In [0, 1]. 0: a hard edge.
    double softness = 0.5;
    bool operator==(const Stroke&) const = default;
};

/// The region of a layer.
using Region = std::variant<Disc, Rectangle, Lasso, Stroke>;

/// Adds radiance times the coverage.
struct Emit {
    /// Linear RGB, finite and not negative.
    glm::vec3 radiance{1.0f};
    bool operator==(const Emit&) const = default;
};

/// Multiplies the light below. The multiplier goes linearly from factor x tint at full coverage to
/// 1 at none.
struct Gain {
    /// Finite and not negative, as is the tint.
    float factor = 1.0f;
    glm::vec3 tint{1.0f};
    bool operator==(const Gain&) const = default;
};

/// Places a picture on a Rectangle; other regions are refused. The picture is upright as seen from
/// the centre of the sphere.
struct ImagePatch {
    enum class Blend : std::uint8_t { Replace, Add };
    /// The picture's path as a layer file names it. Only `picture` is drawn.
    std::filesystem::path path;
    std::shared_ptr<const ImagePyramid> picture = nullptr;
    Blend blend = Blend::Replace;
    /// Compares pictures by their pixels.
    bool operator==(const ImagePatch& other) const;
};

/// What a layer does in its region.
using Effect = std::variant<Emit, Gain, ImagePatch>;

/// One layer: a region, an effect, and the strength of the effect.
struct LightLayer {
    std::string name;
    bool on = true;
    /// Stops, in [-100, 100]. 2^gain_ev multiplies the radiance of Emit and ImagePatch, and the
    /// factor of Gain.
    double gain_ev = 0.0;
    Region region = Disc{};
    Effect effect = Emit{};
    bool operator==(const LightLayer&) const = default;
};

/// Checks a layer.
/// Throws:  std::invalid_argument `light layer "NAME": expected X, got Y` for anything the comments
///          above exclude.
void validate(const LightLayer& layer);

/// Checks a region alone. The message is `expected X, got Y`.
void validate(const Region& region);

/// Returns how much of a direction belongs to the region, in [0, 1]. The direction may have any
/// length but zero. Every call prepares the region again; use composite() for many directions.
/// Throws:  as validate().
[[nodiscard]] double coverage(const Region& region, const glm::dvec3& direction);

/// All directions within an angle of an axis.
struct Cone {
    /// Unit axis.
    glm::dvec3 axis{0.0, 0.0, 1.0};
    /// 180: the whole sphere.
    double radius_degrees = 180.0;
};

/// Returns a cone that holds every direction with coverage above 0. A smaller cone may exist.
/// Throws:  as validate().
[[nodiscard]] Cone bounding_cone(const Region& region);

} // namespace relumine::cubemap
