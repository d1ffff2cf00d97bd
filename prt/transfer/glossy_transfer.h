// The view-dependent part of a scene's light transfer: highlights and Fresnel's share, for a fixed
// eye.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/receivers/surface.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// The lobes of prt::Lobes that depend on the view.
enum class GlossyLobe : std::uint8_t { Specular, SpecularGrazing, DiffuseGrazing, Coat, Sheen };
inline constexpr std::size_t NumGlossyLobes = 5;

/// Deepest level of a cell: 0.09 degrees, less than the narrowest highlight (ggx_alpha()), and the
/// deepest level of a LightPyramid.
inline constexpr std::uint32_t MaxGlossyLevel = 10;

/// One lobe of all receivers.
///
/// Each block of 16 has its own cut through the quadtree of cells: fine where its highlights and
/// shadows need it, coarse elsewhere. A cut has a few hundred cells, which cover the directions
/// that reach the block.
///
/// Differs from [JN], where all receivers share one set of clusters: every receiver has its
/// highlight somewhere else, so one-degree highlights would split the whole sphere for all
/// receivers.
struct LobeCuts {
    /// [num_blocks + 1] first entry of each block.
    std::vector<std::uint64_t> begin = {0};
    /// [num_entries] cell_index(); within a block along the Z curve.
    std::vector<std::uint32_t> cells = {};
    /// [num_entries] the transfer of byte 1, 1/sr.
    std::vector<float> scales = {};
    /// [num_entries * 16] byte q of each receiver: the mean transfer is q^2 times the scale.
    std::vector<std::uint8_t> values = {};

    [[nodiscard]] std::size_t num_entries() const { return cells.size(); }
    /// Adds blocks of other cuts behind the last one.
    void append(const LobeCuts& from, std::size_t first_block, std::size_t num_blocks);
};

/// The glossy part of a transfer. Arrays are by place in spatial order, as in Transfer.
struct GlossyTransfer {
    /// [num_receivers] unit directions to the eye; set_surfaces() fills them in.
    std::vector<glm::vec3> to_eye;
    /// By GlossyLobe.
    std::array<LobeCuts, NumGlossyLobes> lobes{};
    /// The whole scene's deepest level, from where its light is summed. Only of a part of a scene.
    std::uint32_t whole_depth = 0;

    /// Whether highlights are stored. Where they are not, rays find them, and closed forms those of
    /// sharp lights.
    [[nodiscard]] bool is_stored() const;
    /// Returns the deepest level of any cell, or the whole scene's.
    [[nodiscard]] std::uint32_t deepest_level() const;
    [[nodiscard]] std::size_t num_bytes() const;
};

} // namespace relumine::prt
