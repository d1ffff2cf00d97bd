// Points in space as small lit balls, for windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "relight/pictures/picture_view.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

/// A mesh of balls, one at each point that is not inside of an object, and behind them the scene's
/// own triangles. A ball is white and smooth: each of its vertices has the irradiance of its normal
/// over pi, which nine coefficients tell.
///
/// With more than MostBalls points, every n-th has a ball.
class ProbeBalls {
public:
    static constexpr std::size_t MostBalls = 4096;

    /// Throws:  std::invalid_argument for a scene whose receivers have a surface.
    explicit ProbeBalls(const Scene& scene);

    [[nodiscard]] const mesh::TriangleMesh& mesh() const { return mesh_; }
    /// [num_vertices] what radiance() is multiplied with.
    [[nodiscard]] std::vector<glm::vec3> albedo(const Scene& scene) const;
    [[nodiscard]] relight::FadingFloor floor(const Scene& scene) const;

    /// Returns the radiance of all vertices, as a picture of a mesh takes it. Triangles of a scene
    /// without bounces have no light of their own: they are as bright as the points in the mean.
    ///
    /// Shape:   [num_vertices].
    /// Throws:  std::logic_error for a LitScene without LightOptions::harmonics or light.
    [[nodiscard]] std::vector<glm::vec3> radiance(const LitScene& lit) const;

    /// Returns the receiver that a vertex shows: a point, or a vertex behind points.
    [[nodiscard]] std::optional<std::uint32_t> receiver_of(std::uint32_t vertex) const;

private:
    void add_ball(const glm::vec3& middle, float radius, const mesh::TriangleMesh& ball);
    [[nodiscard]] std::size_t num_of_balls() const { return mesh_.num_vertices() - num_behind_; }

    mesh::TriangleMesh mesh_;
    /// [num_balls]
    std::vector<std::uint32_t> points_;
    std::size_t ball_vertices_ = 0;
    /// Vertices of the scene's own mesh, and the receiver of each; empty without bounces.
    std::size_t num_behind_ = 0;
    std::vector<std::uint32_t> receivers_behind_;
};

} // namespace relumine
