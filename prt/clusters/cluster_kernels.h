// The two inner loops of the clustering, over all receivers and one cell's nine samples. Vectorised
// with run-time dispatch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/lattice.h"
#include "prt/transfer/visible_counts.h"
#include "prt/visibility/bit_matrix.h"

namespace relumine::prt {

/// Normals of the receivers, coordinates apart. A direction d has the cosine x dx + y dy + z dz +
/// w: w is 1 for points without a surface, whose normals are zero, and 0 for all others.
///
/// Shape:   [num_words * 64] each; zero after the last receiver.
struct NormalArrays {
    std::vector<float> x, y, z, w;
    NormalArrays() = default;
    explicit NormalArrays(std::span<const glm::vec3> normals, std::size_t num_points = 0);
    [[nodiscard]] std::size_t num_words() const { return x.size() / WordSize; }
};

/// One cell's nine directions, and for each a plane of bits: the light from there reaches the
/// receiver.
///
/// Shape:   each plane is [num_words].
struct CellSamples {
    std::array<glm::vec3, SamplesPerCell> directions{};
    std::array<const std::uint64_t*, SamplesPerCell> lit{};
};

/// The unit of squared_distances().
inline constexpr double SquaredDistanceUnit = 0x1p-30;

/// Returns ||T_C - T_l||^2 for all nine samples l, where T = V max(n.w, 0), which is the transfer
/// times pi (V alone for points without a surface), and T_C is the weighted mean [JN, Eqs. 9-11].
///
/// Unit:    SquaredDistanceUnit. Each run of 1,024 receivers contributes a whole number, so sums
///          over parts of the receivers that begin at runs add up to the sum over all, exactly.
///          2^32 receivers stay below 2^63.
[[nodiscard]] std::array<std::int64_t, SamplesPerCell>
squared_distances(const NormalArrays& normals, const CellSamples& samples);

/// Returns the visible counts of the cell for all receivers. A sample counts by its weight;
/// `weights` sum to 16.
[[nodiscard]] LeafColumn leaf_column(const NormalArrays& normals, const CellSamples& samples,
                                     const std::array<std::uint8_t, SamplesPerCell>& weights,
                                     std::size_t num_receivers);

/// Turns the weights of the samples that 16 receivers see into visible counts: 16 times the seen
/// part of what is above the receiver's horizon, rounded. A receiver with nothing of the cell above
/// its horizon counts 0.
///
/// Shape:   seen and above are 16 weights of samples, 0..16; seen becomes the counts.
/// Returns whether every receiver with something above its horizon counts 16.
bool divide_by_weight_above(std::span<std::uint8_t, BlockSize> seen,
                            std::span<const std::uint8_t, BlockSize> above);

/// Returns the weight of the samples whose bits are set, for 16 receivers; a sample gives 16 bits.
[[nodiscard]] std::array<std::uint8_t, BlockSize>
weights_of(const std::array<std::uint16_t, SamplesPerCell>& samples,
           const std::array<std::uint8_t, SamplesPerCell>& weights);

} // namespace relumine::prt
