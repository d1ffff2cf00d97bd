#include "prt/receivers.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

/// Spreads the lower 21 bits of x so that two zero bits follow each.
std::uint64_t spread_bits(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    x = (x | x << 2) & 0x1249249249249249;
    return x;
}

} // namespace

Receivers vertex_receivers(const mesh::TriangleMesh& mesh) {
    return {.positions = mesh.positions, .normals = mesh.normals};
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

void look_from(Receivers& receivers, const glm::vec3& eye) {
    receivers.to_eye.clear();
    for (const glm::vec3& position : receivers.positions) {
        const glm::vec3 to_eye = eye - position;
        const float distance = glm::length(to_eye);
        receivers.to_eye.push_back(distance > 0.0f ? to_eye / distance : glm::vec3(0.0f, 1.0f, 0.0f));
    }
}

std::vector<std::uint32_t> spatial_order(const Receivers& receivers) {
    glm::dvec3 low(std::numeric_limits<double>::max());
    glm::dvec3 high(std::numeric_limits<double>::lowest());
    for (const glm::vec3& position : receivers.positions) {
        low = glm::min(low, glm::dvec3(position));
        high = glm::max(high, glm::dvec3(position));
    }
    // One scale for all axes keeps the grid's cells cubes.
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-300});
    const double scale = 2097151.0 / extent;

    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(receivers.size());
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        const glm::dvec3 cell = (glm::dvec3(receivers.positions[i]) - low) * scale;
        const std::uint64_t morton = spread_bits(static_cast<std::uint64_t>(cell.x)) |
                                     spread_bits(static_cast<std::uint64_t>(cell.y)) << 1 |
                                     spread_bits(static_cast<std::uint64_t>(cell.z)) << 2;
        const bool receives_nothing = receivers.normals[i] == glm::vec3(0.0f);
        keys[i] = {morton | static_cast<std::uint64_t>(receives_nothing) << 63, i};
    }
    std::sort(keys.begin(), keys.end());

    std::vector<std::uint32_t> order(keys.size());
    std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& key) { return key.second; });
    return order;
}

} // namespace relumine::prt
