#include "prt/refinement/lit_surface.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/subject.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/mesh_point.h"
#include "prt/refinement/large_triangles.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

using mesh::SplitMesh;

/// Parts of the mesh's diagonal. What is narrower than an edge may hide between its ends, so
/// middles of edges are asked in all directions. Along edges shorter than this, whose ends face
/// alike, they are asked only in directions on which the ends do not agree: few on a fine mesh.
constexpr float FineEdge = 1.0f / 256.0f;
constexpr float LeastCosineOfAlike = 0.97f;

/// The largest part of the way to the triangle's centre that a point on a rim moves inside. It
/// moves by automatic_bias() where that is less, as in vertex_receivers().
constexpr float LargestPartOfWay = 0.25f;

/// Parts of automatic_bias(). Smaller lifts are none.
constexpr float LeastLift = 0.25f;

/// Returns which triangles show light, and are coarse for an edge if there is one.
std::vector<bool> triangles_to_refine(const mesh::TriangleMesh& mesh, std::optional<float> edge) {
    std::vector<bool> result;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        result.push_back(shows_light(mesh, i) &&
                         (!edge || longest_side(mesh, mesh.triangles[i]) > *edge));
    return result;
}

mesh::TriangleMesh without_lifts(mesh::TriangleMesh mesh) {
    mesh.lifts.clear();
    return mesh;
}

} // namespace

LitSurface::LitSurface(const mesh::TriangleMesh& base, const Blockers& blockers,
                       const RefineOptions& options, const Progress& progress)
    : base_(base), blockers_(blockers), options_(options), progress_(progress),
      split_(without_lifts(base)), directions_(options.light ? &*options.light : nullptr),
      step_(automatic_bias(base)), bias_(options.bias.value_or(step_)),
      fine_(FineEdge * mesh::scale(base)), is_curved_(options.curved),
      is_refined_(triangles_to_refine(base, options.coarse_edge)), lifts_(base.lifts) {}

void LitSurface::trace_vertices() {
    lift_new_vertices();
    Receivers all = vertex_receivers(mesh());
    for (std::size_t vertex = 0; vertex < all.size(); ++vertex)
        all.positions[vertex] += lifts_[vertex];
    is_traced_.resize(all.size());
    vertex_bits_.resize(all.size());
    vertex_lamps_.resize(all.size(), 0.0f);
    std::vector<Neighbours> ends_of(all.size());
    for (const SplitMesh::Middle& middle : split_.new_vertices())
        if (is_traced_[middle.low] && is_traced_[middle.high])
            ends_of[middle.vertex] = neighbours(middle.low, middle.high);
    const std::vector<std::uint32_t> vertices = vertices_to_trace();
    Receivers added;
    std::vector<Neighbours> ends;
    for (const std::uint32_t vertex : vertices) {
        added.positions.push_back(all.positions[vertex]);
        added.normals.push_back(all.normals[vertex]);
        ends.push_back(ends_of[vertex]);
    }
    const std::vector<Bits> bits = trace(added, ends);
    const std::vector<float> lamps = lamps_at(added);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        vertex_bits_[vertices[i]] = bits[i];
        vertex_lamps_[vertices[i]] = lamps[i];
    }
}

/// Marks the vertices of changed triangles as traced, and returns those that were not yet.
std::vector<std::uint32_t> LitSurface::vertices_to_trace() {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t triangle : split_.changed_triangles())
        if (is_refined_[split_.origin(triangle).triangle])
            for (const std::uint32_t vertex : mesh().triangles[triangle])
                if (!is_traced_[vertex]) {
                    is_traced_[vertex] = true;
                    vertices.push_back(vertex);
                }
    return vertices;
}

/// Finds the smooth surface over new vertices: where the triangles beside one do not agree, the
/// highest.
void LitSurface::lift_new_vertices() {
    lifts_.resize(mesh().num_vertices(), glm::vec3(0.0f));
    if (is_curved_)
        return;
    std::vector<bool> is_new(mesh().num_vertices());
    for (const SplitMesh::Middle& middle : split_.new_vertices())
        is_new[middle.vertex] = true;
    for (const std::uint32_t triangle : split_.changed_triangles())
        for (std::size_t k = 0; k < 3; ++k) {
            std::array<float, 3> weights{};
            weights[k] = 1.0f;
            glm::vec3& own = lifts_[mesh().triangles[triangle][k]];
            if (const glm::vec3 lift = lift_at(triangle, weights);
                is_new[mesh().triangles[triangle][k]] && glm::length(lift) > glm::length(own))
                own = lift;
        }
}

/// Returns how far the smooth surface lies above a point of a triangle.
glm::vec3 LitSurface::lift_at(std::uint32_t triangle, const std::array<float, 3>& weights) const {
    const SplitMesh::Origin& origin = split_.origin(triangle);
    const MeshPoint point{.triangle = origin.triangle,
                          .barycentric = weights[0] * origin.corners[0] +
                                         weights[1] * origin.corners[1] +
                                         weights[2] * origin.corners[2]};
    const glm::vec3 lift = smooth_position(base_, point) - value_at(base_, base_.positions, point);
    // Of a flat triangle it is rounding.
    return glm::length(lift) > LeastLift * step_ ? lift : glm::vec3(0.0f);
}

LitSurface::Neighbours LitSurface::neighbours(std::uint32_t low, std::uint32_t high) const {
    if (glm::distance(mesh().positions[low], mesh().positions[high]) > fine_ ||
        glm::dot(mesh().normals[low], mesh().normals[high]) < LeastCosineOfAlike)
        return {};
    return {&vertex_bits_[low], &vertex_bits_[high]};
}

void LitSurface::add_mean(std::span<const std::uint32_t> vertices, std::span<const float> weights,
                          Receivers& receivers) const {
    glm::dvec3 position(0.0), normal(0.0);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const double weight = double{weights[i]};
        position += weight * glm::dvec3(mesh().positions[vertices[i]]);
        normal += weight * glm::dvec3(mesh().normals[vertices[i]]);
    }
    const double length = glm::length(normal);
    constexpr double Shortest = 1e-4;
    receivers.positions.emplace_back(position);
    receivers.normals.push_back(length > Shortest ? glm::vec3(normal / length)
                                                  : mesh().normals[vertices.front()]);
}

void LitSurface::add_inside(std::uint32_t triangle, const std::array<float, 3>& weights,
                            Receivers& receivers) const {
    add_mean(mesh().triangles[triangle], weights, receivers);
    if (!is_curved_)
        receivers.positions.back() += lift_at(triangle, weights);
}

void LitSurface::add_middle(const SplitMesh::Ends& ends, Receivers& receivers) const {
    const mesh::Triangle& corners = mesh().triangles[ends.triangle];
    std::array<float, 3> weights{};
    for (std::size_t k = 0; k < 3; ++k)
        weights[k] = corners[k] == ends.low || corners[k] == ends.high ? 0.5f : 0.0f;
    add_inside(ends.triangle, weights, receivers);
    if (ends.is_rim)
        move_inside(ends.triangle, receivers.positions.back());
}

void LitSurface::move_inside(std::uint32_t triangle, glm::vec3& position) const {
    const mesh::Triangle& corners = mesh().triangles[triangle];
    const std::vector<glm::vec3>& positions = mesh().positions;
    const glm::vec3 way =
        (positions[corners[0]] + positions[corners[1]] + positions[corners[2]]) / 3.0f - position;
    if (const float length = glm::length(way); length > 0.0f)
        position += std::min(step_ / length, LargestPartOfWay) * way;
}

std::vector<LitSurface::Bits> LitSurface::trace(const Receivers& receivers,
                                                std::span<const Neighbours> neighbours) {
    num_points_ += receivers.size();
    return directions_.trace(receivers, blockers_, bias_, progress_, neighbours);
}

std::vector<float> LitSurface::lamps_at(const Receivers& receivers) {
    if (!options_.lamps || receivers.size() == 0)
        return std::vector<float>(receivers.size());
    progress_.poll();
    std::vector<float> result = options_.lamps(receivers);
    if (mean_of_lamps_ == 0.0f)
        mean_of_lamps_ =
            std::accumulate(result.begin(), result.end(), 0.0f) / static_cast<float>(result.size());
    if (mean_of_lamps_ > 0.0f)
        for (float& light : result)
            light /= mean_of_lamps_;
    return result;
}

mesh::TriangleMesh LitSurface::take() {
    mesh::TriangleMesh mesh = split_.take();
    if (std::any_of(lifts_.begin(), lifts_.end(),
                    [](const glm::vec3& lift) { return lift != glm::vec3(0.0f); }))
        mesh.lifts = std::move(lifts_);
    return mesh;
}

} // namespace relumine::prt
