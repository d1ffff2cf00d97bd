// What gives light in a scene: surfaces that glow, and lights without a surface.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/materials/punctual_light.h"
#include "mesh/triangle_mesh.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine::prt {

/// A part of a triangle that glows evenly.
struct Emitter {
    std::uint32_t triangle = 0;
    /// 1: the whole triangle. The four parts of part p have the numbers 4 p to 4 p + 3: one at each
    /// corner and one in the middle, between the middles of the edges.
    std::uint32_t part = 1;
    /// Index into Lamps::groups.
    std::uint32_t group = 0;
    /// The mean over the part.
    glm::vec3 radiance{0.0f};

    bool operator==(const Emitter&) const = default;
};

struct Lamps {
    /// Names of the mesh's groups that glow; one without a name for a mesh without groups.
    std::vector<std::string> groups = {};
    /// Triangles in ascending order.
    std::vector<Emitter> emitters = {};
    std::vector<mesh::PunctualLight> lights = {};

    [[nodiscard]] bool empty() const { return emitters.empty() && lights.empty(); }
    /// Names of groups and lights, each once.
    [[nodiscard]] std::vector<std::string> names() const;
    bool operator==(const Lamps&) const = default;
};

/// Parts of parts of a triangle end at this number.
inline constexpr std::uint32_t LastPart = 4u * 4u * 4u * 4u * 4u;

/// Returns the corners of an emitter's part of its triangle.
[[nodiscard]] std::array<glm::dvec3, 3> corners_of(const mesh::TriangleMesh& mesh,
                                                   const Emitter& emitter);

/// Returns the side of an emitter that glows: its normal, of unit length, on the side of the
/// vertices' normals. Zero for a triangle without area.
[[nodiscard]] glm::dvec3 front_of(const mesh::TriangleMesh& mesh, std::uint32_t triangle);

/// Returns the lamps of a mesh. A triangle whose emission has a texture is cut into parts of up to
/// 1,024 texels, 256 parts at most. Parts that together have less than a thousandth of their
/// group's power are left out. Unlit surfaces show a colour and light nothing.
///
/// Cost:    O(triangles); textured ones up to a quarter of their texels.
[[nodiscard]] Lamps lamps_of(const mesh::TriangleMesh& mesh,
                             const SurfaceOverride& override_surface = {});

/// Returns the group of lamps of each triangle, [num_triangles]; NoGroup where none glows. Empty
/// where no triangle does.
inline constexpr std::uint32_t NoGroup = ~0u;
[[nodiscard]] std::vector<std::uint32_t> lamp_groups(const mesh::TriangleMesh& mesh,
                                                     const Lamps& lamps);

} // namespace relumine::prt
