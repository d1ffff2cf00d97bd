// Arrays of a glTF file.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/gltf_document.h"

namespace relumine::mesh::gltf {

/// Values of an accessor as floats, [count x num_components]; normalised integers become 0..1 or
/// -1..1. Where it has more components (the alpha of a colour) the rest is dropped.
struct Floats {
    std::size_t count = 0;
    std::vector<float> values = {};
};
[[nodiscard]] Floats read_floats(Document& document, std::uint64_t accessor,
                                 std::uint32_t num_components);

/// Values of an accessor of unsigned integers, one component.
[[nodiscard]] std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t accessor);

} // namespace relumine::mesh::gltf
