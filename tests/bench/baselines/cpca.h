// Clustered principal components: receivers of a cluster share a few vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "tests/bench/baselines/packed_matrix.h"

namespace relumine::bench {

/// Rows as mean and principal vectors of their cluster [Sloan et al., SIGGRAPH 2003]: clusters by
/// distance first, then again and again by how well a cluster's vectors describe a row.
class ClusteredComponents {
public:
    /// Cost:    O(receivers x columns x components) for each of some ten rounds.
    ClusteredComponents(const BlockedRows& rows, std::size_t num_clusters,
                        std::size_t num_components);

    [[nodiscard]] std::size_t bytes() const;
    [[nodiscard]] std::vector<std::byte> content() const;
    void multiply(std::span<const glm::vec3> light, std::vector<glm::vec3>& radiance) const;

private:
    struct Cluster {
        std::vector<std::uint32_t> receivers = {};
        /// [num_components + 1][num_columns] the mean, then the principal vectors
        std::vector<float> vectors = {};
        /// [receivers][num_components + 1]; the mean's weight is 1
        PackedMatrix<std::int16_t> weights = {};
    };
    std::size_t num_receivers_;
    std::size_t num_columns_;
    std::vector<Cluster> clusters_;
};

} // namespace relumine::bench
