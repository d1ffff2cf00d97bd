#include "prt/visibility/triangle_verdict.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

constexpr double Roundings = 0x1p-24;
constexpr double Tiny = 1e-35; // products below are lost in float

} // namespace

/// Rounding errors of the exact tracer and their bounds: docs/error-bounds.md, rows V1 to V5. The
/// errors of double precision do not count beside them.
Verdict judge(const TriangleTree::Leaf& leaf, std::size_t lane, const glm::vec3& origin,
              const glm::vec3& w) {
    glm::dvec3 v[3];
    double p[3];
    double d = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t a = 0; a < 3; ++a)
            v[k][static_cast<int>(a)] = static_cast<double>(leaf.corners[3 * k + a][lane]) -
                                        static_cast<double>(origin[static_cast<int>(a)]);
        p[k] = glm::length(glm::cross(v[k], glm::dvec3(w)));
        d = std::max(d, glm::length(v[k]));
    }
    const double l =
        std::max({glm::distance(v[0], v[1]), glm::distance(v[1], v[2]), glm::distance(v[2], v[0])});
    constexpr double u = Roundings;
    const double side = glm::dot(glm::cross(v[1] - v[0], v[2] - v[1]), v[0]);
    const bool has_side = std::abs(side) > u * (6.0 * l * d * d + 12.0 * l * l * d) + Tiny;
    int num_positive = 0;
    int num_negative = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const double edge_function = glm::dot(glm::cross(v[k], v[next]), glm::dvec3(w));
        const double certain = u * (16.0 * l * d + 2.0 * d * (p[k] + p[next]) + 4.0 * l * l) + Tiny;
        num_positive += edge_function > certain ? 1 : 0;
        num_negative += edge_function < -certain ? 1 : 0;
    }
    if (num_positive > 0 && num_negative > 0)
        return Verdict::Miss;
    if (!has_side)
        return Verdict::Doubt;
    if ((side > 0.0 ? num_negative : num_positive) > 0)
        return Verdict::Miss;
    return (side > 0.0 ? num_positive : num_negative) == 3 ? Verdict::Hit : Verdict::Doubt;
}

/// Whether a ray hits for certain: judge() without roots. Where a ray hits, each corner is at most
/// l from its line, and l <= 2 d. So rows V1 to V3 are 28 l d together, V4 and V5 are 30 l d^2.
/// Squares of sums are at most twice the sums of squares.
bool hits_for_certain(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w) {
    const auto& [a, b, c] = corners;
    const glm::dvec3 ab = b - a, bc = c - b, ca = a - c;
    const double side = glm::dot(glm::cross(ab, bc), a);
    const double sign = side > 0.0 ? 1.0 : -1.0;
    const double least =
        std::min({sign * glm::dot(glm::cross(a, b), w), sign * glm::dot(glm::cross(b, c), w),
                  sign * glm::dot(glm::cross(c, a), w)});
    const double ll = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
    const double dd = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
    const auto exceeds = [](double value, double coefficient, double square) {
        const double lost = coefficient * Roundings;
        return value * value > 2.0 * (lost * lost * square + Tiny * Tiny);
    };
    return least > 0.0 && exceeds(least, 28.0, ll * dd) && exceeds(side, 30.0, ll * dd * dd);
}

} // namespace relumine::prt
