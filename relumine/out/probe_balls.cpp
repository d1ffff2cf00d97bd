#include "relumine/out/probe_balls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "prt/receivers/receiver_layout.h"
#include "relight/harmonics/harmonics.h"
#include "relumine/out/floor_picture.h"
#include "relumine/out/receiver_colors.h"

namespace relumine {

namespace {

constexpr std::uint32_t NoReceiver = std::numeric_limits<std::uint32_t>::max();

/// An octahedron whose triangles are halved so often, on the unit sphere: 66 vertices.
mesh::TriangleMesh unit_ball() {
    constexpr int Halvings = 2;
    mesh::TriangleMesh ball;
    ball.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    ball.triangles = {{0, 2, 4}, {4, 2, 1}, {1, 2, 5}, {5, 2, 0},
                      {4, 3, 0}, {1, 3, 4}, {5, 3, 1}, {0, 3, 5}};
    for (int i = 0; i < Halvings; ++i) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [found, is_new] = middles.try_emplace(
                std::minmax(a, b), static_cast<std::uint32_t>(ball.num_vertices()));
            if (is_new)
                ball.positions.push_back(glm::normalize(ball.positions[a] + ball.positions[b]));
            return found->second;
        };
        std::vector<mesh::Triangle> halved;
        for (const auto& [a, b, c] : ball.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            halved.insert(halved.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        ball.triangles = std::move(halved);
    }
    return ball;
}

/// An eighth of the distance between neighbours, as far as the kind of points tells.
float radius_of(const Scene& scene) {
    constexpr float Part = 0.12f;
    if (const auto* grid = std::get_if<prt::GridLayout>(&scene.layout)) {
        const glm::vec3 cell = (grid->high - grid->low) / glm::vec3(grid->nx, grid->ny, grid->nz);
        return Part * std::min({cell.x, cell.y, cell.z});
    }
    const mesh::Bounds box =
        mesh::bounds(std::span(scene.receivers.places()).first(scene.receivers.num_own()));
    const float of_mesh = 0.02f * mesh::bounds(scene.mesh).diagonal();
    const float between = box.diagonal() / std::cbrt(static_cast<float>(scene.receivers.num_own()));
    return between > 0.0f ? std::min(Part * between, of_mesh) : of_mesh;
}

} // namespace

ProbeBalls::ProbeBalls(const Scene& scene) {
    const prt::Receivers& receivers = scene.receivers;
    if (receivers.num_points() == 0)
        throw std::invalid_argument("expected a scene of points in space");
    const mesh::TriangleMesh ball = unit_ball();
    ball_vertices_ = ball.num_vertices();
    const std::size_t step = (receivers.num_points() + MostBalls - 1) / MostBalls;
    const float radius = radius_of(scene);
    for (std::uint32_t i = 0; i < receivers.num_points(); i += static_cast<std::uint32_t>(step))
        if (!receivers.is_inside(i)) {
            points_.push_back(i);
            add_ball(receivers.places()[i], radius, ball);
        }
    const auto first = static_cast<std::uint32_t>(mesh_.num_vertices());
    num_behind_ = scene.mesh.num_vertices();
    mesh_.positions.insert(mesh_.positions.end(), scene.mesh.positions.begin(),
                           scene.mesh.positions.end());
    mesh_.normals.insert(mesh_.normals.end(), scene.mesh.normals.begin(), scene.mesh.normals.end());
    for (const auto& [a, b, c] : scene.mesh.triangles)
        mesh_.triangles.push_back({first + a, first + b, first + c});
    if (receivers.num_added == 0)
        return;
    receivers_behind_.assign(num_behind_, NoReceiver);
    for (std::size_t i = receivers.num_own(); i < receivers.size(); ++i)
        receivers_behind_[prt::vertex_at(scene.mesh, receivers.points[i])] =
            static_cast<std::uint32_t>(i);
}

void ProbeBalls::add_ball(const glm::vec3& middle, float radius, const mesh::TriangleMesh& ball) {
    const auto first = static_cast<std::uint32_t>(mesh_.num_vertices());
    for (const glm::vec3& direction : ball.positions) {
        mesh_.positions.push_back(middle + radius * direction);
        mesh_.normals.push_back(direction);
    }
    for (const auto& [a, b, c] : ball.triangles)
        mesh_.triangles.push_back({first + a, first + b, first + c});
}

std::vector<glm::vec3> ProbeBalls::albedo(const Scene& scene) const {
    std::vector<glm::vec3> result(mesh_.num_vertices(), glm::vec3(1.0f));
    if (receivers_behind_.empty())
        return result;
    const std::vector<glm::vec3> of_receivers = bounce_albedo(scene);
    for (std::size_t vertex = 0; vertex < num_behind_; ++vertex)
        if (receivers_behind_[vertex] != NoReceiver)
            result[num_of_balls() + vertex] = of_receivers[receivers_behind_[vertex]];
    return result;
}

relight::FadingFloor ProbeBalls::floor(const Scene& scene) const {
    relight::FadingFloor floor = picture_floor(scene);
    if (floor.first_vertex < num_behind_)
        floor.first_vertex += static_cast<std::uint32_t>(num_of_balls());
    return floor;
}

std::vector<glm::vec3> ProbeBalls::radiance(const LitScene& lit) const {
    const std::vector<glm::vec3> light = lit.harmonics();
    const std::size_t width = light.size() / lit.scene().receivers.size();
    std::vector<glm::vec3> result(mesh_.num_vertices(), glm::vec3(0.0f));
    glm::vec3 mean(0.0f);
    for (std::size_t ball = 0; ball < points_.size(); ++ball) {
        const auto own = std::span(light).subspan(points_[ball] * width, width);
        mean += relight::mean_radiance(own[0]) / static_cast<float>(points_.size());
        for (std::size_t i = ball * ball_vertices_; i < (ball + 1) * ball_vertices_; ++i)
            result[i] = glm::max(relight::irradiance(own, mesh_.normals[i]) / std::numbers::pi,
                                 glm::dvec3(0.0));
    }
    const std::span<const glm::vec3> radiance = lit.radiance();
    for (std::size_t vertex = 0; vertex < num_behind_; ++vertex)
        if (receivers_behind_.empty())
            result[num_of_balls() + vertex] = mean;
        else if (receivers_behind_[vertex] != NoReceiver)
            result[num_of_balls() + vertex] = radiance[receivers_behind_[vertex]];
    return result;
}

std::optional<std::uint32_t> ProbeBalls::receiver_of(std::uint32_t vertex) const {
    if (vertex < num_of_balls())
        return points_[vertex / ball_vertices_];
    if (receivers_behind_.empty())
        return std::nullopt;
    const std::uint32_t receiver = receivers_behind_[vertex - num_of_balls()];
    return receiver == NoReceiver ? std::nullopt : std::optional(receiver);
}

} // namespace relumine
