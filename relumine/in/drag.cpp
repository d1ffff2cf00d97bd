#include "relumine/in/drag.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "files/seconds.h"
#include "prt/moves/new_obstacles.h"

namespace relumine {

namespace {

mesh::TriangleMesh& blocking_mesh(Scene& scene) {
    return scene.blockers ? *scene.blockers : scene.mesh;
}

/// Returns the triangles of a group by themselves. `vertices` are theirs, ascending.
mesh::TriangleMesh only(const mesh::TriangleMesh& mesh, std::uint32_t group,
                        const std::vector<std::uint32_t>& vertices) {
    mesh::TriangleMesh result = mesh;
    const auto keep = [&](auto& of_triangles) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < of_triangles.size(); ++i)
            if (mesh.triangle_groups[i] == group)
                of_triangles[count++] = of_triangles[i];
        of_triangles.resize(count);
    };
    keep(result.triangles);
    keep(result.corner_uvs);
    keep(result.corner_tangents);
    keep(result.triangle_materials);
    keep(result.triangle_groups);
    mesh::for_each_vertex_array(result, [&](auto& of_vertices) {
        for (std::size_t i = 0; i < vertices.size() && !of_vertices.empty(); ++i)
            of_vertices[i] = of_vertices[vertices[i]];
        of_vertices.resize(std::min(of_vertices.size(), vertices.size()));
    });
    for (mesh::Triangle& triangle : result.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex = static_cast<std::uint32_t>(std::ranges::lower_bound(vertices, vertex) -
                                                vertices.begin());
    return result;
}

prt::RecountOptions options_of(const Scene& scene, prt::Recounted blocks,
                               std::vector<bool> coarse = {}) {
    return {.face_resolution = scene.settings.face_resolution,
            .bias = scene.settings.bias,
            .coarse = std::move(coarse),
            .blocks = blocks};
}

prt::SceneChange dragged(const Scene& scene, const GroupMove& to) {
    if (to.going != Going::To)
        throw std::invalid_argument("expected a place to drag a group to");
    return prt::moved(scene, group_named(scene, to.name), to.matrix);
}

} // namespace

GroupDrag::GroupDrag(Scene& scene, SceneRays& rays, const GroupMove& to)
    : GroupDrag(scene, rays, to, dragged(scene, to)) {}

GroupDrag::GroupDrag(Scene& scene, SceneRays& rays, const GroupMove& to, prt::SceneChange first)
    : scene_(scene), rays_(rays), group_(first.groups.front()),
      group_of_blockers_(
          static_cast<std::uint32_t>(std::ranges::find(scene.blocking_mesh().groups, to.name) -
                                     scene.blocking_mesh().groups.begin())),
      vertices_(std::move(scene.blockers ? first.blocker_vertices : first.vertices)),
      mesh_(only(scene.blocking_mesh(), group_of_blockers_, vertices_)),
      own_rays_(mesh_, prt::RayScene::Packets::Narrow, prt::RayScene::Groups::Move),
      own_beams_(mesh_, own_rays_), receivers_(std::move(first.difference.receivers)) {
    count_without();
}

/// Counts the receivers of other groups while this one is shrunk to a point, which blocks nothing.
void GroupDrag::count_without() {
    without_.difference = {.boxes = prt::boxes_around(mesh_), .receivers = receivers_};
    std::vector<glm::vec3>& positions = blocking_mesh(scene_).positions;
    for (const std::uint32_t vertex : vertices_)
        positions[vertex] = positions[vertices_.front()];
    rays_.follow(group_);
    without_.counts =
        prt::recounted(scene_.receivers, rays_.beams(), scene_.transfer, without_.difference,
                       options_of(scene_, prt::Recounted::Still));
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        positions[vertices_[i]] = mesh_.positions[i];
    rays_.follow(group_);
    prt::exchange(scene_.transfer.counts, without_.counts);
}

/// Takes the last place back, or brings it again.
void GroupDrag::exchange() {
    if (change_)
        prt::exchange(scene_, *change_);
}

prt::SceneChange GroupDrag::to(const glm::dmat4& matrix, std::vector<bool> coarse,
                               MoveReport& report) {
    const auto start = std::chrono::steady_clock::now();
    exchange();
    prt::SceneChange next;
    try {
        next = prt::moved(scene_, group_, matrix);
    } catch (...) {
        exchange();
        throw;
    }
    report.num_moved = next.receivers.size();
    prt::exchange(scene_, next);
    rays_.follow(group_);
    prt::leave_new_obstacles(scene_, rays_.blockers(), next);
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        mesh_.positions[i] = blocking_mesh(scene_).positions[vertices_[i]];
    if (!mesh_.triangles.empty()) {
        own_rays_.follow(mesh_, group_of_blockers_);
        own_beams_.follow(mesh_, group_of_blockers_);
    }

    prt::SceneDifference counted{.boxes = prt::boxes_around(mesh_), .receivers = receivers_};
    for (const std::uint32_t receiver : next.receivers)
        counted.receivers[receiver] = true;
    prt::RecountStatistics of_group;
    next.counts =
        prt::recounted(scene_.receivers, rays_.beams(), scene_.transfer, counted,
                       options_of(scene_, prt::Recounted::Differing, coarse), {}, &of_group);
    next.counts.append(prt::recounted(
        scene_.receivers, own_beams_, scene_.transfer, counted,
        options_of(scene_, prt::Recounted::Covered, std::move(coarse)), {}, &report.counts));
    next.counts.sort();
    prt::exchange(scene_.transfer.counts, next.counts);
    const prt::SceneChange outline = prt::outline(change_ ? *change_ : without_, next);
    change_ = std::move(next);
    report.num_all =
        std::uint64_t{scene_.transfer.counts.num_blocks()} * scene_.transfer.counts.num_leaves;
    report.counts.num_pairs += of_group.num_pairs;
    report.counts.num_changed += of_group.num_changed;
    report.counts.num_rays += of_group.num_rays;
    report.counts.seconds += of_group.seconds;
    report.seconds = files::seconds_since(start);
    return outline;
}

prt::SceneChange GroupDrag::back() {
    exchange();
    prt::exchange(scene_.transfer.counts, without_.counts);
    rays_.follow(group_);
    return change_ ? prt::outline(without_, *change_) : prt::outline(without_, {});
}

} // namespace relumine
