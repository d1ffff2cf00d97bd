// The light of clusters as spherical harmonics, as the kernels of blocks read it, and how it
// changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/transfer/quadtree.h"
#include "relight/harmonics/harmonics.h"
#include "relight/kernels/cluster_lights.h"

namespace relumine::relight {

/// Returns the coefficients of light, [channel][coefficient]. `coherence` is the length of the sum
/// of the light's directions over their number: light of one direction has 1.
///
/// A cluster's vector irradiance is its first band, exactly. The other bands take the light to be
/// spread about the vector as evenly as a whole cell: with coherence m, a flux of |E| / m, and
/// bands that fall as m and m^3.
[[nodiscard]] std::array<std::array<double, MaxHarmonics>, 3>
harmonics_of(const VectorIrradiance& light, double coherence);

/// Cells that are near each other in the sky stand for one direction where they are seen in part,
/// so that most of the work is done once for all of them.
struct HarmonicGroup {
    /// The basis functions about the group's middle.
    std::array<float, MaxHarmonics> basis{};
    /// Along the middle. The part 0.5 + dot(normal, slope), within 0 to 1, of the group is above a
    /// normal's horizon.
    std::array<float, 3> slope{};
};

/// Light of the clusters, over 16.
class ClusterHarmonics {
public:
    ClusterHarmonics(const prt::Quadtree& quadtree, std::uint32_t order);

    [[nodiscard]] std::uint32_t order() const { return order_; }
    /// Numbers of a cluster: three channels of the order's coefficients.
    [[nodiscard]] std::size_t stride() const { return 3 * num_harmonics(order_); }
    void set(std::size_t cluster, const VectorIrradiance& light);
    /// Fills `prefix`.
    void sum_prefix();

    /// Returns the coefficients of a cluster, [channel][coefficient].
    [[nodiscard]] std::span<const double> of(std::size_t cluster) const {
        return std::span(values_).subspan(cluster * stride(), stride());
    }
    /// [(num_clusters + 1) * stride] sums of coefficients over the clusters before each one.
    [[nodiscard]] std::span<const double> prefix() const { return prefix_; }
    /// [num_clusters * 3] red, green and blue of each cluster's flux.
    [[nodiscard]] std::span<const float> fluxes() const { return fluxes_; }
    /// [num_clusters] ascending.
    [[nodiscard]] std::span<const std::uint32_t> group_of() const { return group_of_; }
    [[nodiscard]] std::span<const HarmonicGroup> groups() const { return groups_; }

private:
    std::uint32_t order_;
    std::vector<double> coherences_;
    std::vector<std::uint32_t> group_of_;
    std::vector<HarmonicGroup> groups_;
    std::vector<double> values_;
    std::vector<double> prefix_;
    std::vector<float> fluxes_;
};

/// How the light of some clusters changes, clusters ascending.
struct HarmonicChanges {
    struct Word {
        /// Index of the cluster / 64.
        std::uint32_t word = 0;
        /// Changed clusters before the word's first.
        std::uint32_t first = 0;
        /// Bit cluster % 64 is set for each changed cluster.
        std::uint64_t clusters = 0;
    };
    std::vector<Word> words;
    /// [num_changed * stride] new coefficients minus old ones.
    std::vector<double> values;
    /// [words * stride] their sum over each word.
    std::vector<double> word_values;
    /// [num_changed * 3] new fluxes minus old ones.
    std::vector<double> fluxes;
    /// [num_changed]
    std::vector<std::uint32_t> groups;

    void clear();
    /// Sets the light of a cluster and notes the change.
    void set(ClusterHarmonics& lights, std::size_t cluster, const VectorIrradiance& light);
};

} // namespace relumine::relight
