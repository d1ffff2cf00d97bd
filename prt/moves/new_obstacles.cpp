#include "prt/moves/new_obstacles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "prt/moves/met_boxes.h"
#include "prt/moves/moved_scene.h"
#include "prt/receivers/lit_position.h"
#include "prt/receivers/mesh_point.h"
#include "prt/scene/absent_groups.h"

namespace relumine::prt {

namespace {

bool meet(const mesh::Bounds& a, const mesh::Bounds& b) {
    return glm::max(a.min, b.min) == glm::min(glm::max(a.min, b.min), glm::min(a.max, b.max));
}

class NewObstacles {
public:
    NewObstacles(Scene& scene, const RayScene& rays, SceneChange& change)
        : scene_(scene), rays_(rays), change_(change), is_away_(scene.mesh.groups.size()) {
        for (const AbsentGroup& own : scene.absent)
            is_away_[own.group] = true;
    }

    void leave() {
        if (on_vertices(scene_.layout) || scene_.receivers.num_added != 0)
            leave_by_vertices();
        if (std::holds_alternative<TexelLayout>(scene_.layout))
            leave_by_texels();
        if (!moved_.empty())
            add_receivers();
    }

private:
    /// Whether the group's boxes are so near to a place that rays start within them.
    [[nodiscard]] bool is_near(const glm::vec3& place, float lift) const {
        // Obstacles are looked for up to the start of rays, and a little behind the place.
        const float reach = lift + 3.0f * scene_.settings.bias;
        const mesh::Bounds around{place - reach, place + reach};
        const SceneDifference& difference = change_.difference;
        return std::ranges::any_of(difference.around,
                                   [&](const mesh::Bounds& box) { return meet(box, around); }) &&
               std::ranges::any_of(difference.boxes,
                                   [&](const mesh::Bounds& box) { return meet(box, around); });
    }

    [[nodiscard]] glm::vec3 lift_of(std::uint32_t vertex) const {
        return scene_.mesh.lifts.empty() ? glm::vec3(0.0f) : scene_.mesh.lifts[vertex];
    }
    [[nodiscard]] glm::vec3 free_lift_of(std::uint32_t vertex) const {
        return scene_.free_lifts.empty() ? free_lift(lift_of(vertex), scene_.mesh.normals[vertex])
                                         : scene_.free_lifts[vertex];
    }

    /// Returns the triangles of vertices near the group, alone, with free lifts. `vertices` are
    /// theirs; `is_near` tells which are near.
    mesh::TriangleMesh surroundings(std::vector<std::uint32_t>& vertices,
                                    std::vector<bool>& near) const {
        const mesh::TriangleMesh& mesh = scene_.mesh;
        near.assign(mesh.num_vertices(), false);
        for (std::uint32_t i = 0; i < near.size(); ++i)
            near[i] = is_near(mesh.positions[i], glm::length(free_lift_of(i)));
        constexpr std::uint32_t None = ~std::uint32_t{0};
        std::vector<std::uint32_t> index(mesh.num_vertices(), None);
        mesh::TriangleMesh result;
        for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
            if (is_away_[mesh.triangle_groups[i]] ||
                std::ranges::none_of(mesh.triangles[i], [&](auto vertex) { return near[vertex]; }))
                continue;
            mesh::Triangle triangle = mesh.triangles[i];
            for (std::uint32_t& vertex : triangle) {
                if (index[vertex] == None) {
                    index[vertex] = static_cast<std::uint32_t>(vertices.size());
                    vertices.push_back(vertex);
                    result.positions.push_back(mesh.positions[vertex]);
                    result.normals.push_back(mesh.normals[vertex]);
                    result.lifts.push_back(free_lift_of(vertex));
                }
                vertex = index[vertex];
            }
            result.triangles.push_back(triangle);
        }
        return result;
    }

    void leave_by_vertices() {
        std::vector<std::uint32_t> vertices;
        std::vector<bool> near;
        mesh::TriangleMesh own = surroundings(vertices, near);
        const float rim_step = rim_step_of(scene_);
        std::vector<glm::vec3> free = own.lifts;
        prt::leave_obstacles(rays_, scene_.settings.bias, own, rim_step);
        own.lifts.resize(own.num_vertices(), glm::vec3(0.0f));
        set_lifts(vertices, near, own.lifts, free);
        const std::vector<glm::vec3> positions = vertex_receivers(own, rim_step).positions;
        if (on_vertices(scene_.layout)) {
            for (std::size_t i = 0; i < vertices.size(); ++i)
                if (near[vertices[i]])
                    move(vertices[i], positions[i]);
            return;
        }
        std::vector<std::uint32_t> index(scene_.mesh.num_vertices());
        for (std::size_t i = 0; i < vertices.size(); ++i)
            index[vertices[i]] = static_cast<std::uint32_t>(i);
        for (std::size_t i = scene_.receivers.num_own(); i < scene_.receivers.size(); ++i) {
            const MeshPoint& point = scene_.receivers.points[i];
            const std::uint32_t vertex = vertex_at(scene_.mesh, point);
            if (near[vertex] && !is_away_[scene_.mesh.triangle_groups[point.triangle]])
                move(static_cast<std::uint32_t>(i), positions[index[vertex]]);
        }
    }

    /// Gives vertices near the group their lifts. `free` are those that nothing is in the way of.
    void set_lifts(const std::vector<std::uint32_t>& vertices, const std::vector<bool>& near,
                   const std::vector<glm::vec3>& lifts, const std::vector<glm::vec3>& free) {
        std::vector<std::size_t> others;
        for (std::size_t i = 0; i < vertices.size(); ++i)
            if (near[vertices[i]] && lifts[i] != lift_of(vertices[i]))
                others.push_back(i);
        if (others.empty())
            return;
        remember_free_lifts(others, vertices, lifts, free);
        std::vector<std::uint32_t> own(change_.lifted);
        // What the change has of the group's vertices is there already.
        if (change_.lifts.empty())
            change_.lifts.resize(own.size(), glm::vec3(0.0f));
        scene_.mesh.lifts.resize(scene_.mesh.num_vertices(), glm::vec3(0.0f));
        for (const std::size_t i : others) {
            const std::uint32_t vertex = vertices[i];
            if (!std::ranges::binary_search(own, vertex)) {
                change_.lifted.push_back(vertex);
                change_.lifts.push_back(scene_.mesh.lifts[vertex]);
                if (!change_.free_lifts.empty())
                    change_.free_lifts.push_back(scene_.free_lifts[vertex]);
            }
            scene_.mesh.lifts[vertex] = lifts[i];
        }
    }

    /// Keeps the free lifts of all vertices where one would be lost.
    void remember_free_lifts(const std::vector<std::size_t>& others,
                             const std::vector<std::uint32_t>& vertices,
                             const std::vector<glm::vec3>& lifts,
                             const std::vector<glm::vec3>& free) {
        if (!scene_.free_lifts.empty() || std::ranges::all_of(others, [&](std::size_t i) {
                return free_lift(lifts[i], scene_.mesh.normals[vertices[i]]) == free[i];
            }))
            return;
        std::vector<glm::vec3> all;
        for (std::uint32_t vertex = 0; vertex < scene_.mesh.num_vertices(); ++vertex)
            all.push_back(free_lift_of(vertex));
        scene_.free_lifts = std::move(all);
        // The group's own, before it moved.
        for (std::size_t i = 0; i < change_.lifted.size(); ++i)
            change_.free_lifts.push_back(free_lift(change_.lifts[i], change_.normals[i]));
    }

    void leave_by_texels() {
        const Receivers& all = scene_.receivers;
        Receivers own;
        std::vector<std::uint32_t> chosen;
        for (std::uint32_t i = 0; i < all.num_own(); ++i) {
            const MeshPoint& point = all.points[i];
            if (is_away_[scene_.mesh.triangle_groups[point.triangle]])
                continue;
            const glm::vec3 place = value_at(scene_.mesh, scene_.mesh.positions, point);
            const glm::vec3 smooth = smooth_position(scene_.mesh, point);
            if (!is_near(place, glm::distance(place, smooth)))
                continue;
            chosen.push_back(i);
            own.positions.push_back(smooth);
            own.normals.push_back(all.normals[i]);
            own.points.push_back(point);
        }
        prt::leave_obstacles(scene_.mesh, rays_, scene_.settings.bias, own);
        for (std::size_t i = 0; i < chosen.size(); ++i)
            move(chosen[i], own.positions[i]);
    }

    /// Takes a receiver to another place, and keeps the one before in the change.
    void move(std::uint32_t receiver, const glm::vec3& position) {
        glm::vec3& own = scene_.receivers.positions[receiver];
        if (own == position)
            return;
        if (!change_.difference.receivers[receiver])
            moved_.push_back({receiver, own, scene_.receivers.normals[receiver]});
        own = position;
    }

    /// Adds what moved to the receivers that differ.
    void add_receivers() {
        std::vector<Before> all = std::move(moved_);
        for (std::size_t i = 0; i < change_.receivers.size(); ++i)
            all.push_back(
                {change_.receivers[i], change_.receiver_positions[i], change_.receiver_normals[i]});
        std::ranges::sort(all, {}, &Before::receiver);
        change_.receivers.clear();
        change_.receiver_positions.clear();
        change_.receiver_normals.clear();
        for (const Before& own : all) {
            change_.receivers.push_back(own.receiver);
            change_.receiver_positions.push_back(own.position);
            change_.receiver_normals.push_back(own.normal);
            change_.difference.receivers[own.receiver] = true;
        }
        set_places(scene_, change_);
    }

    Scene& scene_;
    const RayScene& rays_;
    SceneChange& change_;
    std::vector<bool> is_away_;
    struct Before {
        std::uint32_t receiver;
        glm::vec3 position, normal;
    };
    /// Receivers that the change has not yet
    std::vector<Before> moved_;
};

} // namespace

void leave_new_obstacles(Scene& scene, const RayScene& rays, SceneChange& change) {
    NewObstacles(scene, rays, change).leave();
}

} // namespace relumine::prt
