// The light of clusters as spherical harmonics, as the kernels of blocks read it, and how it
// changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// Clusters that are near each other in the sky. Where receivers see them in part they stand for
/// the mean direction of their light, so that most of the work is done once for all of them.
struct HarmonicGroup {
    /// Along the middle. The part 0.5 + dot(normal, slope), within 0 to 1, of the group is above a
    /// normal's horizon.
    std::array<float, 3> slope{};
    /// The basis functions about the middle, which stand for a group without light.
    std::array<float, MaxHarmonics> middle{};
    /// The group's clusters.
    std::uint32_t begin = 0, end = 0;
};

/// A line of the cache.
struct alignas(64) EightDoubles {
    std::array<double, 8> numbers{};
};

/// Light of the clusters, over 16.
class ClusterHarmonics {
public:
    ClusterHarmonics(const prt::Quadtree& quadtree, std::uint32_t order);

    [[nodiscard]] std::uint32_t order() const { return order_; }
    /// Numbers of a cluster: three channels of the order's coefficients.
    [[nodiscard]] std::size_t stride() const { return 3 * num_harmonics(order_); }
    /// Sets the light of a cluster. sum_prefix() and sum_group() follow.
    void set(std::size_t cluster, const VectorIrradiance& light);
    /// Fills `prefix`.
    void sum_prefix();
    /// Fills `bases` of a group.
    void sum_group(std::size_t group);

    /// Returns the coefficients of a cluster, [channel][coefficient].
    [[nodiscard]] std::span<const double> of(std::size_t cluster) const {
        return std::span(values_).subspan(cluster * stride(), stride());
    }
    /// [(num_clusters + 1) * eights()] sums of coefficients over the clusters before each one.
    [[nodiscard]] std::span<const EightDoubles> prefix() const { return prefix_; }
    /// Lines of numbers that hold those of a cluster.
    [[nodiscard]] std::size_t eights() const { return (stride() + 7) / 8; }
    /// The length of the mean direction of an even cell, at most 1.
    [[nodiscard]] double coherence(std::size_t cluster) const { return coherences_[cluster]; }
    /// [num_clusters * 3] red, green and blue of each cluster's flux.
    [[nodiscard]] std::span<const float> fluxes() const { return fluxes_; }
    /// [num_clusters] ascending.
    [[nodiscard]] std::span<const std::uint32_t> group_of() const { return group_of_; }
    [[nodiscard]] std::span<const HarmonicGroup> groups() const { return groups_; }
    /// [num_groups * stride] the coefficients of each group's light, over its flux, [channel]
    /// [coefficient]. So what sees all of a group's clusters equally gets its light exactly.
    [[nodiscard]] std::span<const float> bases() const { return bases_; }

private:
    std::uint32_t order_;
    std::vector<double> coherences_;
    std::vector<std::uint32_t> group_of_;
    std::vector<HarmonicGroup> groups_;
    std::vector<double> values_;
    std::vector<EightDoubles> prefix_;
    std::vector<float> fluxes_;
    std::vector<float> bases_;
};

/// How the light of some clusters changes, clusters ascending. What sees clusters in part has
/// another mean direction of their whole group, so all clusters of changed groups count.
struct HarmonicChanges {
    struct Word {
        /// Index of the cluster / 64.
        std::uint32_t word = 0;
        /// Changed clusters before the word's first, and clusters of changed groups.
        std::uint32_t first_changed = 0, first_member = 0;
        /// Bit cluster % 64 is set for each changed cluster.
        std::uint64_t changed = 0;
        /// Bit cluster % 64 is set for each cluster of a changed group.
        std::uint64_t members = 0;
    };
    /// A cluster of a changed group.
    struct Member {
        /// Its fluxes before, negative, and now.
        std::array<double, 3> before{}, now{};
        /// Changed groups before its own.
        std::uint32_t group = 0;
    };
    std::vector<Word> words;
    /// [num_changed * stride] new coefficients minus old ones.
    std::vector<double> values;
    /// [words * stride] their sum over each word.
    std::vector<double> word_values;
    std::vector<Member> members;
    /// [num_changed_groups]
    std::vector<std::uint32_t> groups;
    /// [num_changed_groups * stride] ClusterHarmonics::bases() before and now.
    std::vector<float> bases_before, bases;

    /// Sets the light of the clusters in `changed`, which ascend, and notes how it changes.
    void set(ClusterHarmonics& lights, std::span<const std::uint32_t> changed,
             const std::function<VectorIrradiance(std::uint32_t)>& light_of);

private:
    void set_group(ClusterHarmonics& lights, std::span<const std::uint32_t> changed,
                   const std::function<VectorIrradiance(std::uint32_t)>& light_of);
    Word& word_of(std::uint32_t cluster, std::size_t stride);
};

} // namespace relumine::relight
