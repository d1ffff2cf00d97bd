// Transport in the bases that others relight with: each is a matrix of rows, and a way to write an
// environment in the same basis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/transfer/transfer.h"
#include "tests/bench/baselines/dense_transport.h"
#include "tests/bench/baselines/packed_matrix.h"

namespace relumine::bench {

/// Radiance of a receiver = its row times project(environment).
struct Features {
    BlockedRows rows;
    std::function<std::vector<glm::vec3>(const cubemap::CubeMap&)> project;
};

/// Real, orthonormal spherical harmonics of orders up to `order`, by band and index from -band:
/// [order^2]. R. Green, "Spherical Harmonic Lighting: The Gritty Details", 2003.
[[nodiscard]] std::vector<double> spherical_harmonics(const glm::dvec3& direction,
                                                      std::uint32_t order);

/// How much of a band is kept, so that truncation rings less.
enum class Window { None, Hann };

/// Transport in spherical harmonics [Sloan et al., SIGGRAPH 2002].
class HarmonicTransport {
public:
    /// Projects all rows. Parallel.
    HarmonicTransport(const DenseTransport& transport, std::uint32_t max_order);
    /// This must outlive what is returned. `order` is at most max_order.
    [[nodiscard]] Features features(std::uint32_t order, Window window) const;

private:
    std::size_t num_receivers_;
    std::uint32_t max_order_;
    /// [num_blocks][max_order^2][16]
    std::vector<float> values_;
};

/// Texels of a cube map, at the transport's resolution or a coarser one. The transport must outlive
/// what is returned.
[[nodiscard]] Features texel_features(const DenseTransport& transport, std::uint32_t resolution);

/// Haar's orthonormal wavelets in two dimensions on each face [Ng et al., SIGGRAPH 2003], in place.
///
/// Shape:   values is [6 R R][lanes] in the order of a cube map's texels; R is a power of two.
void transform_faces(std::span<float> values, std::uint32_t resolution, std::size_t lanes);

/// The same basis of all texels. The transport must outlive what is returned.
[[nodiscard]] Features wavelet_features(const DenseTransport& transport);

/// Clusters of a precompute, T_C dw_C with the direction of each cluster's middle [JN, Eq. 8]. The
/// transfer must outlive what is returned.
[[nodiscard]] Features cluster_features(const prt::Transfer& transfer);

} // namespace relumine::bench
