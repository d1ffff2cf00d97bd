#include "mesh/up_axis.h"

namespace relumine::mesh {

namespace {

glm::vec3 turned(const glm::vec3& v, UpAxis axis) {
    return axis == UpAxis::Y   ? v
           : axis == UpAxis::Z ? glm::vec3(v.x, v.z, -v.y)
                               : glm::vec3(-v.y, v.x, v.z);
}

} // namespace

void turn_up(TriangleMesh& mesh, UpAxis axis) {
    if (axis == UpAxis::Y)
        return;
    for (std::vector<glm::vec3>* vectors : {&mesh.positions, &mesh.normals})
        for (glm::vec3& v : *vectors)
            v = turned(v, axis);
    for (PunctualLight& light : mesh.lights) {
        light.position = turned(light.position, axis);
        light.direction = turned(light.direction, axis);
    }
}

void turn_up(Camera& camera, UpAxis axis) {
    camera.eye = turned(camera.eye, axis);
    camera.target = turned(camera.target, axis);
}

} // namespace relumine::mesh
