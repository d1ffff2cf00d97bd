#include "prt/visibility/half_line.h"

#include <algorithm>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

using Corners = std::array<glm::dvec3, 3>;

/// Whether the corners, seen along `axis`, go round the origin.
bool go_round(const Corners& corners, const glm::dvec3& axis) {
    int num_left = 0;
    int num_right = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side = glm::dot(glm::cross(corners[k], corners[(k + 1) % 3]), axis);
        num_left += side > 0.0 ? 1 : 0;
        num_right += side < 0.0 ? 1 : 0;
    }
    return (num_left == 0 || num_right == 0) && num_left + num_right > 0;
}

double squared_distance_from_origin(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 edge = b - a;
    const double squared_length = glm::dot(edge, edge);
    const double along =
        squared_length > 0.0 ? glm::clamp(-glm::dot(a, edge) / squared_length, 0.0, 1.0) : 0.0;
    const glm::dvec3 nearest = a + along * edge;
    return glm::dot(nearest, nearest);
}

/// Whether an edge stays farther than `distance` from the half-line's whole line. The part of the
/// edge more than `distance` behind the start does not count.
bool edge_passes_by(glm::dvec3 a, glm::dvec3 b, const glm::dvec3& w, double distance) {
    const double ahead_a = glm::dot(a, w) + distance;
    const double ahead_b = glm::dot(b, w) + distance;
    if (ahead_a < 0.0 && ahead_b < 0.0)
        return true;
    const glm::dvec3 border = a + (b - a) * (ahead_a / (ahead_a - ahead_b));
    if (ahead_a < 0.0)
        a = border;
    else if (ahead_b < 0.0)
        b = border;
    return squared_distance_from_origin(a - glm::dot(a, w) * w, b - glm::dot(b, w) * w) >
           distance * distance;
}

} // namespace

bool meets(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w) {
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    return go_round(corners, w) && glm::dot(normal, corners[0]) * glm::dot(normal, w) >= 0.0;
}

Meeting meeting_of(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w) {
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double along = glm::dot(normal, w);
    if (along == 0.0)
        return {.distance = std::max(glm::dot(corners[0], w) / glm::dot(w, w), 0.0)};
    return {.distance = std::max(glm::dot(normal, corners[0]) / along, 0.0),
            .barycentric = {glm::dot(glm::cross(corners[2], corners[0]), w) / along,
                            glm::dot(glm::cross(corners[0], corners[1]), w) / along}};
}

bool passes_by(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& w, double distance) {
    if (meets(corners, w))
        return false;
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double height = glm::dot(normal, corners[0]);
    // The start may be close to the middle of the triangle, far from its edges.
    if (height * height <= distance * distance * glm::dot(normal, normal) &&
        go_round(corners, normal))
        return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (!edge_passes_by(corners[k], corners[(k + 1) % 3], w, distance))
            return false;
    return true;
}

} // namespace relumine::prt
