// The transport of a scene in full: what every baseline is a compression of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relumine/in/precompute.h"
#include "tests/bench/baselines/packed_matrix.h"

namespace relumine::bench {

/// T_j(x) dw_j of every receiver and texel j of a cube map of R x R, albedo 1, each texel's
/// visibility from nine samples. Radiance is its product with the texels' radiance.
class DenseTransport {
public:
    /// Traces every texel. `resolution` is a power of two.
    DenseTransport(const Mesh& mesh, std::uint32_t resolution);

    /// Without merging: the leaves of this scene are the texels.
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] std::uint32_t resolution() const { return resolution_; }
    [[nodiscard]] std::size_t num_receivers() const { return scene_.transfer.num_receivers(); }
    [[nodiscard]] std::size_t num_texels() const { return texels_.size(); }

    /// Rows by place of the scene's transfer, columns as the texels of a cube map.
    [[nodiscard]] BlockedRows rows() const;
    /// The same of a coarser cube map, half as fine for every step: sums of four texels.
    [[nodiscard]] BlockedRows rows(std::uint32_t coarser_resolution) const;

private:
    void read(std::size_t block, std::span<float> rows) const;

    Scene scene_;
    std::uint32_t resolution_;
    struct Texel {
        glm::vec3 direction;
        float solid_angle;
        /// In the order of a cube map's texels.
        std::uint32_t index;
    };
    /// [num_leaves]
    std::vector<Texel> texels_;
};

/// Returns the mean radiance of a map's texels at a coarser resolution that divides its own by a
/// power of two.
[[nodiscard]] std::vector<glm::vec3> mean_radiance(const cubemap::CubeMap& map,
                                                   std::uint32_t resolution);

} // namespace relumine::bench
