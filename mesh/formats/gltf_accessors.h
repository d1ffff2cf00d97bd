// Arrays of a glTF file.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/formats/gltf_document.h"

namespace relumine::mesh::gltf {

/// Values of an accessor as floats, [count x num_components]. Normalised integers become 0..1 or
/// -1..1. Components beyond num_components are dropped, for example the alpha of a colour.
struct Floats {
    std::size_t count = 0;
    std::vector<float> values = {};
};
/// Reads an accessor as floats.
[[nodiscard]] Floats read_floats(Document& document, std::uint64_t accessor,
                                 std::uint32_t num_components);

/// Returns how many components an accessor has: 3 for VEC3.
[[nodiscard]] std::uint32_t num_components(const Document& document, std::uint64_t accessor);

/// Returns the values of an accessor of unsigned integers with one component.
[[nodiscard]] std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t accessor);

} // namespace relumine::mesh::gltf
