// View-dependent lobes of 16 receivers at a time. Vectorised with run-time dispatch;
// evaluate_lobes() in brdf.h is the plain form.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/glossy/lobe_list.h"
#include "prt/glossy/stretched_lobe.h"
#include "prt/glossy/thin_film.h"
#include "prt/transfer/glossy_transfer.h"

namespace relumine::prt {

/// The receivers of a block as the lobes need them, coordinates apart.
struct alignas(64) BlockSurfaces {
    using Floats = std::array<float, BlockSize>;
    std::array<Floats, 3> normal{};
    std::array<Floats, 3> to_eye{};
    Floats normal_dot_eye{};
    /// Parameters of each receiver's own lobe.
    std::array<Floats, 2> parameters{};
    /// By Highlight: bit i is set where receiver i has it and its eye is above the horizon.
    std::array<std::uint32_t, NumHighlights> lanes{};
    /// Tables of measured receivers.
    std::array<const mesh::BrdfTable*, BlockSize> tables{};
    /// Receivers with a clear coat, with sheen, and with a thin film.
    std::uint32_t coat_lanes = 0, sheen_lanes = 0, film_lanes = 0;
    /// Normals of the coat, their cosines to the eye, and parameters of the coat's lobe.
    alignas(64) std::array<Floats, 3> coat_normal{};
    Floats coat_dot_eye{};
    std::array<Floats, 2> coat_parameters{};
    /// Sheen's alpha, 1 + lambda of the eye, and the factor on the lobe.
    std::array<Floats, 3> sheen_parameters{};
    /// Receivers whose highlight is stretched. [16] of it, or empty: there are none.
    std::uint32_t stretched_lanes = 0;
    std::vector<std::optional<StretchedLobe>> stretched{};
    /// [16], or empty: no receiver has a film.
    std::vector<std::optional<FilmHighlight>> films{};

    void set(std::size_t lane, const Surface& surface, const glm::vec3& normal_of_lane,
             const glm::vec3& eye_of_lane);
    /// Returns the bits of the receivers that have a lobe.
    [[nodiscard]] std::uint32_t lanes_with(GlossyLobe lobe) const;
    [[nodiscard]] bool has(GlossyLobe lobe) const { return lanes_with(lobe) != 0; }

private:
    void set_coat(std::size_t lane, const Surface& surface, const glm::vec3& normal_of_lane,
                  const glm::vec3& eye_of_lane);
};

/// Evaluates one lobe of each receiver for each direction.
///
/// Shape:   values is [directions.size()] of 16.
/// Accuracy: relative error below 1e-5 plus 1e-7 of the peak.
void evaluate_lobe(const BlockSurfaces& surfaces, GlossyLobe lobe,
                   std::span<const glm::vec3> directions, std::span<BlockSurfaces::Floats> values);

/// Evaluates all lobes for one direction, by GlossyLobe.
void evaluate_lobes(const BlockSurfaces& surfaces, const glm::vec3& direction,
                    std::array<BlockSurfaces::Floats, NumGlossyLobes>& values);

} // namespace relumine::prt
