#include "prt/receivers/receivers.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "cubemap/split_mix64.h"
#include "prt/visibility/bias.h"

namespace relumine::prt {

namespace {

/// How far a vertex may move within its triangles, over the distance to their centres.
constexpr float LargestPartOfATriangle = 0.25f;

/// Whether each vertex is inside of its surface: its triangles close a ring around it. In a closed
/// ring every neighbour begins one edge and ends another, so marks of the neighbours cancel.
std::vector<bool> inner_vertices(const mesh::TriangleMesh& mesh) {
    std::vector<std::uint64_t> sums(mesh.num_vertices());
    const auto mark = [](std::uint32_t vertex) {
        return cubemap::SplitMix64(vertex).next();
    };
    for (const mesh::Triangle& triangle : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            sums[triangle[k]] += mark(triangle[(k + 1) % 3]) - mark(triangle[(k + 2) % 3]);
    std::vector<bool> result(sums.size());
    std::transform(sums.begin(), sums.end(), result.begin(),
                   [](std::uint64_t sum) { return sum == 0; });
    return result;
}

} // namespace

Receivers vertex_receivers(const mesh::TriangleMesh& mesh) {
    return vertex_receivers(mesh, automatic_bias(mesh));
}

Receivers vertex_receivers(const mesh::TriangleMesh& mesh, float rim_step) {
    Receivers receivers{.positions = mesh.positions, .normals = mesh.normals};
    for (std::size_t vertex = 0; vertex < mesh.lifts.size(); ++vertex)
        receivers.positions[vertex] += mesh.lifts[vertex];
    const std::vector<bool> is_inner = inner_vertices(mesh);
    if (std::find(is_inner.begin(), is_inner.end(), false) == is_inner.end())
        return receivers;
    // Where surfaces meet at an edge without sharing its vertices, a vertex of one lies in the
    // plane of the other, and would look past it. It looks from a little inside of its own surface.
    std::vector<glm::vec3> inwards(mesh.num_vertices(), glm::vec3(0.0f));
    std::vector<float> reach(mesh.num_vertices(), std::numeric_limits<float>::max());
    for (const mesh::Triangle& triangle : mesh.triangles) {
        const glm::vec3 centre = (mesh.positions[triangle[0]] + mesh.positions[triangle[1]] +
                                  mesh.positions[triangle[2]]) /
                                 3.0f;
        for (const std::uint32_t vertex : triangle)
            if (!is_inner[vertex]) {
                const glm::vec3 to_centre = centre - mesh.positions[vertex];
                const float distance = glm::length(to_centre);
                if (distance > 0.0f)
                    inwards[vertex] += to_centre / distance;
                reach[vertex] = std::min(reach[vertex], LargestPartOfATriangle * distance);
            }
    }
    for (std::size_t vertex = 0; vertex < is_inner.size(); ++vertex)
        if (const float length = glm::length(inwards[vertex]); length > 0.0f)
            receivers.positions[vertex] +=
                std::min(rim_step, reach[vertex]) / length * inwards[vertex];
    return receivers;
}

void leave_unlit_out(Receivers& receivers) {
    for (std::size_t i = 0; i < receivers.surfaces.size(); ++i) {
        const Surface& surface = receivers.surfaces[i];
        if (surface.albedo == glm::vec3(0.0f) && surface.highlight == Highlight::None &&
            surface.emission != glm::vec3(0.0f))
            receivers.normals[i] = glm::vec3(0.0f);
    }
}

void add_vertices(Receivers& receivers, const mesh::TriangleMesh& mesh) {
    const Receivers vertices = vertex_receivers(mesh);
    receivers.points.resize(receivers.size()); // points in space are not on the mesh
    std::vector<bool> is_added(mesh.num_vertices());
    for (std::uint32_t triangle = 0; triangle < mesh.num_triangles(); ++triangle)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh.triangles[triangle][corner];
            if (is_added[vertex])
                continue;
            is_added[vertex] = true;
            receivers.positions.push_back(vertices.positions[vertex]);
            receivers.normals.push_back(vertices.normals[vertex]);
            if (!receivers.own_positions.empty())
                receivers.own_positions.push_back(receivers.positions.back());
            receivers.points.push_back(
                {.triangle = triangle,
                 .barycentric = {corner == 1 ? 1.0f : 0.0f, corner == 2 ? 1.0f : 0.0f}});
            // Nobody looks at them, but a direction has a length.
            if (!receivers.to_eye.empty())
                receivers.to_eye.emplace_back(0.0f, 1.0f, 0.0f);
            ++receivers.num_added;
        }
}

Receivers sampled(const Receivers& receivers, std::span<const std::uint32_t> chosen) {
    Receivers sample;
    sample.have_no_surface = receivers.have_no_surface;
    for (const std::uint32_t receiver : chosen) {
        sample.positions.push_back(receivers.positions[receiver]);
        sample.normals.push_back(receivers.normals[receiver]);
        // To a plan, only vertices behind points differ from the receivers before them.
        if (receivers.have_no_surface && receiver >= receivers.num_own())
            ++sample.num_added;
    }
    return sample;
}

std::uint32_t vertex_at(const mesh::TriangleMesh& mesh, const MeshPoint& point) {
    const mesh::Triangle& corners = mesh.triangles[point.triangle];
    return corners[point.barycentric.x > 0.5f ? 1 : point.barycentric.y > 0.5f ? 2 : 0];
}

std::vector<glm::vec3> vertex_values(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                                     std::span<const glm::vec3> values) {
    if (receivers.points.empty())
        return {values.begin(), values.end()};
    std::vector<glm::vec3> result(mesh.num_vertices(), glm::vec3(0.0f));
    for (std::size_t i = receivers.num_own(); i < receivers.size(); ++i)
        result[vertex_at(mesh, receivers.points[i])] = values[i];
    return result;
}

std::vector<glm::vec3> colors_at(const mesh::TriangleMesh& mesh, const Receivers& receivers) {
    if (mesh.colors.empty())
        throw std::invalid_argument("expected a mesh with vertex colours, got one without");
    if (receivers.points.empty())
        return mesh.colors;
    std::vector<glm::vec3> colors(receivers.size());
    std::transform(receivers.points.begin(), receivers.points.end(), colors.begin(),
                   [&](const MeshPoint& point) { return value_at(mesh, mesh.colors, point); });
    return colors;
}

std::vector<EyeCosines> eye_cosines(const Receivers& receivers) {
    std::vector<EyeCosines> cosines(receivers.size());
    for (std::size_t i = 0; i < receivers.to_eye.size(); ++i)
        cosines[i] = {receivers.surfaces.empty() ? Surface() : receivers.surfaces[i],
                      receivers.normals[i], receivers.to_eye[i]};
    return cosines;
}

void look_from(Receivers& receivers, const glm::vec3& eye) {
    receivers.to_eye.clear();
    for (const glm::vec3& position : receivers.positions) {
        const glm::vec3 to_eye = eye - position;
        const float distance = glm::length(to_eye);
        receivers.to_eye.push_back(distance > 0.0f ? to_eye / distance
                                                   : glm::vec3(0.0f, 1.0f, 0.0f));
    }
}

} // namespace relumine::prt
