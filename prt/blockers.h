// "Is this ray blocked?": the one question that the visibility algorithms ask, sixteen rays at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

namespace relumine::prt {

/// Rays of a packet: directions that one receiver looks into together.
inline constexpr std::size_t PacketSize = 16;

/// Directions of a packet in the layout that the ray kernels read, unit vectors. Unused lanes repeat the first direction.
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
};

/// What stands between receivers and lights. RayScene answers for meshes; tests answer with closed forms.
class Blockers {
public:
    Blockers() = default;
    virtual ~Blockers() = default;

    /// Bit i is set where the ray from `origin` in direction i is blocked; only directions in `active` are traced.
    /// Fastest when the directions lie close together. Called from many threads at once.
    [[nodiscard]] virtual std::uint32_t occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                                 std::uint32_t active) const = 0;

protected:
    Blockers(const Blockers&) = default;
    Blockers& operator=(const Blockers&) = default;
    Blockers(Blockers&&) = default;
    Blockers& operator=(Blockers&&) = default;
};

/// Where a receiver's rays start: lifted off its surface along the normal, so that the surface does not block itself.
[[nodiscard]] inline glm::vec3 ray_origin(const glm::vec3& position, const glm::vec3& normal, float bias) {
    return position + bias * normal;
}

} // namespace relumine::prt
