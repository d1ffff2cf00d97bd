#include "relight/adjoint/transport.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

using Vectors = std::array<glm::dvec3, 3>;

Vectors channels_of(const VectorIrradiance& light) {
    return {light.red, light.green, light.blue};
}

glm::dvec3 lengths_of(const Vectors& channels) {
    return {glm::length(channels[0]), glm::length(channels[1]), glm::length(channels[2])};
}

/// Returns directions of the channels. One without light has that of the whole.
Vectors directions_of(const Vectors& channels, const glm::dvec3& lengths, const glm::dvec3& whole) {
    Vectors result;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double length = lengths[static_cast<int>(channel)];
        result[channel] = length > 0.0 ? channels[channel] / length : whole;
    }
    return result;
}

glm::dvec3 cosines(const glm::dvec3& normal, const Vectors& directions) {
    return {glm::dot(normal, directions[0]), glm::dot(normal, directions[1]),
            glm::dot(normal, directions[2])};
}

/// A cluster's light over its length, as the kernels have it.
class UnitLight {
public:
    UnitLight(const ClusterLights& lights, std::size_t cluster, const prt::Cell& cell)
        : is_spread_(lights.is_spread(cluster)) {
        // The kernels' lights are over what a full count stands for.
        constexpr double Scale = static_cast<double>(prt::FullCount) * std::numbers::pi;
        const float* v = lights.vectors.data() + cluster * ClusterLights::Stride;
        Vectors vectors;
        for (std::size_t channel = 0; channel < 3; ++channel)
            vectors[channel] = {v[3 * channel], v[3 * channel + 1], v[3 * channel + 2]};
        const glm::dvec3 lengths = lengths_of(vectors);
        const float* d = lights.directionals.data() + cluster * ClusterLights::DirectionalStride;
        direction_ = {d[0], d[1], d[2]};
        if (direction_ == glm::dvec3(0.0))
            direction_ = cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                            (cell.y + 0.5) * cell.size());
        channels_ = directions_of(vectors, lengths, direction_);
        for (int channel = 0; channel < 3; ++channel)
            if (lengths[channel] > 0.0)
                colour_[channel] = static_cast<double>(d[3 + channel]) / lengths[channel];
        light = Scale * lengths;
    }

    /// What a receiver that sees all of the cluster has of a light of length 1, over 1/pi. `whole`:
    /// all of its block does, and no cell lies across a horizon.
    [[nodiscard]] glm::dvec3 on(const glm::dvec3& normal, bool whole) const {
        if (whole)
            return cosines(normal, channels_);
        if (is_spread_)
            return glm::max(cosines(normal, channels_), 0.0);
        return std::max(glm::dot(normal, direction_), 0.0) * colour_;
    }

    glm::dvec3 light;

private:
    bool is_spread_;
    Vectors channels_;
    glm::dvec3 direction_;
    /// The colour of the directional light, over the length of the vector.
    glm::dvec3 colour_{1.0};
};

/// Walks through rows.
class Rows {
public:
    explicit Rows(const Relighter& relighter)
        : transfer_(relighter.transfer()), light_(relighter.receiver_light()),
          scene_(light_.block_scene()), sharp_(relighter.sharp_lights()),
          is_traced_(light_.traced().is_traced()) {
        const std::span<const prt::Cell> cells = transfer_.quadtree.leaves();
        clusters_.reserve(cells.size());
        for (std::size_t cluster = 0; cluster < cells.size(); ++cluster)
            clusters_.emplace_back(light_.cluster_lights(), cluster, cells[cluster]);
        for (const SharpLight& light : sharp_) {
            const Vectors channels = channels_of(light.irradiance);
            sharp_directions_.push_back(
                directions_of(channels, lengths_of(channels), light.direction));
        }
    }

    [[nodiscard]] std::vector<glm::dvec3> light() const {
        std::vector<glm::dvec3> result;
        result.reserve(clusters_.size() + sharp_.size());
        for (std::size_t cluster = 0; cluster < clusters_.size(); ++cluster)
            result.push_back(transfer_.num_points != 0
                                 ? light_.mean_from_cluster(cluster) *
                                       (4.0 * std::numbers::pi * prt::FullCount)
                                 : clusters_[cluster].light);
        for (const SharpLight& light : sharp_)
            result.push_back(lengths_of(channels_of(light.irradiance)));
        return result;
    }

    /// Calls entry(column, value of each channel) for what reaches the receiver at a place.
    template<typename Entry>
    void visit(std::size_t place, const Entry& entry) const {
        const glm::dvec3 scale =
            (transfer_.surfaces.empty() ? glm::dvec3(1.0)
                                        : glm::dvec3(transfer_.surfaces[place].albedo)) *
            std::numbers::inv_pi;
        const glm::dvec3 normal(transfer_.normals[place]);
        const auto give = [&](std::size_t column, const glm::dvec3& value) {
            if (const glm::dvec3 scaled = scale * value; scaled != glm::dvec3(0.0))
                entry(static_cast<std::uint32_t>(column), scaled);
        };
        for (std::size_t word = 0; word < transfer_.counts.words_per_block(); ++word)
            visit_word(place, word, normal, give);
        // Under a relighter without shadow rays their light is in the clusters.
        for (std::size_t i = 0; is_traced_ && i < sharp_.size(); ++i)
            if ((light_.traced().reached(i, place / prt::BlockSize) >> (place % prt::BlockSize) &
                 1u) != 0)
                give(clusters_.size() + i,
                     place < transfer_.num_points
                         ? glm::dvec3(0.25)
                         : glm::max(cosines(normal, sharp_directions_[i]), 0.0));
    }

private:
    /// What a surface has of a cluster's vector, per what light() says: beside points it has the
    /// cluster's flux, of which the vector is a part.
    [[nodiscard]] double per_flux(std::size_t cluster) const {
        return transfer_.num_points == 0 ? 1.0
                                         : light_.harmonic_light()->lights().coherence(cluster);
    }

    template<typename Give>
    void visit_word(std::size_t place, std::size_t w, const glm::dvec3& normal,
                    const Give& give) const {
        constexpr double PerCount = 1.0 / prt::FullCount;
        const prt::VisibleCounts& counts = transfer_.counts;
        const std::size_t block = place / prt::BlockSize;
        const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
        const std::size_t word = counts.word(block, w);
        const std::uint64_t across =
            scene_.words.across_of(scene_.words.words[tile * counts.words_per_block() + w],
                                   block - counts.tile_begin(tile));
        for (std::uint64_t bits = counts.visible[word] | counts.mixed[word]; bits != 0;
             bits &= bits - 1) {
            const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
            const std::size_t cluster = w * 64 + bit;
            const bool is_mixed = (counts.mixed[word] >> bit & 1u) != 0;
            const double count =
                is_mixed ? PerCount * counts.mixed_counts(word, bit)[place % prt::BlockSize] : 1.0;
            if (count == 0.0)
                continue;
            const bool is_whole = !is_mixed && (across >> bit & 1u) == 0;
            if (place < transfer_.num_points)
                give(cluster, glm::dvec3(0.25 * count));
            else
                give(cluster, count * per_flux(cluster) * clusters_[cluster].on(normal, is_whole));
        }
    }

    const prt::Transfer& transfer_;
    const ReceiverLight& light_;
    BlockScene scene_;
    std::span<const SharpLight> sharp_;
    bool is_traced_;
    std::vector<UnitLight> clusters_;
    std::vector<Vectors> sharp_directions_;
};

/// Returns where rows begin, given their lengths.
std::vector<std::uint32_t> begins_of(std::span<const std::uint32_t> lengths,
                                     std::size_t max_entries) {
    const std::size_t most =
        std::min<std::size_t>(max_entries, std::numeric_limits<std::int32_t>::max());
    std::vector<std::uint32_t> result = {0};
    result.reserve(lengths.size() + 1);
    std::size_t sum = 0;
    for (const std::uint32_t length : lengths) {
        sum += length;
        result.push_back(static_cast<std::uint32_t>(std::min(sum, most)));
    }
    if (sum > most)
        throw std::invalid_argument(
            fmt::format("expected a matrix of at most {} entries, got one of {}", most, sum));
    return result;
}

} // namespace

Transport transport(const Relighter& relighter, const TransportOptions& options) {
    const prt::Transfer& transfer = relighter.transfer();
    if (transfer.glossy)
        throw std::invalid_argument("expected receivers without highlights, got some with");
    const Rows rows(relighter);
    const std::size_t num_receivers = transfer.num_receivers();
    std::vector<std::uint32_t> lengths(num_receivers);
    files::parallel_for(std::size_t{0}, num_receivers, [&](std::size_t place) {
        std::uint32_t& length = lengths[transfer.order[place]];
        rows.visit(place, [&](std::uint32_t, const glm::dvec3&) { ++length; });
    });

    Transport result;
    result.row_begins = begins_of(lengths, options.max_entries);
    result.light = rows.light();
    result.columns.resize(result.row_begins.back());
    for (std::vector<float>& channel : result.data)
        channel.resize(result.columns.size());
    files::parallel_for(std::size_t{0}, num_receivers, [&](std::size_t place) {
        std::size_t at = result.row_begins[transfer.order[place]];
        rows.visit(place, [&](std::uint32_t column, const glm::dvec3& value) {
            result.columns[at] = column;
            for (std::size_t channel = 0; channel < 3; ++channel)
                result.data[channel][at] = static_cast<float>(value[static_cast<int>(channel)]);
            ++at;
        });
    });
    return result;
}

} // namespace relumine::relight
