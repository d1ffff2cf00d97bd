#include "mesh/up_axis.h"

#include "files/extension.h"

namespace relumine::mesh {

UpAxis customary_up(const std::filesystem::path& path) {
    return files::extension_of(path) == ".stl" ? UpAxis::Z : UpAxis::Y;
}

void turn_up(TriangleMesh& mesh, UpAxis axis) {
    if (axis == UpAxis::Y)
        return;
    for (std::vector<glm::vec3>* vectors : {&mesh.positions, &mesh.normals})
        for (glm::vec3& v : *vectors)
            v = axis == UpAxis::Z ? glm::vec3(v.x, v.z, -v.y) : glm::vec3(-v.y, v.x, v.z);
}

} // namespace relumine::mesh
