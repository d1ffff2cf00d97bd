#include "cubemap/image/projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

using std::numbers::pi;

/// Returns the position relative to the middle, to the right and up.
glm::dvec2 from_middle(const glm::dvec2& point) {
    return {point.x - 0.5, 0.5 - point.y};
}
glm::dvec2 to_point(const glm::dvec2& from_middle) {
    return {0.5 + from_middle.x, 0.5 - from_middle.y};
}

/// Debevec's light probes. The middle is -Z; the angle from -Z grows with the distance from the
/// middle; the rim is +Z. Right is +X, up is +Y.
///     angle = 2 pi rho,  rho = |(x, y)| <= 1/2
///     direction = (sin(angle) x / rho, sin(angle) y / rho, -cos(angle))
class AngularMap : public Projection {
public:
    [[nodiscard]] glm::dvec3 direction(const glm::dvec2& point) const override {
        const glm::dvec2 p = from_middle(point);
        const double rho = std::min(glm::length(p), 0.5);
        if (rho == 0.0)
            return {0.0, 0.0, -1.0};
        const double angle = 2.0 * pi * rho;
        const double scale = (rho == 0.5 ? 0.0 : std::sin(angle)) / glm::length(p);
        return {p.x * scale, p.y * scale, -std::cos(angle)};
    }
    [[nodiscard]] glm::dvec2 point(const glm::dvec3& w) const override {
        const double across = std::hypot(w.x, w.y);
        if (across == 0.0)
            return to_point({w.z > 0.0 ? 0.5 : 0.0, 0.0});
        const double rho = std::atan2(across, -w.z) / (2.0 * pi);
        return to_point({w.x / across * rho, w.y / across * rho});
    }
    [[nodiscard]] double density(const glm::dvec2& point) const override {
        const double angle = 2.0 * pi * std::min(glm::length(from_middle(point)), 0.5);
        return 4.0 * pi * pi * (angle < 1e-4 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle);
    }
    [[nodiscard]] bool is_disc() const override { return true; }
    [[nodiscard]] bool is_mirrored() const override { return false; }
};

/// A mirror ball seen from far away along -Z. The middle reflects +Z, the camera; the rim reflects
/// -Z, the world behind the ball. The ball's normal is n = (2x, 2y, sqrt(1 - 4 rho^2)). The
/// direction is the reflection of the line of sight:
///     direction = (2 n.z n.x, 2 n.z n.y, 2 n.z^2 - 1)
/// Equal solid angles have equal areas: dw = 16 dA.
class MirrorBall : public Projection {
public:
    [[nodiscard]] glm::dvec3 direction(const glm::dvec2& point) const override {
        const glm::dvec2 n = 2.0 * from_middle(point);
        const double squared = std::max(1.0 - glm::dot(n, n), 0.0);
        const double scale = 2.0 * std::sqrt(squared);
        return {scale * n.x, scale * n.y, 2.0 * squared - 1.0};
    }
    [[nodiscard]] glm::dvec2 point(const glm::dvec3& w) const override {
        // n is half way between the direction and +Z. Near the rim 1 + z would lose its digits.
        const double across = std::hypot(w.x, w.y);
        if (across == 0.0)
            return to_point({w.z > 0.0 ? 0.0 : 0.5, 0.0});
        const double sine = std::sin(0.5 * std::atan2(across, w.z));
        return to_point({0.5 * sine * w.x / across, 0.5 * sine * w.y / across});
    }
    [[nodiscard]] double density(const glm::dvec2&) const override { return 16.0; }
    [[nodiscard]] bool is_disc() const override { return true; }
    [[nodiscard]] bool is_mirrored() const override { return true; }
};

/// The equal-area octahedral map of pbrt-v4 (Clarberg: Fast Equal-Area Mapping of the (Hemi)Sphere
/// using SIMD, 2008), with pbrt's Z up. The middle is +Y, the corners are -Y, right is +X and down
/// is -Z. The square |u| + |v| <= 1 is the upper half-sphere.
///     r = 1 - |1 - |u| - |v||,  angle = pi/4 ((|v| - |u|) / r + 1),
///     height = +-(1 - r^2),  horizontal radius = r sqrt(2 - r^2);  dw = 4 pi dA
class Octahedral : public Projection {
public:
    [[nodiscard]] glm::dvec3 direction(const glm::dvec2& point) const override {
        const double u = 2.0 * point.x - 1.0, v = 2.0 * point.y - 1.0;
        const double inside = 1.0 - (std::abs(u) + std::abs(v));
        const double r = 1.0 - std::abs(inside);
        const double angle = 0.25 * pi * (r == 0.0 ? 1.0 : (std::abs(v) - std::abs(u)) / r + 1.0);
        const double across = r * std::sqrt(std::max(2.0 - r * r, 0.0));
        return {std::copysign(std::cos(angle) * across, u), std::copysign(1.0 - r * r, inside),
                -std::copysign(std::sin(angle) * across, v)};
    }
    [[nodiscard]] glm::dvec2 point(const glm::dvec3& w) const override {
        const double x = std::abs(w.x), down = std::abs(w.z), across = std::hypot(x, down);
        // This is sqrt(1 - |y|) without cancellation.
        const double r = across / std::sqrt(1.0 + std::abs(w.y));
        const double share = across == 0.0 ? 0.5 : std::atan2(down, x) * 2.0 / pi;
        glm::dvec2 p(r * (1.0 - share), r * share);
        if (w.y < 0.0)
            p = {1.0 - p.y, 1.0 - p.x};
        return {0.5 + 0.5 * std::copysign(p.x, w.x), 0.5 + 0.5 * std::copysign(p.y, -w.z)};
    }
    [[nodiscard]] double density(const glm::dvec2&) const override { return 4.0 * pi; }
    [[nodiscard]] bool is_disc() const override { return false; }
    [[nodiscard]] bool is_mirrored() const override { return false; }
};

} // namespace

const Projection* projection(Layout layout) {
    static const AngularMap Angular;
    static const MirrorBall Ball;
    static const Octahedral Square;
    switch (layout) {
    case Layout::AngularMap:
        return &Angular;
    case Layout::MirrorBall:
        return &Ball;
    case Layout::Octahedral:
        return &Square;
    default:
        return nullptr;
    }
}

} // namespace relumine::cubemap
