// What a point of a mesh sends to the eye of a picture.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/receivers/texture_view.h"
#include "relight/sharp/light_packets.h"
#include "relight/surfaces/mirrors.h"
#include "relight/surfaces/other_side.h"

namespace relumine::relight {

/// The light that the points of a mesh send on. Lights that are traced are bits, as LightPackets
/// has them. For one thread.
class SampleShading {
public:
    /// All must outlive this object.
    SampleShading(const mesh::TriangleMesh& mesh, const MeshLight& light,
                  const LightPackets& packets, const prt::TwinTriangles& twins,
                  const prt::TextureView& view)
        : mesh_(mesh), light_(light), packets_(packets), twins_(twins), view_(view) {}

    [[nodiscard]] bool has_texture(std::uint32_t triangle) const {
        return light_.textures != nullptr && light_.textures->has(triangle);
    }

    /// Returns what a point sends on of the light of the vertices and a change to it, which may be
    /// less than 0: radiance for albedo 1. `mirrors` is asked where the point is a mirror.
    [[nodiscard]] glm::vec3 soft(const prt::MeshPoint& at, const std::optional<Mirror>& mirror,
                                 Mirrors& mirrors, const glm::vec3& change) const;

    /// Returns the other side of a point whose surface passes light on.
    [[nodiscard]] std::optional<OtherSide> other_side(const prt::MeshPoint& at) const {
        return relight::other_side(mesh_, at, light_, twins_, &view_);
    }
    /// Returns what a point passes on of the light of the vertices.
    [[nodiscard]] glm::vec3 soft(const OtherSide& other, const std::optional<Mirror>& mirror) const;
    /// Returns what it passes on of lights that the other side sees.
    [[nodiscard]] glm::vec3 traced(const OtherSide& other, const std::optional<Mirror>& mirror,
                                   std::span<const std::uint16_t> lights);

    /// Returns what a point gives of its own.
    [[nodiscard]] glm::vec3 emitted(const prt::MeshPoint& at,
                                    const std::optional<Mirror>& mirror) const;

    /// Returns what lights give to a white Lambert surface.
    [[nodiscard]] glm::vec3 white(const glm::vec3& normal, std::span<const std::uint16_t> lights);

    /// Returns what a point sends on of lights.
    [[nodiscard]] glm::vec3 traced(const prt::MeshPoint& at, const std::optional<Mirror>& mirror,
                                   std::span<const std::uint16_t> lights);

private:
    [[nodiscard]] glm::vec3 tilted(const prt::MeshPoint& at) const;
    [[nodiscard]] float eye_cosine(const prt::MeshPoint& at) const;
    [[nodiscard]] glm::vec3 reflected(const prt::Surface& surface, const glm::vec3& normal,
                                      const glm::vec3& to_eye,
                                      std::span<const std::uint16_t> lights) const;
    [[nodiscard]] prt::Surface surface_at(const prt::MeshPoint& at) const;

    const mesh::TriangleMesh& mesh_;
    const MeshLight& light_;
    const LightPackets& packets_;
    const prt::TwinTriangles& twins_;
    /// Used where triangles have textures.
    const prt::TextureView& view_;
    /// The lights that were summed last, and their sum.
    std::vector<std::uint16_t> summed_;
    VectorIrradiance sum_;
};

} // namespace relumine::relight
