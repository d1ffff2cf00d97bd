// Compressed data that tests write: Draco, meshoptimizer, WebP.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::mesh {

/// A mesh for Draco. Unique ids: 7 for positions, 5 for normals, 3 for uvs, 1 for colours (bytes,
/// normalised). Empty arrays are left out.
struct DracoSource {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<std::array<std::uint8_t, 4>> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// 0: floats are kept as they are.
    int quantization_bits = 0;
    /// True: vertices keep their order. False: Edgebreaker, which turns and sorts triangles.
    bool is_sequential = true;
    /// True: data of points without faces.
    bool is_point_cloud = false;
};
[[nodiscard]] std::string draco_data(const DracoSource& source);

/// For EXT_meshopt_compression: elements of `stride` bytes, indices of triangles, other indices.
[[nodiscard]] std::string meshopt_attributes(const std::string& values, std::size_t stride);
[[nodiscard]] std::string meshopt_triangles(const std::vector<std::uint32_t>& indices);
[[nodiscard]] std::string meshopt_indices(const std::vector<std::uint32_t>& indices);

/// A lossless WebP file of RGBA pixels, the top row first.
[[nodiscard]] std::string webp(int width, int height,
                               const std::vector<std::array<std::uint8_t, 4>>& pixels);

} // namespace relumine::mesh
