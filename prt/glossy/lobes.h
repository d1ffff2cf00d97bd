// The parts of a BRDF.
#pragma once

#include <array>
#include <cstddef>

#include "prt/transfer/glossy_transfer.h"

namespace relumine::prt {

/// The scalar lobes for one light: BRDF times cosine without colours. Also used for sums of
/// radiance times lobe.
///
/// Unit:    1/sr.
template<typename Value>
struct Lobes {
    /// D
    Value diffuse{};
    /// Dc: the part that Fresnel takes from D.
    Value diffuse_grazing{};
    /// S
    Value specular{};
    /// Sc: the part of S that Fresnel makes white.
    Value specular_grazing{};
    /// What a clear coat mirrors, its Fresnel included.
    Value coat{};
    /// Sheen, without its colour.
    Value sheen{};
};

/// The parts that depend on the view, by GlossyLobe.
template<typename Value>
inline constexpr std::array<Value Lobes<Value>::*, NumGlossyLobes> GlossyParts = {
    &Lobes<Value>::specular, &Lobes<Value>::specular_grazing, &Lobes<Value>::diffuse_grazing,
    &Lobes<Value>::coat, &Lobes<Value>::sheen};

/// Returns the same lobes as values of another type.
template<typename To, typename From>
[[nodiscard]] Lobes<To> converted(const Lobes<From>& lobes) {
    Lobes<To> result{.diffuse = To(lobes.diffuse)};
    for (std::size_t i = 0; i < NumGlossyLobes; ++i)
        result.*GlossyParts<To>[i] = To(lobes.*GlossyParts<From>[i]);
    return result;
}

/// Adds lobes times a factor.
template<typename Value, typename Factor>
void add_scaled(Lobes<Value>& sum, const Lobes<Value>& lobes, const Factor& factor) {
    sum.diffuse += factor * lobes.diffuse;
    for (const auto part : GlossyParts<Value>)
        sum.*part += factor * lobes.*part;
}

template<typename Value, typename Factor>
void multiply(Lobes<Value>& lobes, const Factor& factor) {
    lobes.diffuse *= factor;
    for (const auto part : GlossyParts<Value>)
        lobes.*part *= factor;
}

} // namespace relumine::prt
