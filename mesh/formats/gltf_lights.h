// KHR_lights_punctual.
#pragma once

#include <optional>

#include <glm/mat4x4.hpp>

#include "mesh/formats/gltf_document.h"
#include "mesh/materials/punctual_light.h"

namespace relumine::mesh::gltf {

/// Returns the light that stands at a node, placed by the node's world matrix; none where there is
/// none. It has the node's name, or its own.
///
/// Throws:  std::runtime_error "expected X, got Y" for a light that the extension does not allow.
[[nodiscard]] std::optional<PunctualLight> light_at(const Document& document, const Json& node,
                                                    const glm::dmat4& world);

} // namespace relumine::mesh::gltf
