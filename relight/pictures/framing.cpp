#include "relight/pictures/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/subject.h"

namespace relumine::relight {

namespace {

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

    const mesh::Extent extent = mesh::extent(mesh);
    const mesh::Bounds& all = extent.box;
    const std::vector<bool> is_subject = mesh::subject(mesh, extent);
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

namespace {

/// What a ray meets first, and last.
struct Meeting {
    double distance = std::numeric_limits<double>::infinity();
    bool is_front = false;
    double farthest = 0.0;
    /// The last surface faces away from where the ray begins.
    bool is_closed = false;
};

/// A mesh that may be a room, and which of its triangles are seen (mesh::Extent).
struct Room {
    const mesh::TriangleMesh& mesh;
    const std::vector<bool>& counts;
};

/// Finds what rays from one point meet, triangle by triangle.
std::vector<Meeting> meetings(const Room& room, const glm::dvec3& from,
                              const std::vector<glm::dvec3>& ways) {
    const mesh::TriangleMesh& mesh = room.mesh;
    std::vector<Meeting> result(ways.size());
    for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
        if (!room.counts.empty() && !room.counts[t])
            continue;
        const mesh::Triangle& triangle = mesh.triangles[t];
        const glm::dvec3 a = glm::dvec3(mesh.positions[triangle[0]]) - from;
        const glm::dvec3 b = glm::dvec3(mesh.positions[triangle[1]]) - from;
        const glm::dvec3 c = glm::dvec3(mesh.positions[triangle[2]]) - from;
        const glm::dvec3 ab = glm::cross(a, b), bc = glm::cross(b, c), ca = glm::cross(c, a);
        const double volume = glm::dot(a, bc);
        for (std::size_t i = 0; i < ways.size(); ++i) {
            // The ray passes all three edges on the same side.
            const double x = glm::dot(ways[i], ab), y = glm::dot(ways[i], bc),
                         z = glm::dot(ways[i], ca);
            const double sum = x + y + z;
            const bool is_inside =
                (x >= 0.0 && y >= 0.0 && z >= 0.0) || (x <= 0.0 && y <= 0.0 && z <= 0.0);
            if (!is_inside || sum == 0.0)
                continue;
            const double distance = volume / sum;
            if (!(distance > 0.0))
                continue;
            if (distance < result[i].distance) {
                result[i].distance = distance;
                result[i].is_front = sum < 0.0;
            }
            if (distance > result[i].farthest) {
                result[i].farthest = distance;
                result[i].is_closed = sum > 0.0;
            }
        }
    }
    return result;
}

/// The upward part of the steepest directions.
constexpr double Steep = 0.9;

/// Directions around the horizon, and some above and below it.
std::vector<glm::dvec3> ways_around(std::uint32_t num_around, bool level) {
    std::vector<glm::dvec3> ways;
    for (const double up : {0.0, 0.5, -0.5, Steep, -Steep}) {
        if (level && up != 0.0)
            break;
        for (std::uint32_t i = 0; i < num_around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / num_around;
            const double across = std::sqrt(1.0 - up * up);
            ways.emplace_back(across * std::sin(angle), up, across * std::cos(angle));
        }
    }
    return ways;
}

/// Returns how far the box reaches from a point inside.
double way_out(const mesh::Bounds& box, const glm::dvec3& from, const glm::dvec3& way) {
    double result = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        if (way[axis] != 0.0)
            result = std::min(
                result,
                ((way[axis] > 0.0 ? double{box.max[axis]} : double{box.min[axis]}) - from[axis]) /
                    way[axis]);
    return result;
}

/// Returns how deep in a box a camera sees fronts of surfaces, on the mean of the rays that meet
/// something there: 0 where the box begins, 1 where it ends. What shows its back counts as 0.
double depth_of_fronts(const Room& room, const mesh::Bounds& box, const Camera& camera,
                       float aspect) {
    constexpr int Columns = 12, Rows = 9;
    constexpr float Filled = 0.66f; // by framed()
    const prt::CameraAxes axes = prt::axes_of(camera, aspect);
    const glm::dvec3 eye(camera.eye);
    std::vector<glm::dvec3> ways;
    std::vector<double> entries, lengths;
    for (int row = 0; row < Rows; ++row)
        for (int column = 0; column < Columns; ++column) {
            const auto part = [](int i, int n) {
                return Filled *
                       (2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(n) - 1.0f);
            };
            const glm::dvec3 way = glm::normalize(glm::dvec3(
                axes.forward + part(column, Columns) * axes.right + part(row, Rows) * axes.up));
            const glm::dvec3 low = (glm::dvec3(box.min) - eye) / way;
            const glm::dvec3 high = (glm::dvec3(box.max) - eye) / way;
            const glm::dvec3 first = glm::min(low, high), last = glm::max(low, high);
            const double entry = std::max({first.x, first.y, first.z});
            const double length = std::min({last.x, last.y, last.z}) - entry;
            if (!(length > 0.0) || !(entry > 0.0))
                continue;
            ways.push_back(way);
            entries.push_back(entry);
            lengths.push_back(length);
        }
    const std::vector<Meeting> met = meetings(room, eye, ways);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < met.size(); ++i)
        if (std::isfinite(met[i].distance)) {
            count += 1.0;
            if (met[i].is_front)
                sum += std::clamp((met[i].distance - entries[i]) / lengths[i], 0.0, 1.0);
        }
    return count > 0.0 ? sum / count : 0.0;
}

/// Whether most rays from a point meet fronts, far away in the box. Strictness 1 takes many rays.
bool is_inside_room(const Room& room, const mesh::Bounds& box, const glm::dvec3& from,
                    std::uint32_t num_around, double strictness) {
    constexpr double Met = 0.7, Fronts = 0.65, NearBox = 0.55, Closed = 0.6, Height = 0.5;
    const std::vector<glm::dvec3> ways = ways_around(num_around, false);
    const std::vector<Meeting> around = meetings(room, from, ways);
    double met = 0.0, fronts = 0.0, near_box = 0.0, closed = 0.0, level_or_up = 0.0;
    double height = 0.0;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        if (std::abs(ways[i].y) == Steep)
            height += std::min(around[i].distance, way_out(box, from, ways[i])) * Steep /
                      static_cast<double>(num_around);
        if (ways[i].y >= 0.0) { // below, there may be a floor
            level_or_up += 1.0;
            closed += around[i].is_closed ? 1.0 : 0.0;
        }
        if (!std::isfinite(around[i].distance))
            continue;
        met += 1.0;
        fronts += around[i].is_front ? 1.0 : 0.0;
        near_box += around[i].distance > 0.6 * way_out(box, from, ways[i]) ? 1.0 : 0.0;
    }
    // A chest has an inside, too, but it is closed to the outside; a shelf has low ceilings.
    if (closed > Closed * level_or_up || height < strictness * Height * double{box.size().y})
        return false;
    return met >= strictness * Met * static_cast<double>(ways.size()) &&
           fronts >= strictness * Fronts * met && near_box >= strictness * NearBox * met;
}

} // namespace

Camera framed_from_open_side(const mesh::TriangleMesh& mesh, const Framing& framing) {
    constexpr double Wall = 0.15, Open = 0.3, Deeper = 2.5;
    const mesh::Extent extent = mesh::extent(mesh);
    const Room room{mesh, extent.counts};
    const mesh::Bounds box = mesh::bounds_of(mesh, mesh::subject(mesh, extent));
    Camera result = framed(mesh, framing);
    const double depth = depth_of_fronts(room, box, result, framing.aspect);
    if (depth > Wall)
        return result;
    double deepest = std::max(Open, Deeper * depth);
    for (const double turn : {90.0, -90.0, 180.0}) {
        Framing turned = framing;
        turned.angles.azimuth += turn;
        const Camera camera = framed(mesh, turned);
        if (const double seen = depth_of_fronts(room, box, camera, framing.aspect);
            seen > deepest) {
            deepest = seen;
            result = camera;
        }
    }
    return result;
}

std::optional<Camera> inside_room(const mesh::TriangleMesh& mesh, const Framing& framing) {
    constexpr double EyeHeight = 0.55; // of the room's
    constexpr double FromWall = 0.04;
    constexpr float FovDegrees = 60.0f;
    constexpr std::uint32_t NumAround = 32;
    const mesh::Extent extent = mesh::extent(mesh);
    const Room room{mesh, extent.counts};
    const mesh::Bounds box = mesh::bounds_of(mesh, mesh::subject(mesh, extent));
    const glm::dvec3 size(box.size());
    glm::dvec3 middle(box.center());
    middle.y = double{box.min.y} + EyeHeight * size.y;
    // Few rays tell most objects.
    if (!is_inside_room(room, box, middle, 3, 0.7) || !is_inside_room(room, box, middle, 16, 1.0))
        return std::nullopt;

    // The eye is where the view is longest; of equal ones, to the front.
    const std::vector<glm::dvec3> level = ways_around(NumAround, true);
    const std::vector<Meeting> walls = meetings(room, middle, level);
    double best = 0.0, back = 0.0;
    glm::dvec3 to_eye(framing.front);
    for (std::size_t i = 0; i < level.size(); ++i) {
        const double reach = std::min(walls[i].distance, way_out(box, middle, level[i]));
        const double ahead = std::min(walls[(i + NumAround / 2) % NumAround].distance,
                                      way_out(box, middle, -level[i]));
        const bool is_open = !std::isfinite(walls[i].distance);
        const double score = (is_open ? 1.5 : 1.0) * (reach + ahead) *
                             (1.0 + 0.1 * glm::dot(level[i], framing.front));
        if (score > best) {
            best = score;
            back = (1.0 - FromWall) * reach;
            to_eye = level[i];
        }
    }
    return Camera{.eye = glm::vec3(middle + back * to_eye),
                  .target = glm::vec3(middle),
                  .fov_degrees = FovDegrees};
}

} // namespace relumine::relight
