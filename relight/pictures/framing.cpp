#include "relight/pictures/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

namespace relumine::relight {

namespace {

/// Marks the vertices of the objects on the ground: triangles wholly in the lowest horizontal plane
/// are left out, unless there is nothing else.
std::vector<bool> subject(const mesh::TriangleMesh& mesh, const mesh::Bounds& all) {
    const float ground = all.min.y + 1e-3f * all.size().y;
    std::vector<bool> stands(mesh.num_vertices(), false), lies(mesh.num_vertices(), false);
    bool any = false;
    for (const mesh::Triangle& triangle : mesh.triangles) {
        const bool is_above = std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
            return mesh.positions[v].y > ground;
        });
        for (const std::uint32_t v : triangle)
            (is_above ? stands : lies)[v] = true;
        any = any || is_above;
    }
    return any ? stands : lies;
}

/// The largest and the smallest of values.
struct Extent {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

} // namespace

Camera framed(const mesh::TriangleMesh& mesh, const Framing& framing) {
    constexpr double Filled = 2.0 / 3.0;
    constexpr double RadiansPerDegree = std::numbers::pi / 180.0;
    const double azimuth = framing.angles.azimuth * RadiansPerDegree;
    const double elevation = framing.angles.elevation * RadiansPerDegree;
    const glm::dvec3 side = glm::cross(glm::dvec3(0, 1, 0), framing.front);
    const glm::dvec3 from_target =
        std::cos(elevation) * (std::cos(azimuth) * framing.front + std::sin(azimuth) * side) +
        std::sin(elevation) * glm::dvec3(0, 1, 0);

    // About the middle: far from the origin floats could not hold so short a way.
    const prt::CameraAxes axes = prt::axes_of(
        {.eye = glm::vec3(from_target), .fov_degrees = framing.fov_degrees}, framing.aspect);
    const glm::dvec3 right(glm::normalize(axes.right)), up(glm::normalize(axes.up)),
        forward = -from_target;
    const double across = Filled * static_cast<double>(glm::length(axes.right));
    const double upwards = Filled * static_cast<double>(glm::length(axes.up));

    const mesh::Bounds all = mesh::bounds(mesh);
    const std::vector<bool> is_subject = subject(mesh, all);
    const glm::dvec3 middle = 0.5 * (glm::dvec3(all.min) + glm::dvec3(all.max));
    // A point at x, depth z is inside of two planes through the eye at (X, Z) where
    // |x - X| <= slope (z - Z): x - slope z <= X - slope Z, and -x - slope z <= -X - slope Z.
    Extent depth, to_right, to_left, to_top, to_bottom;
    for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
        if (!is_subject[v])
            continue;
        const glm::dvec3 offset = glm::dvec3(mesh.positions[v]) - middle;
        const double x = glm::dot(offset, right), y = glm::dot(offset, up);
        const double z = glm::dot(offset, forward);
        depth.add(z);
        to_right.add(x - across * z);
        to_left.add(-x - across * z);
        to_top.add(y - upwards * z);
        to_bottom.add(-y - upwards * z);
    }
    if (!(depth.low <= depth.high)) // nothing to look at
        return {.eye = glm::vec3(middle + from_target),
                .target = glm::vec3(middle),
                .fov_degrees = framing.fov_degrees};
    const double eye_x = 0.5 * (to_right.high - to_left.high);
    const double eye_y = 0.5 * (to_top.high - to_bottom.high);
    double eye_z = std::min(-0.5 * (to_right.high + to_left.high) / across,
                            -0.5 * (to_top.high + to_bottom.high) / upwards);
    const double target_z = 0.5 * (depth.low + depth.high);
    const double size = std::max(target_z - depth.low, 1e-3 * static_cast<double>(all.diagonal()));
    // In front of everything, however wide the view; apart from the target in floats, too.
    eye_z = std::min(eye_z, depth.low - 1e-3 * size);
    const double farthest =
        glm::length(glm::max(glm::abs(glm::dvec3(all.min)), glm::abs(glm::dvec3(all.max))));
    eye_z = std::min(eye_z, target_z - std::max(1e-20, 1e-5 * farthest));
    if (framing.angles.distance)
        eye_z = target_z - *framing.angles.distance;
    const auto at = [&](double z) {
        return glm::vec3(middle + eye_x * right + eye_y * up + z * forward);
    };
    return {.eye = at(eye_z), .target = at(target_z), .fov_degrees = framing.fov_degrees};
}

} // namespace relumine::relight
