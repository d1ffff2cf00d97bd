#include "relight/moving_eye/eye_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "prt/glossy/lobe_list.h"

namespace relumine::relight {

namespace {

/// A light spread by the lobe's own width is off by so much of itself where the lobe is widened in
/// place of being summed finely.
constexpr float ErrorOfSpread = 0.5f;
/// The cosine and the masks change over half a radian, however rough the surface.
constexpr float LargestWidth2 = 0.25f;
/// How much the visible part of a cell may go with its light.
constexpr float ShareOfContrast = 0.3f;

glm::vec3 lane_of(const std::array<prt::BlockSurfaces::Floats, 3>& axes, std::size_t lane) {
    return {axes[0][lane], axes[1][lane], axes[2][lane]};
}

/// The factor on a highlight in radiance: about what it reflects of a white sky.
float reflectance(const prt::Surface& surface, float n_v) {
    const float f0 = std::max({surface.specular.r, surface.specular.g, surface.specular.b});
    const float less = 1.0f - n_v;
    return f0 + (1.0f - f0) * (less * less) * (less * less) * less;
}

} // namespace

std::optional<BlockLobe> lobe_of(const prt::BlockSurfaces& block,
                                 std::span<const prt::Surface> surfaces) {
    BlockLobe lobe{.normal = glm::vec3(0.0f), .to_eye = glm::vec3(0.0f)};
    const std::uint32_t lanes = block.lanes_with(prt::GlossyLobe::Specular);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if ((lanes >> i & 1u) == 0)
            continue;
        lobe.normal += lane_of(block.normal, i);
        lobe.to_eye += lane_of(block.to_eye, i);
        lobe.alpha2 = std::min(lobe.alpha2, block.parameters[0][i]);
        lobe.weight = std::max(lobe.weight, reflectance(surfaces[i], block.normal_dot_eye[i]));
    }
    if (!(glm::length(lobe.normal) > 0.0f && glm::length(lobe.to_eye) > 0.0f))
        return std::nullopt;
    lobe.normal = glm::normalize(lobe.normal);
    lobe.to_eye = glm::normalize(lobe.to_eye);
    lobe.n_v = std::max(glm::dot(lobe.normal, lobe.to_eye), 1e-3f);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        if ((lanes >> i & 1u) != 0)
            lobe.spread = std::max(lobe.spread,
                                   glm::distance(lobe.normal, lane_of(block.normal, i)) +
                                       0.5f * glm::distance(lobe.to_eye, lane_of(block.to_eye, i)));
    return lobe;
}

void EyeCut::find(std::size_t block, const BlockLobe& lobe, std::vector<LitCell>& cells) {
    pending_.clear();
    for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
        pending_.push_back({.node = face, .place = face, .level = 0});
    while (!pending_.empty()) {
        const Pending at = pending_.back();
        pending_.pop_back();
        const SkyCell& cell = sky_.cells()[prt::num_cells_above(at.level) + at.place];
        if (cell.power == 0.0f)
            continue;
        // All of the cell lies below the horizons.
        if (glm::dot(cell.direction, lobe.normal) + lobe.spread + cell.size < 0.0f)
            continue;
        const VisibilityPyramid::Node& node = visibility_.nodes()[at.node];
        const Sight sight = visibility_.sight(block, node);
        if (sight == Sight::Hidden)
            continue;
        if (at.level == sky_.deepest_level() ||
            is_fine(cell, lobe, sight == Sight::Mixed && node.first_child != 0)) {
            add(at, sight, block, cells);
            continue;
        }
        for (std::uint32_t i = 0; i < 4; ++i)
            pending_.push_back({.node = node.first_child != 0 ? node.first_child + i : at.node,
                                .place = 4 * at.place + i,
                                .level = at.level + 1});
    }
}

/// Whether a cell may stay whole; `may_differ` where its parts are not seen alike.
bool EyeCut::is_fine(const SkyCell& cell, const BlockLobe& lobe, bool may_differ) const {
    // The half vector of w turns half as far as w.
    const float v_w = glm::dot(lobe.to_eye, cell.direction);
    const float n_w = glm::dot(lobe.normal, cell.direction);
    const float cosine = (lobe.n_v + n_w) / std::sqrt(std::max(2.0f + 2.0f * v_w, 1e-6f));
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    const float nearest = std::max(sine - lobe.spread - 0.25f * cell.size, 0.0f);
    const float width2 = std::min(nearest * nearest + lobe.alpha2, LargestWidth2);
    // S as if at the nearest point, of the lobe that is as wide as the cell.
    const float alpha2 = lobe.alpha2 + cell.size * cell.size / 24.0f;
    const float t = nearest * nearest + alpha2;
    const float above = std::clamp(n_w + lobe.spread + 0.5f * cell.size, 0.0f, 1.0f);
    const float mask_v = std::max(lobe.n_v, std::sqrt(lobe.alpha2));
    const float value = alpha2 / (std::numbers::pi_v<float> * t * t) * 0.25f * above /
                        (std::max(above, lobe.n_v) * mask_v);
    const float share = value * cell.power * lobe.weight;
    if (share <= error_)
        return true;
    float off = std::min(ErrorOfSpread * 0.25f * cell.variance / width2, 1.0f);
    if (may_differ)
        off += 0.5f * (std::min(4.0f * std::sqrt(cell.size * cell.size / 48.0f / width2), 1.0f) +
                       ShareOfContrast * std::min(cell.contrast, 1.0f));
    return share * off <= error_;
}

void EyeCut::add(const Pending& at, Sight sight, std::size_t block,
                 std::vector<LitCell>& cells) const {
    const std::uint32_t index = prt::num_cells_above(at.level) + at.place;
    const SkyCell& cell = sky_.cells()[index];
    const float* rgb = sky_.light().data() + std::size_t{3} * index;
    LitCell& lit = cells.emplace_back();
    lit.direction = cell.direction;
    lit.widening = 0.5f * cell.variance;
    lit.light = {rgb[0], rgb[1], rgb[2]};
    if (sight == Sight::Visible) {
        lit.parts.fill(1);
        return;
    }
    const VisibilityPyramid::Parts parts = visibility_.parts(block, visibility_.nodes()[at.node]);
    lit.parts = parts.parts;
    lit.light *= parts.unit;
}

} // namespace relumine::relight
