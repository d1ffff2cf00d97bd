// Means of textures, for pictures whose samples are farther apart than texels.
//
// Based on: L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983 (the levels); J. McCormack et al.,
// "Feline: Fast Elliptical Lines for Anisotropic Texture Mapping", SIGGRAPH 1999 (several looks
// along the longer axis).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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

    /// Returns the mean of the unit normals of a normal map over a footprint, in tangent space:
    /// shorter where they differ. Where the footprint is within a texel, it is the bilinear value
    /// with unit length.
    [[nodiscard]] glm::vec3 normal(const TextureSlot& slot, const glm::vec2& mesh_uv,
                                   const Footprint& footprint) const;

private:
    class Pyramid;
    enum class Kind : std::uint8_t { Linear, Srgb, Normals };
    static constexpr std::size_t NumKinds = 3;
    [[nodiscard]] std::optional<glm::vec3> mean(const TextureSlot& slot, const glm::vec2& mesh_uv,
                                                const Footprint& footprint, Kind kind) const;

    const std::vector<Texture>* textures_;
    /// [textures][kinds]
    std::unique_ptr<Pyramid[]> pyramids_;
};

} // namespace relumine::mesh
