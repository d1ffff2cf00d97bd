#include "prt/scene/absent_groups.h"

#include <utility>

namespace relumine::prt {

namespace {

std::vector<mesh::Triangle> whole(const Scene& scene, const mesh::TriangleMesh& mesh,
                                  std::vector<mesh::Triangle> AbsentGroup::* own) {
    std::vector<mesh::Triangle> result = mesh.triangles;
    for (const AbsentGroup& group : scene.absent) {
        const std::vector<std::uint32_t> numbers = triangles_of(mesh, group.group);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            result[numbers[i]] = (group.*own)[i];
    }
    return result;
}

/// Returns what the triangles were.
std::vector<mesh::Triangle> take_away(mesh::TriangleMesh& mesh, std::uint32_t group) {
    std::vector<mesh::Triangle> result;
    for (const std::uint32_t i : triangles_of(mesh, group))
        result.push_back(std::exchange(mesh.triangles[i], away(mesh.triangles[i])));
    return result;
}

} // namespace

const AbsentGroup* absent(const Scene& scene, std::uint32_t group) {
    for (const AbsentGroup& own : scene.absent)
        if (own.group == group)
            return &own;
    return nullptr;
}

std::vector<std::string> absent_names(const Scene& scene) {
    std::vector<std::string> result;
    for (const AbsentGroup& own : scene.absent)
        result.push_back(scene.mesh.groups[own.group]);
    return result;
}

std::vector<std::uint32_t> triangles_of(const mesh::TriangleMesh& mesh, std::uint32_t group) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < mesh.triangle_groups.size(); ++i)
        if (mesh.triangle_groups[i] == group)
            result.push_back(i);
    return result;
}

std::vector<mesh::Triangle> whole_mesh(const Scene& scene) {
    return whole(scene, scene.mesh, &AbsentGroup::triangles);
}

std::vector<mesh::Triangle> whole_blockers(const Scene& scene) {
    return whole(scene, *scene.blockers, &AbsentGroup::blockers);
}

void take_away(Scene& scene, AbsentGroup& own) {
    own.triangles = take_away(scene.mesh, own.group);
    if (scene.blockers)
        own.blockers = take_away(*scene.blockers, own.group);
}

} // namespace relumine::prt
