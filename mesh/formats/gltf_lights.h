// KHR_lights_punctual.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>

#include "mesh/formats/gltf_document.h"
#include "mesh/materials/punctual_light.h"

namespace relumine::mesh::gltf {

/// Returns the light that stands at a node, placed by the node's world matrix; none where there is
/// none. A light of Blender is as bright beside emission as in Blender. It has the node's name, or
/// its own. Numbers out of range are brought into it, and `warnings` says so.
///
/// Throws:  std::runtime_error "expected X, got Y" for a kind of light or an index that is not
///          there.
[[nodiscard]] std::optional<PunctualLight> light_at(const Document& document, const Json& node,
                                                    const glm::dmat4& world,
                                                    std::vector<std::string>& warnings);

/// A line on how light_at() understands the unit of the file's lights, if not as the numbers are.
[[nodiscard]] std::optional<std::string> unit_of_lights(const Document& document);

} // namespace relumine::mesh::gltf
