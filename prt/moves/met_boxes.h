// Whether rays from a place may meet boxes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"

namespace relumine::prt {

/// A box that holds nothing yet.
[[nodiscard]] inline mesh::Bounds no_box() {
    constexpr float Far = std::numeric_limits<float>::infinity();
    return {glm::vec3(Far), glm::vec3(-Far)};
}

inline void include(mesh::Bounds& box, const glm::vec3& point) {
    box.min = glm::min(box.min, point);
    box.max = glm::max(box.max, point);
}
inline void include(mesh::Bounds& box, const mesh::Bounds& other) {
    include(box, other.min);
    include(box, other.max);
}

/// Largest coordinate.
[[nodiscard]] inline float reach(const mesh::Bounds& box) {
    const glm::vec3 far = glm::max(glm::abs(box.min), glm::abs(box.max));
    return std::max({far.x, far.y, far.z});
}

/// One over a direction's components; a number so large that it stands for infinity where one is 0.
[[nodiscard]] inline glm::vec3 inverse(const glm::vec3& direction) {
    glm::vec3 result;
    for (int axis = 0; axis < 3; ++axis)
        result[axis] = std::abs(direction[axis]) < 1e-20f ? 1e20f : 1.0f / direction[axis];
    return result;
}

/// Directions, as MetBoxes asks for many of them: the inverse() of each, in words of 64.
class InverseDirections {
public:
    static constexpr std::size_t WordSize = 64;

    void add(const glm::vec3& direction) {
        if (size_++ % WordSize == 0)
            words_.emplace_back();
        const glm::vec3 values = inverse(direction);
        for (int axis = 0; axis < 3; ++axis)
            words_.back()[static_cast<std::size_t>(axis)][(size_ - 1) % WordSize] = values[axis];
    }
    /// [words] x, y and z; those beyond the last direction are 0.
    using Word = std::array<std::array<float, WordSize>, 3>;
    [[nodiscard]] std::span<const Word> words() const { return words_; }
    /// Returns the directions of a word, a bit each.
    [[nodiscard]] std::uint64_t bits(std::size_t word) const {
        const std::size_t rest = size_ - word * WordSize;
        return rest >= WordSize ? ~std::uint64_t{0} : (std::uint64_t{1} << rest) - 1;
    }

private:
    std::vector<Word> words_;
    std::size_t size_ = 0;
};

/// Boxes as seen from a box of places: a ray from any of these that meets a box meets the box's
/// difference from the places when it starts at the origin.
///
/// Boxes are wider than they are: tracers find hits beside a triangle, up to 16 roundings of the
/// distance of its farthest corner (prt/visibility/ray_scene.cpp). The margin is four times as
/// much, and far more than what the tests here round.
class MetBoxes {
public:
    MetBoxes(std::span<const mesh::Bounds> boxes, const mesh::Bounds& places) {
        mesh::Bounds all = no_box();
        boxes_.reserve(boxes.size());
        for (const mesh::Bounds& box : boxes) {
            boxes_.push_back(difference(box, places));
            include(all, box);
        }
        if (!boxes.empty())
            all_ = difference(all, places);
    }

    /// Given the inverse() of a direction.
    [[nodiscard]] bool meets(const glm::vec3& inverse_direction) const {
        return !boxes_.empty() && meets(all_, inverse_direction) &&
               std::any_of(boxes_.begin(), boxes_.end(),
                           [&](const mesh::Bounds& box) { return meets(box, inverse_direction); });
    }
    /// Returns where a ray first meets a box, in units of its direction's length; infinity where it
    /// meets none. Given the inverse() of the direction.
    [[nodiscard]] float nearest(const glm::vec3& inverse_direction) const {
        float result = std::numeric_limits<float>::infinity();
        if (boxes_.empty() || !meets(all_, inverse_direction))
            return result;
        for (const mesh::Bounds& box : boxes_)
            if (const auto [enters, leaves] = crossing(box, inverse_direction); enters <= leaves)
                result = std::min(result, enters);
        return result;
    }
    /// Returns those of the `asked` directions of a word that meet a box. Vectorised with run-time
    /// dispatch.
    [[nodiscard]] std::uint64_t meeting(const InverseDirections::Word& word,
                                        std::uint64_t asked) const;

private:
    static mesh::Bounds difference(const mesh::Bounds& box, const mesh::Bounds& places) {
        constexpr float Margin = 64.0f * 0x1p-24f;
        const glm::vec3 margin(Margin * (reach(box) + reach(places)));
        return {box.min - places.max - margin, box.max - places.min + margin};
    }
    /// Where a ray enters a box and leaves it. It misses the box where the first is farther.
    static std::pair<float, float> crossing(const mesh::Bounds& box,
                                            const glm::vec3& inverse_direction) {
        const glm::vec3 a = box.min * inverse_direction, b = box.max * inverse_direction;
        const glm::vec3 enters = glm::min(a, b), leaves = glm::max(a, b);
        return {std::max({enters.x, enters.y, enters.z, 0.0f}),
                std::min({leaves.x, leaves.y, leaves.z})};
    }
    static bool meets(const mesh::Bounds& box, const glm::vec3& inverse_direction) {
        const auto [enters, leaves] = crossing(box, inverse_direction);
        return enters <= leaves;
    }

    mesh::Bounds all_;
    std::vector<mesh::Bounds> boxes_;
};

} // namespace relumine::prt
