#include "mesh/up_axis.h"

#include <glm/geometric.hpp>

namespace relumine::mesh {

namespace {

template<typename Vector>
Vector turned(const Vector& v, UpAxis axis) {
    return axis == UpAxis::Y   ? v
           : axis == UpAxis::Z ? Vector(v.x, v.z, -v.y)
                               : Vector(-v.y, v.x, v.z);
}

} // namespace

void turn_up(TriangleMesh& mesh, UpAxis axis) {
    if (axis == UpAxis::Y)
        return;
    for (std::vector<glm::vec3>* vectors : {&mesh.positions, &mesh.normals})
        for (glm::vec3& v : *vectors)
            v = turned(v, axis);
    mesh.offset = turned(mesh.offset, axis);
    for (PunctualLight& light : mesh.lights) {
        light.position = turned(light.position, axis);
        for (glm::vec3* v : {&light.direction, &light.right, &light.up})
            *v = turned(*v, axis);
    }
}

void turn_up(Camera& camera, UpAxis axis) {
    if (axis == UpAxis::Y)
        return;
    const glm::vec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::vec3 up = rolled_axes(forward, camera.roll_degrees).up;
    camera.eye = turned(camera.eye, axis);
    camera.target = turned(camera.target, axis);
    camera.roll_degrees = roll_of(turned(forward, axis), turned(up, axis));
}

} // namespace relumine::mesh
