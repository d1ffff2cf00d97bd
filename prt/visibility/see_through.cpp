#include "prt/visibility/see_through.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "cubemap/face.h"
#include "cubemap/split_mix64.h"

namespace relumine::prt {

namespace {

/// Returns a number in [0, 1) for a ray and a triangle.
///
/// Over the directions from one place it is an additive recurrence: M. Roberts' R2 sequence on the
/// lattice of a cube face of 2048 cells. Steps of any number of cells spread evenly, so a few
/// neighbouring rays pass by nearly the right part. Places start anywhere, and triangles have
/// lattices of their own, so that light behind two surfaces has the product of both parts.
double chance(const SeeThrough::Meeting& meeting) {
    constexpr double Cells = 2048.0, StepX = 0.7548776662466927, StepY = 0.5698402909980532;
    std::uint64_t seed = meeting.triangle;
    const std::uint64_t of_triangle = cubemap::SplitMix64(seed).next();
    for (int axis = 0; axis < 3; ++axis)
        seed =
            cubemap::SplitMix64(seed ^ std::bit_cast<std::uint32_t>(meeting.origin[axis])).next();
    const cubemap::FacePoint at = cubemap::face_point(glm::dvec3(meeting.direction));
    const double x = Cells * at.s * static_cast<double>(1 + of_triangle % 16);
    const double y = Cells * at.t * static_cast<double>(1 + of_triangle / 16 % 16);
    const double place = cubemap::unit_interval(seed) + StepX * x + StepY * y;
    return place - std::floor(place);
}

} // namespace

SeeThrough::SeeThrough(const mesh::TriangleMesh& mesh) {
    if (mesh.triangle_materials.empty() ||
        std::none_of(mesh.materials.begin(), mesh.materials.end(), mesh::lets_eye_pass))
        return;
    for (const std::uint32_t i : mesh.triangle_materials) {
        const mesh::Material& material = mesh.materials[i];
        has_thin_ = has_thin_ || mesh::is_thin(material);
        kinds_.push_back(static_cast<std::uint8_t>((material.is_double_sided ? 0 : OneSided) |
                                                   (lets_light_pass(material) ? PassesLight : 0) |
                                                   (mesh::is_thin(material) ? Thin : 0)));
    }
    if (!mesh::lets_light_pass(mesh))
        return;
    mesh_ = mesh::blockers_of(mesh);
    mesh_.positions = {};
}

mesh::Veil SeeThrough::veil(std::uint32_t triangle, const glm::vec2& barycentric) const {
    return may_pass(triangle, RayOf::Light) ? mesh::veil(mesh_, triangle, barycentric)
                                            : mesh::Veil();
}

bool SeeThrough::passes(const Meeting& meeting, RayOf of) const {
    if (of == RayOf::Eye && meeting.is_back && (kinds_[meeting.triangle] & OneSided) != 0)
        return true;
    const mesh::Veil own = veil(meeting.triangle, meeting.barycentric);
    if (of == RayOf::Eye)
        return own == mesh::Veil{.weight = 0.0f, .through = glm::vec3(1.0f)};
    const float part = (own.through.r + own.through.g + own.through.b) / 3.0f;
    if (of == RayOf::SettledLight)
        return part >= 0.5f;
    return part > 0.0f && (part >= 1.0f || chance(meeting) < static_cast<double>(part));
}

} // namespace relumine::prt
