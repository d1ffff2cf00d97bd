// The looks that a glTF file offers: KHR_materials_variants.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/formats/gltf_document.h"

namespace relumine::mesh::gltf {

/// Returns the names of the file's variants, in its order.
[[nodiscard]] std::vector<std::string> variants(const Document& document);

/// Returns the number of a variant; of equal names it is the first.
/// Throws:  std::runtime_error "expected X, got Y" for a name that the file does not have.
[[nodiscard]] std::uint64_t variant(const Document& document, const std::string& name);

} // namespace relumine::mesh::gltf
