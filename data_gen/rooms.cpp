// The rooms of scenes.h.
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "data_gen/icosphere.h"
#include "data_gen/scene_parts.h"
#include "data_gen/scenes.h"
#include "data_gen/shapes.h"
#include "mesh/normals.h"

namespace relumine::data_gen {
namespace {

constexpr glm::vec3 White(0.75f), Wood(0.45f, 0.32f, 0.22f), Red(0.63f, 0.06f, 0.05f),
    Green(0.14f, 0.45f, 0.09f);

enum Axis { X, Y, Z };

/// The part of a box on the plane of an axis.
PlaneRectangle side_of(const glm::dvec3& min, const glm::dvec3& max, int axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    return {.min = {min[u], min[v]}, .max = {max[u], max[v]}};
}

/// A room that is being built: all its parts have vertices of one spacing.
class Builder {
public:
    explicit Builder(double spacing) : spacing_(spacing) {}

    void add_wall(const Wall& wall, const glm::vec3& color,
                  const std::vector<PlaneRectangle>& holes = {}) {
        append_wall(mesh_, wall, spacing_, holes);
        paint(color);
    }

    void add_box(const glm::dvec3& min, const glm::dvec3& max, const glm::vec3& color) {
        append_box(mesh_, min, max, spacing_);
        paint(color);
    }

    /// Adds a sphere that stands on the floor.
    void add_ball(const glm::dvec3& foot, double radius, const glm::vec3& color) {
        mesh::TriangleMesh ball = icosphere(ball_frequency(radius, spacing_));
        for (glm::vec3& p : ball.positions) {
            p *= static_cast<float>(radius);
        }
        append_copy(mesh_, ball, 0.0, foot + glm::dvec3(0.0, radius, 0.0));
        paint(color);
    }

    [[nodiscard]] mesh::TriangleMesh take() { return std::move(mesh_); }

private:
    void paint(const glm::vec3& color) { mesh_.colors.resize(mesh_.num_vertices(), color); }

    double spacing_;
    mesh::TriangleMesh mesh_;
};

mesh::TriangleMesh room_of(double spacing) {
    constexpr glm::dvec3 Min(-2.0, 0.0, -2.5), Max(2.0, 2.8, 2.5);
    constexpr glm::dvec3 BoxMin(-0.4, 0.0, -1.9), BoxMax(0.5, 0.7, -1.0);
    // The window is a shaft through the wall, open outside.
    constexpr glm::dvec3 WindowMin(-2.3, 0.9, -0.2), WindowMax(-2.0, 2.2, 1.4);

    Builder room(spacing);
    room.add_wall({.axis = Y, .at = Min.y, .outline = side_of(Min, Max, Y)}, Wood,
                  {side_of(BoxMin, BoxMax, Y)});
    room.add_wall({.axis = Y, .at = Max.y, .faces_up = false, .outline = side_of(Min, Max, Y)},
                  White);
    room.add_wall({.axis = X, .at = Min.x, .outline = side_of(Min, Max, X)}, White,
                  {side_of(WindowMin, WindowMax, X)});
    room.add_wall({.axis = X, .at = Max.x, .faces_up = false, .outline = side_of(Min, Max, X)},
                  White);
    room.add_wall({.axis = Z, .at = Min.z, .outline = side_of(Min, Max, Z)}, White);
    room.add_wall({.axis = Z, .at = Max.z, .faces_up = false, .outline = side_of(Min, Max, Z)},
                  White);
    for (const int axis : {Y, Z}) {
        const PlaneRectangle side = side_of(WindowMin, WindowMax, axis);
        room.add_wall({.axis = axis, .at = WindowMin[axis], .outline = side}, White);
        room.add_wall({.axis = axis, .at = WindowMax[axis], .faces_up = false, .outline = side},
                      White);
    }
    room.add_box(BoxMin, BoxMax, White);
    room.add_ball({1.0, 0.0, -0.1}, 0.4, White);
    return room.take();
}

mesh::TriangleMesh painted_room_of(double spacing) {
    constexpr glm::dvec3 Min(-2.0, 0.0, -2.0), Max(2.0, 3.2, 2.0);
    constexpr glm::dvec3 BoxMin(-1.3, 0.0, -1.4), BoxMax(-0.3, 1.8, -0.4);

    Builder room(spacing);
    room.add_wall({.axis = Y, .at = Min.y, .outline = side_of(Min, Max, Y)}, White,
                  {side_of(BoxMin, BoxMax, Y)});
    room.add_wall({.axis = Y, .at = Max.y, .faces_up = false, .outline = side_of(Min, Max, Y)},
                  White);
    room.add_wall({.axis = X, .at = Min.x, .outline = side_of(Min, Max, X)}, Red);
    room.add_wall({.axis = X, .at = Max.x, .faces_up = false, .outline = side_of(Min, Max, X)},
                  Green);
    room.add_wall({.axis = Z, .at = Min.z, .outline = side_of(Min, Max, Z)}, White);
    room.add_box(BoxMin, BoxMax, White);
    room.add_ball({0.8, 0.0, 0.3}, 0.6, White);
    return room.take();
}

/// Returns the room whose spacing meets the wished number of vertices best.
mesh::TriangleMesh with_vertices(std::size_t num_vertices,
                                 const std::function<mesh::TriangleMesh(double)>& make) {
    check_num_vertices(num_vertices);
    const auto miss = [&](const mesh::TriangleMesh& mesh) {
        return std::abs(static_cast<double>(mesh.num_vertices()) -
                        static_cast<double>(num_vertices));
    };
    // The count falls as the spacing grows, in steps. The rooms have 70 to 95 m^2.
    const double one_square_metre = 1.0 / std::sqrt(static_cast<double>(num_vertices));
    double fine = 5.0 * one_square_metre;
    double coarse = 20.0 * one_square_metre;
    mesh::TriangleMesh best;
    for (int step = 0; step < 16; ++step) {
        const double middle = std::sqrt(fine * coarse);
        mesh::TriangleMesh mesh = make(middle);
        (mesh.num_vertices() > num_vertices ? fine : coarse) = middle;
        if (best.positions.empty() || miss(mesh) < miss(best)) {
            best = std::move(mesh);
        }
    }
    best.normals = mesh::smooth_normals(best);
    return best;
}

} // namespace

mesh::TriangleMesh room(std::size_t num_vertices) {
    return with_vertices(num_vertices, room_of);
}

mesh::TriangleMesh painted_room(std::size_t num_vertices) {
    return with_vertices(num_vertices, painted_room_of);
}

} // namespace relumine::data_gen
