// The cells of the sky as cuts through it need them: where the light of each is, and how it is
// spread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/light_pyramid.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Four lights side by side, such as the children of a cell: what a cut reads of them is in two
/// lines of a cache.
struct alignas(64) SisterCells {
    /// What is known of a light.
    enum Row : std::size_t {
        /// Where it is, unit length; the cell's middle where it is black.
        X,
        Y,
        Z,
        /// Variance of the light around its direction, of each of two axes, sr.
        Variance,
        /// Radiance times sr.
        Red,
        Green,
        Blue,
        NumRows
    };

    /// A row after the other. A light's own are `Stride` apart.
    static constexpr std::size_t Stride = 4;
    std::array<float, NumRows * Stride> rows{};
    /// High half: the square root of a cell's solid angle. Low half: the standard deviation of the
    /// radiance in the cell over its mean, 1 at most. Each is the high half of a float.
    std::array<std::uint32_t, Stride> size_and_contrast{};

    [[nodiscard]] float& at(Row row, std::size_t i) { return rows[row * Stride + i]; }
    void set_direction(std::size_t i, const glm::vec3& direction);
    void set_light(std::size_t i, const glm::vec3& light);
    /// Whether light i is that of another four, as cuts see it.
    [[nodiscard]] bool is_alike(std::size_t i, const SisterCells& other) const;
    bool operator==(const SisterCells&) const = default;
    void set_size(std::size_t i, float size);
    void set_contrast(std::size_t i, float contrast);
};

/// The light of an environment at all levels.
class SkyCells {
public:
    /// Memory:  80 bytes for each of about 8 * 4^level cells.
    explicit SkyCells(std::uint32_t deepest_level);

    /// Takes the environment of a Relighter, without the lights in `without`. It may have none,
    /// which is black.
    ///
    /// Cost:    O(6 R^2 + cells).
    /// Threads: parallel; the same bits for any number of threads.
    void set(const Relighter& relighter, std::span<const SharpLight> without);

    [[nodiscard]] std::uint32_t deepest_level() const { return deepest_level_; }
    /// Returns the children of a cell by prt::cell_index().
    [[nodiscard]] const SisterCells& children(std::uint32_t cell) const { return sisters_[cell]; }
    /// Returns the children of a cell as they were before the last set().
    [[nodiscard]] const SisterCells& children_before(std::uint32_t cell) const {
        return before_[cell];
    }
    /// Returns which children the last set() changed: bit i for child i.
    [[nodiscard]] std::uint32_t changed_children(std::uint32_t cell) const {
        return changed_[cell];
    }
    /// How often set() was called.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// Returns the number of a cell's first child; the others follow.
    [[nodiscard]] static std::uint32_t first_child(std::uint32_t cell) {
        return static_cast<std::uint32_t>(cubemap::NumFaces) + 4 * cell;
    }
    /// Whether a cell has children.
    [[nodiscard]] bool is_split(std::uint32_t cell) const { return cell < sisters_.size(); }

private:
    void set_level(std::uint32_t level);

    std::uint32_t deepest_level_;
    LightPyramid light_;
    /// [cells above the deepest level]
    std::vector<SisterCells> sisters_, before_;
    std::vector<std::uint8_t> changed_;
    std::uint64_t version_ = 0;
    /// [cells]
    std::vector<float> solid_angles_;
    /// [cells of a level] of the level that was set last, and of the one above.
    std::vector<glm::dvec3> vectors_, above_;
    /// Sums of squared radiance times solid angle.
    std::vector<double> squares_, squares_above_;
};

} // namespace relumine::relight
