// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights", Section
//           3.1: for image relighting the points are the ones seen in the pixels.
#include "prt/receivers/pixel_receivers.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/receivers/pixel_samples.h"
#include "prt/receivers/reflecting_normal.h"

namespace relumine::prt {

namespace {

bool has_highlight(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    return material.model != mesh::MaterialModel::Phong || material.specular != glm::vec3(0.0f);
}

/// Returns the normal of a normal map on the side of the receiver's normal.
glm::vec3 mapped_towards(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                         const glm::vec3& normal, bool is_front, const glm::vec3& to_eye) {
    if (mesh.corner_tangents.empty())
        return normal;
    const glm::vec3 mapped = (is_front ? 1.0f : -1.0f) * mapped_normal(mesh, point);
    if (mapped == normal || !has_highlight(mesh, point.triangle))
        return mapped;
    return glm::normalize(reflecting_outwards(mapped, normal, to_eye));
}

/// Returns the normal on the eye's side of the surface.
glm::vec3 normal_towards(const mesh::TriangleMesh& mesh, const MeshPoint& point,
                         const glm::vec3& to_eye) {
    const glm::vec3 normal = shading_normal(mesh, point);
    glm::vec3 face = face_normal(mesh, point.triangle);
    if (glm::dot(face, normal) < 0.0f)
        face = -face;
    return glm::dot(face, to_eye) < 0.0f ? -normal : normal;
}

/// Writes the receiver of what a sample sees to its place.
void place_receiver(const mesh::TriangleMesh& mesh, const glm::vec3& eye, const SeenSurface& seen,
                    std::size_t place, Receivers& receivers) {
    const glm::vec3 position = value_at(mesh, mesh.positions, seen.point);
    // A hit at the eye itself has no direction to the eye. It takes its normal.
    const glm::vec3 way = eye - position;
    const glm::vec3 to_eye =
        glm::length(way) > 0.0f ? glm::normalize(way) : face_normal(mesh, seen.point.triangle);
    const glm::vec3 normal = normal_towards(mesh, seen.point, to_eye);
    // The smooth surface is before the facets as seen from its front.
    const bool is_front = normal == shading_normal(mesh, seen.point);
    receivers.positions[place] = is_front ? smooth_position(mesh, seen.point) : position;
    receivers.normals[place] = mapped_towards(mesh, seen.point, normal, is_front, to_eye);
    receivers.to_eye[place] = to_eye;
    receivers.points[place] = seen.point;
    receivers.veils[place] = seen.veil;
}

} // namespace

PixelReceivers pixel_receivers(const mesh::TriangleMesh& mesh, const RayScene& rays,
                               const PixelView& view, const Work& work) {
    PixelReceivers result{.receivers = {},
                          .layout = {.camera = view.camera,
                                     .width = view.width,
                                     .height = view.height,
                                     .samples_per_axis = view.samples_per_axis.value_or(
                                         PixelLayout::EdgeSamplesPerAxis)}};
    if (result.layout.num_samples() > MaxLayoutPlaces)
        throw std::invalid_argument(fmt::format("expected at most {} samples in all, got {}",
                                                MaxLayoutPlaces, result.layout.num_samples()));

    const std::vector<std::vector<SeenSurface>> rows = seen_rows(mesh, rays, view, work);
    std::vector<std::size_t> first(rows.size() + 1, 0);
    for (std::size_t y = 0; y < rows.size(); ++y)
        first[y + 1] = first[y] + rows[y].size();
    if (first.back() == 0)
        throw std::invalid_argument(
            "expected a view that sees the mesh, got one that sees nothing of it");
    Receivers& receivers = result.receivers;
    receivers.positions.resize(first.back());
    receivers.normals.resize(first.back());
    receivers.to_eye.resize(first.back());
    receivers.points.resize(first.back());
    receivers.veils.resize(first.back());
    result.layout.samples.resize(first.back());
    if (!view.samples_per_axis) {
        result.layout.shares.resize(first.back());
        receivers.normal_spread.resize(first.back());
    }
    files::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t y) {
        std::size_t receiver = first[y];
        for (const SeenSurface& seen : rows[y]) {
            place_receiver(mesh, view.camera.eye, seen, receiver, receivers);
            if (!view.samples_per_axis) {
                result.layout.shares[receiver] = seen.share;
                receivers.normal_spread[receiver] = seen.normal_spread;
            }
            result.layout.samples[receiver++] = seen.sample;
        }
    });
    if (std::all_of(receivers.veils.begin(), receivers.veils.end(),
                    [](const mesh::Veil& veil) { return veil == mesh::Veil(); }))
        receivers.veils.clear();
    return result;
}

} // namespace relumine::prt
