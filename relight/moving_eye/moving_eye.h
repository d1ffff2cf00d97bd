// Highlights for an eye that moves: nothing of them is precomputed. Light, visibility and lobe are
// multiplied when the eye is known (docs/glossy.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "prt/transfer/transfer.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// A narrower highlight comes out wider: cells are a third of a degree wide at least.
inline constexpr float NarrowestLiveRoughness = 0.11f;

struct EyeOptions {
    /// Relative L2 error of the radiance that cuts are made for.
    float tolerance = 0.015f;
    /// Milliseconds that a look may take; the tolerance follows. 0: the tolerance counts.
    double budget_ms = 0.0;
    /// Only what a picture from the eye shows has highlights: other receivers may have none.
    bool seen_only = false;
};

struct EyeReport {
    /// Blocks of 16 receivers that face the eye and have a highlight; of a picture, those that it
    /// needs.
    std::size_t num_blocks = 0;
    /// Those of them that took the change of the light, in place of being lit anew.
    std::size_t num_updated = 0;
    /// Cells of their cuts, and lights that were traced.
    std::size_t num_cells = 0;
    /// What the cuts were made for.
    float tolerance = 0.0f;
    double seconds = 0.0;
};

/// Lights the highlights of a scene's receivers for any eye.
///
/// Threads: parallel inside; every result is the same bit by bit for any number of threads, but for
///          a budget. One thread at a time may call functions that are not const.
class MovingEye {
public:
    /// The transfer must outlive this object. Its own surfaces are those of light without
    /// highlights; `surfaces` have them. Other highlights than GGX, coats and sheen are left out.
    ///
    /// Shape:   positions and surfaces are [num_receivers] in the receivers' own order. Pictures
    ///          show `triangles` of receivers, by their numbers, and nothing else is in the way.
    /// Throws:  std::invalid_argument for other sizes, or where no surface has a GGX highlight.
    /// Cost:    a second for half a million receivers.
    /// Memory:  see num_bytes(); some 6 KB for each block that faces an eye that stands still while
    ///          the light changes.
    MovingEye(const prt::Transfer& transfer, std::span<const glm::vec3> positions,
              std::span<const prt::Surface> surfaces,
              std::span<const std::array<std::uint32_t, 3>> triangles = {});
    ~MovingEye();
    MovingEye(MovingEye&&) noexcept;

    /// Takes other surfaces, as of another roughness. Returns whether the cells of the sky are of
    /// another size now: then set_light() must be called again before the next look.
    ///
    /// Throws:  as the constructor; nothing has changed then.
    [[nodiscard]] bool set_surfaces(std::span<const prt::Surface> surfaces);

    /// Takes the light of a Relighter of the same transfer. Where it has shadow rays, small bright
    /// lights are traced as for highlights of a fixed view: also those that fill their cluster.
    ///
    /// Cost:    O(6 R^2 + cells), and a shadow ray per receiver and light that stood nowhere
    ///          before.
    void set_light(const Relighter& relighter);

    /// Returns the radiance that receivers send to an eye. `radiance` is what they send without
    /// highlights, with bounces or without. Where the eye stands still and the light changes, from
    /// the third look on, only cells that changed are summed: the result is that of an eye that
    /// comes new, within rounding of the largest light. `sides` are planes through the eye and the
    /// sides of a picture, which count for what is seen: dot(xyz, p) + w >= 0 inside.
    ///
    /// Shape:   [num_receivers] in the receivers' own order, both. The result is good until the
    ///          next call.
    /// Throws:  std::invalid_argument for another size; std::logic_error before set_light().
    [[nodiscard]] std::span<const glm::vec3> look(const glm::vec3& eye,
                                                  std::span<const glm::vec3> radiance,
                                                  const EyeOptions& options = {},
                                                  std::span<const glm::vec4> sides = {});

    /// What the last look did.
    [[nodiscard]] const EyeReport& report() const;

    /// Small lights that have a shadow ray for each receiver.
    [[nodiscard]] std::size_t num_traced() const;
    /// Memory of the visibility above the clusters.
    [[nodiscard]] std::size_t num_bytes() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine::relight
