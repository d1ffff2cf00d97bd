// What a glTF file says of surfaces and scenes that no picture will show.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh/formats/gltf_document.h"

namespace relumine::mesh {
struct GltfOptions;
}

namespace relumine::mesh::gltf {

/// Returns one line for each kind of thing that the file has and the reader leaves out, with what
/// the picture loses. Values that change nothing, such as a clear coat of factor 0, do not count.
/// Extensions outside of materials are Document::warnings().
[[nodiscard]] std::vector<std::string> left_out(const Document& document,
                                                const GltfOptions& options);

/// Returns whether left_out() looks for an extension at the materials themselves.
[[nodiscard]] bool is_of_materials(std::string_view extension);

} // namespace relumine::mesh::gltf
