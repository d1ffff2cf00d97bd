// Which blocks of receivers a picture from an eye needs: what the eye does not see, takes no time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "prt/transfer/transfer.h"
#include "relight/moving_eye/visibility_pyramid.h"

namespace relumine::relight {

/// Finds the blocks that an eye sees, without rays: what a receiver sees of the sky in the eye's
/// direction is stored, and a blocker in that direction stands between the two where the eye is
/// outside of all.
class SeenBlocks {
public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// The transfer and the pyramid must outlive this object. A picture shows `triangles` of
    /// receivers, so a block that shares one with a block that is seen is needed, too.
    ///
    /// Shape:   positions are [num_receivers] by place; triangles have the receivers' own numbers.
    /// Cost:    O(receivers + triangles).
    SeenBlocks(const prt::Transfer& transfer, const VisibilityPyramid& visibility,
               std::span<const glm::vec3> positions, std::span<const Triangle> triangles);

    /// Returns 1 for each block that a picture from the eye needs, [num_blocks]; good until the
    /// next call. Blocks that face away are not needed. `sides` are planes of the picture's sides:
    /// a point p is inside where dot(xyz, p) + w >= 0 for each.
    ///
    /// Cost:    O(receivers); parallel.
    [[nodiscard]] std::span<const std::uint8_t> find(const glm::vec3& eye,
                                                     std::span<const glm::vec4> sides);

private:
    struct Sphere {
        glm::vec3 middle{0.0f};
        float radius = 0.0f;
    };

    void find_neighbours(std::span<const Triangle> triangles);
    [[nodiscard]] bool is_outside(const glm::vec3& eye) const;
    [[nodiscard]] bool faces(std::size_t block, const glm::vec3& eye) const;
    [[nodiscard]] bool sees(std::size_t block, const glm::vec3& eye) const;

    const prt::Transfer& transfer_;
    const VisibilityPyramid& visibility_;
    std::span<const glm::vec3> positions_;
    /// [num_blocks]
    std::vector<Sphere> spheres_;
    /// Planes that all receivers are behind.
    std::vector<glm::vec4> hull_;
    /// The neighbours of block b are neighbours_[first_[b], first_[b + 1]).
    std::vector<std::uint32_t> first_, neighbours_;
    /// [num_blocks]
    std::vector<std::uint8_t> seen_, needed_;
};

} // namespace relumine::relight
