// Soft boxes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/layer_shape.h"

namespace relumine::cubemap {

class RectangleShape;

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

    using Prepared = RectangleShape;
    static constexpr ShapeWords Words{
        .name = "rectangle",
        .label = "soft box",
        .hint = "a rectangle that gives light",
        .about = "A soft box: a rectangle on the plane that touches the unit sphere at "
                 "`direction`."};
    static Rectangle as_added() {
        return {.width_degrees = 40.0, .height_degrees = 25.0, .softness = 0.2};
    }
    [[nodiscard]] std::vector<LayerField> fields();
    void check() const {}
    [[nodiscard]] std::vector<glm::dvec3> outline() const;
    /// Changes the sides that were held.
    void resize(const glm::dvec3& from, const glm::dvec3& to);
    /// A rectangle stays upright. Straight above or below, where upright is a convention, it turns
    /// on the spot.
    void turn_upright(double degrees_about_y);
};

/// Unit axes and half sides of a rectangle, seen from the centre of the sphere.
struct RectangleFrame {
    explicit RectangleFrame(const Rectangle& rectangle);
    glm::dvec3 forward, right, up;
    glm::dvec2 half;
};

class RectangleShape {
public:
    static constexpr std::size_t NumRamps = 2;
    static constexpr bool HasConcaveRamps = true;
    explicit RectangleShape(const Rectangle& rectangle);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const;
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const;
    [[nodiscard]] bool has_kink(std::size_t i, const glm::dvec3& w, double chord) const;
    [[nodiscard]] double smallest_feature() const { return smallest_feature_; }
    [[nodiscard]] const RectangleShape& within(const glm::dvec3&, double) const { return *this; }

    /// Returns the position in a picture that fills the rectangle, in [0, 1]^2 from the top left.
    /// Positions outside are clamped.
    [[nodiscard]] glm::dvec2 picture_position(const glm::dvec3& w) const;
    /// Returns the ratio of solid angle to picture area for a small part of the rectangle around w.
    [[nodiscard]] double solid_angle_of_picture(const glm::dvec3& w) const;
    [[nodiscard]] const glm::dvec2& half_sides() const { return frame_.half; }

private:
    struct Side {
        double outer_norm, inner, inner_norm, inverse_band;
    };
    RectangleFrame frame_;
    std::array<Side, 2> sides_;
    /// A bound below the depth (cosine to the axis) anywhere in the rectangle.
    double min_depth_;
    double smallest_feature_;
};

} // namespace relumine::cubemap
