// "Is this ray blocked?": the one question that the visibility algorithms ask, for packets of rays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace relumine::prt {

class RayScene;

/// Rays of a packet: directions that one receiver looks into together.
inline constexpr std::size_t PacketSize = 16;

/// Unit directions of a packet in the layout that the ray kernels read. Unused lanes repeat the
/// first direction.
struct alignas(64) DirectionPacket {
    std::array<float, PacketSize> x{};
    std::array<float, PacketSize> y{};
    std::array<float, PacketSize> z{};
    std::uint32_t num_directions = 0;

    void set(std::size_t lane, const glm::vec3& direction) {
        x[lane] = direction.x;
        y[lane] = direction.y;
        z[lane] = direction.z;
    }
    [[nodiscard]] glm::vec3 direction(std::size_t lane) const {
        return {x[lane], y[lane], z[lane]};
    }
};

/// Up to 64 directions inside one narrow cone. Direction j is lane j % 16 of packet j / 16. Unused
/// lanes repeat the patch's first direction.
struct DirectionPatch {
    static constexpr std::size_t NumPackets = 4;
    static constexpr std::size_t Size = NumPackets * PacketSize;

    std::array<DirectionPacket, NumPackets> packets{};
    std::uint32_t num_directions = 0;

    [[nodiscard]] bool full() const { return num_directions == Size; }
    [[nodiscard]] glm::vec3 direction(std::size_t j) const {
        return packets[j / PacketSize].direction(j % PacketSize);
    }
    /// Adds one more direction. Must not be full.
    void add(const glm::vec3& direction);
};

/// Receivers that lie close together.
struct ReceiverGroup {
    static constexpr std::size_t MaxSize = 128;

    /// [at most MaxSize] starts of the receivers' rays.
    std::span<const glm::vec3> origins;
    /// A hint: roughly where the receivers face, of any length.
    glm::vec3 mean_normal{0.0f};
};

/// The geometry between receivers and lights. RayScene answers for meshes; tests answer with closed
/// forms.
///
/// Threads: all queries may run from many threads at once.
class Blockers {
public:
    Blockers() = default;
    virtual ~Blockers() = default;

    /// Returns a mask whose bit i is set where the ray from `origin` in direction i is blocked.
    /// Traces only the directions in `active`. Fastest for directions that lie close together.
    [[nodiscard]] virtual std::uint32_t occluded(const glm::vec3& origin,
                                                 const DirectionPacket& directions,
                                                 std::uint32_t active) const = 0;

    /// Clears bit j of rays[i] where the ray from receiver i in the patch's direction j is
    /// blocked. A bit that is clear asks for nothing. The answers are the same as from occluded(),
    /// which this default asks.
    virtual void clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                               std::span<std::uint64_t> rays) const;

    /// Says that so many rays will be asked for soon. It is worth work that makes them faster.
    virtual void prepare(std::uint64_t num_rays) const { static_cast<void>(num_rays); }

    /// Returns the same blockers with no surface that light passes by chance
    /// (prt/visibility/see_through.h). Null: they have none. As long-lived as this object.
    [[nodiscard]] virtual const Blockers* settled() const { return nullptr; }

    /// Returns what finds the surfaces on single rays. Null: nothing does. As long-lived as this
    /// object.
    [[nodiscard]] virtual const RayScene* ray_scene() const { return nullptr; }

protected:
    Blockers(const Blockers&) = default;
    Blockers& operator=(const Blockers&) = default;
    Blockers(Blockers&&) = default;
    Blockers& operator=(Blockers&&) = default;
};

/// Whether light from a direction lies above a receiver's horizon: n.w > 0 in float.
[[nodiscard]] inline bool is_above(const glm::vec3& normal, const glm::vec3& direction) {
    return normal.x * direction.x + normal.y * direction.y + normal.z * direction.z > 0.0f;
}

/// Returns the lanes of `candidates` whose light reaches a receiver: above its horizon and not
/// blocked.
[[nodiscard]] inline std::uint32_t lit_lanes(const Blockers& blockers, const glm::vec3& origin,
                                             const glm::vec3& normal,
                                             const DirectionPacket& directions,
                                             std::uint32_t candidates) {
    std::uint32_t above = 0;
    for (std::uint32_t i = 0; i < PacketSize; ++i)
        above |= static_cast<std::uint32_t>(is_above(normal, directions.direction(i))) << i;
    above &= candidates;
    return above == 0 ? 0 : above & ~blockers.occluded(origin, directions, above);
}

/// Returns where a receiver's rays start: lifted off its surface along the normal, so that the
/// surface does not block itself.
[[nodiscard]] inline glm::vec3 ray_origin(const glm::vec3& position, const glm::vec3& normal,
                                          float bias) {
    return position + bias * normal;
}

} // namespace relumine::prt
