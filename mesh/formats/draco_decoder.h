// Decodes Draco meshes. The only user of libdraco.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::mesh {

/// An attribute that decode_draco() returns.
struct DracoAttribute {
    /// Its unique id in the data.
    std::uint32_t id = 0;
    std::uint32_t num_components = 0;
    /// True: integers become 0..1 or -1..1.
    bool is_normalized = false;
};

/// A decoded mesh.
struct DracoMesh {
    std::size_t num_vertices = 0;
    /// Every index < num_vertices.
    std::vector<std::array<std::uint32_t, 3>> triangles = {};
    /// For each attribute that was asked for, [num_vertices x num_components].
    std::vector<std::vector<float>> values = {};
};

/// Decodes a mesh and some of its attributes. Quantised attributes are dequantised.
/// Throws:  std::runtime_error "expected X, got Y" for data that are broken in any way, hold a
///          point cloud, or lack one of the attributes or its components.
[[nodiscard]] DracoMesh decode_draco(std::span<const std::byte> data,
                                     std::span<const DracoAttribute> attributes);

} // namespace relumine::mesh
