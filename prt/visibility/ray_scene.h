// Rays against blockers. The only user of Embree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/visibility/bias.h"
#include "prt/visibility/blockers.h"
#include "prt/visibility/see_through.h"

namespace relumine::prt {

/// Triangles lie within this distance from the origin along each axis, and rays start within it.
/// Embree silently drops triangles beyond it, and aborts for rays from there (its FLT_LARGE).
inline constexpr float LargestCoordinate = 1.844e18f;

/// Returns what traces rays, and its version: "Embree 4.3.3".
/// Throws:  std::runtime_error when it cannot start here.
[[nodiscard]] std::string ray_engine();

/// The point where a ray first meets the mesh.
struct Hit {
    std::uint32_t triangle = 0;
    /// Weights of the triangle's second and third vertex.
    glm::vec2 barycentric{0.0f};
    /// In units of the ray direction's length.
    float distance = 0.0f;
};

/// Triangles prepared for ray queries; immutable but for follow(). Triangles block from both sides.
/// Rays are traced watertight (Embree's robust mode): no ray slips through a shared edge. Where the
/// mesh's materials let a ray pass (prt/visibility/see_through.h), it goes on behind the triangle.
///
/// A ray's answer does not depend on the rays that are asked with it. x86 processors from AVX2 on
/// give the same answers.
///
/// Threads: all queries may run from any number of threads at once.
class RayScene final : public Blockers {
public:
    /// Whether the directions of most packets lie close together. Answers are the same.
    enum class Packets { Narrow, Wide };
    /// Whether groups of the mesh move: follow().
    enum class Groups { Stay, Move };

    /// Builds the accelerator. The mesh need not outlive this object.
    ///
    /// Cost:    O(n log n), about 100 bytes per triangle.
    /// Throws:  std::runtime_error when Embree fails (out of memory, for example), is built without
    ///          packets or filters, or a triangle lies beyond LargestCoordinate.
    explicit RayScene(const mesh::TriangleMesh& mesh, Packets packets = Packets::Narrow,
                      Groups groups = Groups::Stay);
    ~RayScene() override;
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;

    /// Takes a group of the mesh as it stands there. The rest of the mesh is as before. Only with
    /// Groups::Move, and while no query runs.
    ///
    /// Cost:    O(the group's triangles), and a tree over all groups.
    void follow(const mesh::TriangleMesh& mesh, std::uint32_t group);
    /// The triangles of each group, ascending; none where groups stay.
    [[nodiscard]] std::vector<std::span<const std::uint32_t>> groups() const;

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::uint32_t active) const override;

    /// Returns the rays of `active` that are blocked before these distances, in units of the
    /// directions' lengths.
    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                         std::span<const float, PacketSize> distances,
                                         std::uint32_t active) const;

    /// Whether anything lies on the ray.
    [[nodiscard]] bool occluded(const glm::vec3& origin, const glm::vec3& direction,
                                float distance = std::numeric_limits<float>::infinity()) const;

    [[nodiscard]] std::optional<Hit>
    closest_hit(const glm::vec3& origin, const glm::vec3& direction, RayOf of = RayOf::Light) const;

    /// Finds the closest hit of each direction in `active`. Returns the mask of those that hit
    /// anything; the other hits are left alone. Fastest for directions that lie close together.
    std::uint32_t closest_hits(const glm::vec3& origin, const DirectionPacket& directions,
                               std::uint32_t active, std::span<Hit, PacketSize> hits,
                               RayOf of = RayOf::Light) const;

    /// A surface that lies between two points.
    struct Crossing {
        /// Part of the way
        float part = 0.0f;
        /// The way meets its front.
        bool is_front = false;
        std::array<glm::vec3, 3> corners{};
    };
    /// Finds all that lies on the way from one point to another, in any order. Thin surfaces count
    /// as for RayOf::SettledLight.
    void crossings(const glm::vec3& from, const glm::vec3& to,
                   std::vector<Crossing>& crossings) const;

    /// A surface that the eye meets, and what it leaves of the light behind it.
    struct Layer {
        Hit hit;
        mesh::Veil veil;
    };
    /// Finds what the eye sees in a direction, nearest first, up to the first that nothing is seen
    /// through. Most are one layer. Of more than MostLayers the last ones are left out.
    void layers(const glm::vec3& origin, const glm::vec3& direction,
                std::vector<Layer>& layers) const;
    static constexpr std::size_t MostLayers = 64;
    /// Whether there may be more layers behind a triangle.
    [[nodiscard]] bool is_thin(std::uint32_t triangle) const;
    /// Where an eye's ray stops that meets a triangle.
    enum class Stops : std::uint8_t { BothSides, Front, Somewhere };
    [[nodiscard]] Stops stops(std::uint32_t triangle) const;

    [[nodiscard]] const Blockers* settled() const override;
    [[nodiscard]] const RayScene* ray_scene() const override { return this; }
    /// What rays pass; never null.
    [[nodiscard]] const std::shared_ptr<const SeeThrough>& see_through() const;

private:
    struct Impl;
    class Settled;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine::prt
