// Means of textures, for pictures whose samples are farther apart than texels.
//
// Based on: L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983 (the levels); J. McCormack et al.,
// "Feline: Fast Elliptical Lines for Anisotropic Texture Mapping", SIGGRAPH 1999 (several looks
// along the longer axis).
#pragma once

#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/materials/texture.h"

namespace relumine::mesh {

/// How far a mesh's uv moves from one sample of a picture to its neighbours on the right and below.
struct Footprint {
    glm::vec2 right{0.0f}, down{0.0f};
};

/// The textures of a mesh at all levels of detail. A level is made when it is first asked for.
///
/// Memory:  two thirds of the textures that are asked for.
/// Threads: any.
class MipMaps {
public:
    /// The textures must outlive this object.
    explicit MipMaps(const std::vector<Texture>& textures);
    ~MipMaps();

    /// Returns the mean of a texture over a footprint: linear light, each channel in [0, 1]. Where
    /// the footprint is within a texel, the value is that of mesh::sample().
    [[nodiscard]] glm::vec3 sample(const TextureSlot& slot, const glm::vec2& mesh_uv,
                                   const Footprint& footprint) const;

private:
    class Pyramid;
    const std::vector<Texture>* textures_;
    /// [textures][linear, sRGB]
    std::unique_ptr<Pyramid[]> pyramids_;
};

} // namespace relumine::mesh
