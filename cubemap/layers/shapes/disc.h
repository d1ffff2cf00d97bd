// Round regions of layers.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/layers/shapes/layer_shape.h"

namespace relumine::cubemap {

class DiscShape;

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

    using Prepared = DiscShape;
    static constexpr ShapeWords Words{.name = "disc",
                                      .label = "disc",
                                      .hint = "a round light",
                                      .about = "All directions within an angle of a centre."};
    static Disc as_added() { return {.radius_degrees = 10.0, .softness = 0.3}; }
    [[nodiscard]] std::vector<LayerField> fields();
    void check() const {}
    [[nodiscard]] std::vector<glm::dvec3> outline() const;
    void resize(const glm::dvec3& from, const glm::dvec3& to);
    void turn_upright(double) {}
};

class DiscShape {
public:
    static constexpr std::size_t NumRamps = 1;
    static constexpr bool HasConcaveRamps = false;
    explicit DiscShape(const Disc& disc);

    [[nodiscard]] Overlap bound(const glm::dvec3& w, double chord) const {
        const double squared = squared_distance(w);
        const double reach = outer_ + chord, room = inner_ - chord;
        if (squared >= reach * reach)
            return Overlap::None;
        return room >= 0.0 && squared <= room * room ? Overlap::All : Overlap::Part;
    }
    [[nodiscard]] std::array<double, NumRamps> ramps(const glm::dvec3& w) const {
        return {(squared_outer_ - squared_distance(w)) * inverse_band_};
    }
    [[nodiscard]] static bool has_kink(std::size_t, const glm::dvec3&, double) { return false; }
    [[nodiscard]] double smallest_feature() const { return smallest_feature_; }
    [[nodiscard]] const DiscShape& within(const glm::dvec3&, double) const { return *this; }

private:
    [[nodiscard]] double squared_distance(const glm::dvec3& w) const {
        return glm::dot(w - axis_, w - axis_);
    }

    glm::dvec3 axis_;
    /// Chords.
    double outer_, inner_;
    double squared_outer_, inverse_band_, smallest_feature_;
};

} // namespace relumine::cubemap
