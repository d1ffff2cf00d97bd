// The list of lobes.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "prt/glossy/blinn_phong_lobe.h"
#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/ggx_whole_lobe.h"
#include "prt/glossy/measured_lobe.h"
#include "prt/receivers/surface.h"

namespace relumine::prt {

/// No highlight.
struct MattLobe {
    static constexpr Highlight Kind = Highlight::None;
    static constexpr LobeFacts Facts{.name = "lambert", .albedo = "albedo"};
    static float narrowness(float) { return 0.0f; }
    static float specular(float, const LobeGeometry&) { return 0.0f; }
    static std::array<float, 2> parameters(float) { return {}; }
};

/// By Highlight, which is the number in files.
using LobeList = std::tuple<MattLobe, GgxLobe, BlinnPhongLobe, GgxWholeLobe, MeasuredLobe>;

inline constexpr std::size_t NumHighlights = std::tuple_size_v<LobeList>;
static_assert([]<std::size_t... I>(std::index_sequence<I...>) {
    return ((static_cast<std::size_t>(std::tuple_element_t<I, LobeList>::Kind) == I) && ...);
}(std::make_index_sequence<NumHighlights>{}));

/// Returns what `use` returns for the lobe of a highlight.
template<typename Use, std::size_t I = 0>
auto with_lobe(Highlight highlight, const Use& use) {
    if constexpr (I + 1 < NumHighlights)
        if (static_cast<std::size_t>(highlight) != I)
            return with_lobe<Use, I + 1>(highlight, use);
    return use(std::tuple_element_t<I, LobeList>{});
}

[[nodiscard]] inline const LobeFacts& facts_of(Highlight highlight) {
    return *with_lobe(highlight, []<typename Lobe>(Lobe) { return &Lobe::Facts; });
}

/// Returns the angle over which a highlight changes, as seen from the light: twice the angle of the
/// half vector. 0 for none.
[[nodiscard]] inline float narrowness_of(const Surface& surface) {
    return with_lobe(surface.highlight,
                     [&](auto lobe) { return lobe.narrowness(surface.roughness_or_exponent); });
}

} // namespace relumine::prt
