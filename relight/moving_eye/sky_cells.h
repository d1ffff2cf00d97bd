// The cells of the sky as cuts through it need them: where the light of each is, and how it is
// spread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/light_pyramid.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// A cell of any level, as one light.
struct SkyCell {
    /// Where its light is, unit length; its middle where it is black.
    glm::vec3 direction{0.0f, 0.0f, 1.0f};
    /// Square root of its solid angle.
    float size = 0.0f;
    /// Luminance of its light, radiance times sr.
    float power = 0.0f;
    /// Variance of the light around its direction, of each of two axes, sr.
    float variance = 0.0f;
    /// Standard deviation of the radiance in the cell over its mean.
    float contrast = 0.0f;
};

/// The light of an environment at all levels.
class SkyCells {
public:
    /// Memory:  40 bytes for each of about 8 * 4^level cells.
    explicit SkyCells(std::uint32_t deepest_level);

    /// Takes the environment of a Relighter, without the lights in `without`. It may have none,
    /// which is black.
    ///
    /// Cost:    O(6 R^2 + cells).
    /// Threads: parallel; the same bits for any number of threads.
    void set(const Relighter& relighter, std::span<const SharpLight> without);

    [[nodiscard]] std::uint32_t deepest_level() const { return deepest_level_; }
    /// [num_cells] by prt::cell_index().
    [[nodiscard]] std::span<const SkyCell> cells() const { return cells_; }
    /// [num_cells * 3] red, green, blue, radiance times sr.
    [[nodiscard]] std::span<const float> light() const { return light_.light(); }

private:
    void set_level(std::uint32_t level);

    std::uint32_t deepest_level_;
    LightPyramid light_;
    std::vector<SkyCell> cells_;
    /// [cells of a level] of the level that was set last, and of the one above.
    std::vector<glm::dvec3> vectors_, above_;
    /// Sums of squared radiance times solid angle.
    std::vector<double> squares_, squares_above_;
};

} // namespace relumine::relight
