#include "prt/visibility/twin_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include <glm/geometric.hpp>

#include "cubemap/split_mix64.h"

namespace relumine::prt {

namespace {

/// Returns a normal of any length.
glm::vec3 normal_of(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const mesh::Triangle& corners = mesh.triangles[triangle];
    const glm::vec3& first = mesh.positions[corners[0]];
    return glm::cross(mesh.positions[corners[1]] - first, mesh.positions[corners[2]] - first);
}

} // namespace

Hit TwinTriangles::facing(const Hit& hit, const glm::vec3& direction) const {
    if (!(glm::dot(normal_of(mesh_, hit.triangle), direction) > 0.0f))
        return hit;
    return other_side(hit).value_or(hit);
}

std::optional<Hit> TwinTriangles::other_side(const Hit& hit) const {
    const std::optional<std::uint32_t> twin = twin_of(hit.triangle);
    if (!twin)
        return std::nullopt;
    const std::array<float, 3> weights = {1.0f - hit.barycentric.x - hit.barycentric.y,
                                          hit.barycentric.x, hit.barycentric.y};
    const mesh::Triangle& own = mesh_.triangles[hit.triangle];
    const auto weight_of = [&](std::uint32_t corner) {
        std::size_t k = 0;
        while (k < 2 && mesh_.positions[own[k]] != mesh_.positions[corner])
            ++k;
        return weights[k];
    };
    const mesh::Triangle& other = mesh_.triangles[*twin];
    return Hit{.triangle = *twin,
               .barycentric = {weight_of(other[1]), weight_of(other[2])},
               .distance = hit.distance};
}

std::uint64_t TwinTriangles::key_of(std::uint32_t triangle) const {
    std::uint64_t key = 0;
    for (const std::uint32_t corner : mesh_.triangles[triangle]) {
        // Zero has two signs, which are equal.
        const glm::vec3 position = mesh_.positions[corner] + 0.0f;
        std::uint64_t of_corner = 0;
        for (int axis = 0; axis < 3; ++axis)
            of_corner =
                cubemap::SplitMix64(of_corner ^ std::bit_cast<std::uint32_t>(position[axis]))
                    .next();
        key += of_corner;
    }
    return key;
}

std::optional<std::uint32_t> TwinTriangles::twin_of(std::uint32_t triangle) const {
    std::call_once(is_sorted_, [this] {
        by_key_.reserve(mesh_.num_triangles());
        for (std::uint32_t i = 0; i < mesh_.num_triangles(); ++i)
            by_key_.emplace_back(key_of(i), i);
        std::sort(by_key_.begin(), by_key_.end());
    });
    const mesh::Triangle& own = mesh_.triangles[triangle];
    const glm::vec3 normal = normal_of(mesh_, triangle);
    const auto is_corner = [&](std::uint32_t corner) {
        return std::any_of(own.begin(), own.end(), [&](std::uint32_t other) {
            return mesh_.positions[other] == mesh_.positions[corner];
        });
    };
    const std::uint64_t key = key_of(triangle);
    for (auto entry = std::lower_bound(by_key_.begin(), by_key_.end(), std::pair(key, 0u));
         entry != by_key_.end() && entry->first == key; ++entry) {
        const mesh::Triangle& other = mesh_.triangles[entry->second];
        if (std::all_of(other.begin(), other.end(), is_corner) &&
            glm::dot(normal_of(mesh_, entry->second), normal) < 0.0f)
            return entry->second;
    }
    return std::nullopt;
}

} // namespace relumine::prt
