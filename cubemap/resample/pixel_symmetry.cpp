#include "cubemap/resample/pixel_symmetry.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "cubemap/image/projection.h"

namespace relumine::cubemap::detail {

namespace {

/// Returns the direction of a point of the picture, in [0, 1]^2.
glm::dvec3 direction_at(const ImageShape& shape, const glm::dvec2& point) {
    if (const Projection* picture = projection(shape.layout))
        return picture->direction(point);
    const double longitude = 2.0 * std::numbers::pi * (0.5 - point.x);
    const double polar = std::numbers::pi * point.y;
    return {std::sin(polar) * std::sin(longitude), std::cos(polar),
            std::sin(polar) * std::cos(longitude)};
}

glm::dvec2 moved(const PixelSymmetry::Move& move, std::uint32_t width, glm::dvec2 point) {
    if (move.swaps)
        std::swap(point.x, point.y);
    point.x = move.mirrors_x ? 1.0 - point.x : point.x;
    point.y = move.mirrors_y ? 1.0 - point.y : point.y;
    point.x += static_cast<double>(move.shift) / width;
    point.x -= std::floor(point.x);
    return point;
}

/// Returns the matrix that moves the sphere as `move` moves the picture, if it carries axes to
/// axes.
std::optional<glm::dmat3> turn_of_sphere(const ImageShape& shape, const PixelSymmetry::Move& move) {
    // Three directions and where they go make the matrix; a fourth one proves it.
    constexpr std::array<glm::dvec2, 4> Points = {
        {{0.41, 0.28}, {0.55, 0.33}, {0.37, 0.61}, {0.66, 0.57}}};
    std::array<glm::dvec3, 4> from{}, to{};
    for (std::size_t i = 0; i < Points.size(); ++i) {
        from[i] = direction_at(shape, Points[i]);
        to[i] = direction_at(shape, moved(move, shape.width, Points[i]));
    }
    const glm::dmat3 exact =
        glm::dmat3(to[0], to[1], to[2]) * glm::inverse(glm::dmat3(from[0], from[1], from[2]));
    glm::dmat3 rounded(0.0);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            rounded[column][row] = std::round(exact[column][row]);
    constexpr double Tolerance = 1e-9;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (glm::distance(rounded * from[i], to[i]) > Tolerance)
            return std::nullopt;
    return rounded;
}

} // namespace

PixelSymmetry::PixelSymmetry(const ImageShape& shape, const Move& move, const glm::dmat3& turn,
                             std::uint32_t resolution)
    : move_(move), width_(shape.width), height_(shape.height) {
    CubeMap layout; // for its indices only
    layout.resolution = resolution;
    // Where a point beside the middle of a face goes, and where one step in s or t leads from
    // there.
    for (const Face face : AllFaces) {
        const auto place = [&](double s, double t) {
            return face_point(turn * cubemap::direction(face, s, t));
        };
        const FacePoint at = place(0.5, 0.5), right = place(0.75, 0.5), below = place(0.5, 0.75);
        const auto sign = [](double difference) {
            return std::abs(difference) < 0.1 ? 0 : difference < 0.0 ? -1 : 1;
        };
        const std::int64_t r = resolution;
        const std::int64_t x_per_x = sign(right.s - at.s), y_per_x = sign(right.t - at.t),
                           x_per_y = sign(below.s - at.s), y_per_y = sign(below.t - at.t);
        const std::int64_t x0 = x_per_x + x_per_y < 0 ? r - 1 : 0,
                           y0 = y_per_x + y_per_y < 0 ? r - 1 : 0;
        faces_[static_cast<std::size_t>(face)] = {
            static_cast<std::int64_t>(layout.index(at.face, 0, 0)) + y0 * r + x0,
            y_per_x * r + x_per_x, y_per_y * r + x_per_y};
    }
}

std::vector<PixelSymmetry> pixel_symmetries(const ImageShape& shape, const glm::dmat3& turn,
                                            std::uint32_t resolution) {
    std::vector<PixelSymmetry> result = {PixelSymmetry(shape, {}, glm::dmat3(1.0), resolution)};
    if (!carries_axes_to_axes(turn) || has_faces(shape.layout))
        return result;
    const bool is_lat_long = shape.layout == Layout::LatLong;
    const bool has_quarters =
        is_lat_long && shape.sampling == Sampling::TexelCentres && shape.width % 4 == 0;
    for (std::uint32_t i = 1; i < 32; ++i) {
        const PixelSymmetry::Move move = {.swaps = (i & 1) != 0,
                                          .mirrors_x = (i & 2) != 0,
                                          .mirrors_y = (i & 4) != 0,
                                          .shift = shape.width / 4 * (i >> 3)};
        if ((move.swaps && is_lat_long) || ((i >> 3) != 0 && !has_quarters))
            continue;
        if (const auto own = turn_of_sphere(shape, move))
            result.emplace_back(shape, move, turn * *own * glm::transpose(turn), resolution);
    }
    return result;
}

} // namespace relumine::cubemap::detail
