// The list "layers" of a layer file, where it is part of another JSON text.
#pragma once

#include <filesystem>
#include <vector>

#include "cubemap/layers/light_layer.h"
#include "files/json_reader.h"

namespace relumine::cubemap {

/// Returns the layers of a JSON array. Pictures that they name are looked for in the folder.
///
/// Throws:  std::runtime_error "NAME:LINE: expected X, got Y", as load_layers().
[[nodiscard]] std::vector<LightLayer> read_layers(const files::JsonReader& json,
                                                  const files::Json& list,
                                                  const std::filesystem::path& folder);

} // namespace relumine::cubemap
