#include "mesh/up_axis.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace relumine::mesh {

UpAxis customary_up(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".stl" ? UpAxis::Z : UpAxis::Y;
}

void turn_up(TriangleMesh& mesh, UpAxis axis) {
    if (axis == UpAxis::Y)
        return;
    for (std::vector<glm::vec3>* vectors : {&mesh.positions, &mesh.normals})
        for (glm::vec3& v : *vectors)
            v = axis == UpAxis::Z ? glm::vec3(v.x, v.z, -v.y) : glm::vec3(-v.y, v.x, v.z);
}

} // namespace relumine::mesh
