#include "prt/visibility/see_through.h"

#include <algorithm>

#include "mesh/opacity.h"

namespace relumine::prt {

SeeThrough::SeeThrough(const mesh::TriangleMesh& mesh) {
    if (mesh.triangle_materials.empty() ||
        std::none_of(mesh.materials.begin(), mesh.materials.end(), mesh::lets_eye_pass))
        return;
    for (const std::uint32_t i : mesh.triangle_materials) {
        const mesh::Material& material = mesh.materials[i];
        kinds_.push_back(static_cast<std::uint8_t>((material.is_double_sided ? 0 : OneSided) |
                                                   (lets_light_pass(material) ? PassesLight : 0)));
    }
    if (!mesh::lets_light_pass(mesh))
        return;
    mesh_ = mesh::blockers_of(mesh);
    mesh_.positions = {};
}

float SeeThrough::opacity(std::uint32_t triangle, const glm::vec2& barycentric) const {
    return may_pass(triangle, RayOf::Light) ? mesh::opacity(mesh_, triangle, barycentric) : 1.0f;
}

bool SeeThrough::passes(const Meeting& meeting, RayOf of) const {
    if (of == RayOf::Eye && meeting.is_back && (kinds_[meeting.triangle] & OneSided) != 0)
        return true;
    return opacity(meeting.triangle, meeting.barycentric) <= 0.0f;
}

} // namespace relumine::prt
