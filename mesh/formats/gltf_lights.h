// KHR_lights_punctual and EXT_lights_ies.
#pragma once

#include <cstdint>
#include <map>
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

/// Reads the lights with profiles of a document, and each profile once.
class ProfiledLights {
public:
    /// The document and the lists of lines must outlive this object.
    ProfiledLights(Document& document, std::vector<std::string>& warnings,
                   std::vector<std::string>& notes)
        : document_(document), warnings_(warnings), notes_(notes) {}

    /// Returns the light of EXT_lights_ies at a node, as light_at() does. A note says how bright a
    /// profile is.
    ///
    /// Throws:  as light_at(), and for a profile that is not there or cannot be read.
    [[nodiscard]] std::optional<PunctualLight> at(const Json& node, const glm::dmat4& world);

private:
    [[nodiscard]] const LightProfile& profile(std::uint64_t index, const Json& description);

    Document& document_;
    std::vector<std::string>& warnings_;
    std::vector<std::string>& notes_;
    std::map<std::uint64_t, LightProfile> profiles_;
};

/// A line on how light_at() understands the unit of the file's lights, if not as the numbers are.
[[nodiscard]] std::optional<std::string> unit_of_lights(const Document& document);

} // namespace relumine::mesh::gltf
