// The view-dependent part of a scene's light transfer: highlights and Fresnel's share, for a fixed
// eye.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/visible_counts.h"
#include "prt/glossy/surface.h"

namespace relumine::prt {

/// The lobes of prt::Lobes that depend on the view.
enum class GlossyLobe : std::uint8_t { Specular, SpecularGrazing, DiffuseGrazing };
inline constexpr std::size_t NumGlossyLobes = 3;

/// No cell is finer: 0.09 degrees, less than the narrowest highlight (ggx_alpha()), and what
/// LightPyramid can hold.
inline constexpr std::uint32_t MaxGlossyLevel = 10;

/// One lobe of all receivers. Each block of 16 has its own cut through the quadtree of cells, fine
/// where its highlights and shadows need it and coarse elsewhere: a few hundred cells that cover
/// the directions which reach it. Differs from [JN], where all receivers share one set of clusters:
/// a highlight one degree wide that every receiver has somewhere else would split the whole sphere
/// for all.
struct LobeCuts {
    /// [num_blocks + 1] first entry of each block
    std::vector<std::uint64_t> begin;
    /// [num_entries] cell_index(), in a block along the Z curve
    std::vector<std::uint32_t> cells;
    /// [num_entries] transfer of byte 1, 1/sr
    std::vector<float> scales;
    /// [num_entries * 16] byte q of each receiver: mean transfer is q^2 times the scale
    std::vector<std::uint8_t> values;

    [[nodiscard]] std::size_t num_entries() const { return cells.size(); }
};

/// All of it. Arrays by place in spatial order, as in Transfer.
struct GlossyTransfer {
    /// [num_receivers] unit; set_surfaces() fills it
    std::vector<glm::vec3> to_eye;
    /// By GlossyLobe
    std::array<LobeCuts, NumGlossyLobes> lobes{};

    /// Deepest level that any cell has.
    [[nodiscard]] std::uint32_t deepest_level() const;
    [[nodiscard]] std::size_t num_bytes() const;
};

} // namespace relumine::prt
