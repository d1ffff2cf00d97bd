// Decodes buffer views of KHR_meshopt_compression and EXT_meshopt_compression. The only user of
// libmeshoptimizer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumine::mesh {

/// The codecs pack at most this many bytes into one: 16 that are equal take two bits.
inline constexpr std::uint64_t MaxMeshoptRatio = 64;

/// What the extension says about a buffer view.
struct MeshoptView {
    std::uint64_t count = 0;
    /// Bytes of an element.
    std::uint64_t stride = 0;
    /// ATTRIBUTES, TRIANGLES or INDICES.
    std::string mode;
    /// NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR.
    std::string filter = "NONE";
};

/// Decodes a buffer view, [count x stride].
/// Throws:  std::runtime_error "expected X, got Y" for data that are broken, a mode, filter or
///          stride that the extension does not have, or more elements than the data can hold.
[[nodiscard]] std::vector<std::byte> decode_meshopt(std::span<const std::byte> data,
                                                    const MeshoptView& view);

} // namespace relumine::mesh
