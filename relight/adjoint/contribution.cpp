#include "relight/adjoint/contribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/adjoint/adjoint.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

/// Texels whose centres lie in a cell. Where there is none, the texel that holds the cell's centre.
struct TexelSpan {
    std::uint32_t x0, y0, x1, y1;
};

std::pair<std::uint32_t, std::uint32_t> centres_between(double low, double high,
                                                        std::uint32_t resolution) {
    const double r = resolution;
    const auto begin = static_cast<std::uint32_t>(std::ceil(low * r - 0.5));
    const auto end = static_cast<std::uint32_t>(std::ceil(high * r - 0.5));
    if (begin < end)
        return {begin, end};
    const auto middle =
        std::min(static_cast<std::uint32_t>(0.5 * (low + high) * r), resolution - 1);
    return {middle, middle + 1};
}

TexelSpan texels_of(const prt::Cell& cell, std::uint32_t resolution) {
    const double size = cell.size();
    const auto [x0, x1] = centres_between(cell.x * size, (cell.x + 1) * size, resolution);
    const auto [y0, y1] = centres_between(cell.y * size, (cell.y + 1) * size, resolution);
    return {x0, y0, x1, y1};
}

/// Spreads contributions over the texels they come from.
class Spreader {
public:
    explicit Spreader(const cubemap::CubeMap& environment)
        : environment_(environment), map_(environment.resolution),
          taken_(environment.texels.size()),
          solid_angles_(cubemap::texel_solid_angles(environment.resolution)) {}

    /// Adds `radiance`, which came from the cell, to its texels that are not taken yet, in
    /// proportion to their radiance. With `take`, the texels are taken afterwards.
    void spread(const prt::Cell& cell, const glm::dvec3& radiance, bool take) {
        if (radiance == glm::dvec3(0.0))
            return;
        const TexelSpan span = texels_of(cell, environment_.resolution);
        glm::dvec3 power(0.0);
        double solid_angle = 0.0;
        for_each(cell.face, span, [&](std::size_t texel, double dw) {
            power += glm::dvec3(environment_.texels[texel]) * dw;
            solid_angle += dw;
        });
        for_each(cell.face, span, [&](std::size_t texel, double) {
            for (int channel = 0; channel < 3; ++channel) {
                // A cell smaller than a texel may have its light from a texel whose centre is
                // elsewhere.
                const double share =
                    power[channel] > 0.0
                        ? static_cast<double>(environment_.texels[texel][channel]) / power[channel]
                        : 1.0 / solid_angle;
                map_.texels[texel][channel] += static_cast<float>(radiance[channel] * share);
            }
        });
        if (take)
            for_each(cell.face, span, [&](std::size_t texel, double) { taken_[texel] = true; });
    }

    cubemap::CubeMap take() { return std::move(map_); }

private:
    template<class Visit>
    void for_each(cubemap::Face face, const TexelSpan& span, const Visit& visit) const {
        // If sharp lights took all texels of the cluster, the rest of its light goes to all of
        // them.
        for (const bool all : {false, true}) {
            bool any = false;
            for (std::uint32_t y = span.y0; y < span.y1; ++y)
                for (std::uint32_t x = span.x0; x < span.x1; ++x) {
                    const std::size_t texel = environment_.index(face, x, y);
                    if (taken_[texel] && !all)
                        continue;
                    visit(texel, solid_angles_[std::size_t{y} * environment_.resolution + x]);
                    any = true;
                }
            if (any)
                return;
        }
    }

    const cubemap::CubeMap& environment_;
    cubemap::CubeMap map_;
    std::vector<bool> taken_;
    std::vector<double> solid_angles_;
};

/// What clusters and sharp lights give to the weighted sum of radiance.
struct Given {
    std::vector<glm::dvec3> by_clusters;
    std::vector<glm::dvec3> by_sharp;
};

/// Returns the places of the receivers that have a weight, of `begin` to `end`.
std::vector<std::size_t> weighted_places(std::span<const std::uint32_t> order,
                                         std::span<const glm::vec3> weights, std::size_t begin,
                                         std::size_t end) {
    std::vector<std::size_t> places;
    for (std::size_t place = begin; place < end; ++place)
        if (weights[order[place]] != glm::vec3(0.0f))
            places.push_back(place);
    return places;
}

/// Returns what is given to points in space, whose radiance is the mean over the sphere.
Given given_to_points(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const ReceiverLight& light = relighter.receiver_light();
    const std::span<const std::uint32_t> order = relighter.transfer().order;
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    const std::vector<std::size_t> places =
        weighted_places(order, weights, 0, relighter.transfer().num_points);
    Given given{std::vector<glm::dvec3>(relighter.transfer().num_clusters()),
                std::vector<glm::dvec3>(sharp.size())};
    files::parallel_for(std::size_t{0}, given.by_clusters.size(), [&](std::size_t cluster) {
        for (const std::size_t place : places)
            given.by_clusters[cluster] +=
                glm::dvec3(weights[order[place]]) * light.mean_from_cluster(cluster) *
                static_cast<double>(relighter.transfer().counts.count(place, cluster));
    });
    for (std::size_t i = 0; i < sharp.size(); ++i) {
        const std::span<const std::uint16_t> reached = light.traced().reached(sharp[i]);
        const VectorIrradiance& e = sharp[i].irradiance;
        for (const std::size_t place : places)
            if ((reached[place / prt::BlockSize] >> (place % prt::BlockSize) & 1u) != 0)
                given.by_sharp[i] += glm::dvec3(weights[order[place]]);
        given.by_sharp[i] *=
            glm::dvec3(glm::length(e.red), glm::length(e.green), glm::length(e.blue)) *
            (0.25 * std::numbers::inv_pi);
    }
    return given;
}

/// Returns what a receiver has from one cluster, without its sharp lights, as light_tile() has it.
glm::dvec3 from_cluster(const prt::Transfer& transfer, const ReceiverLight& light,
                        std::size_t place, std::size_t cluster) {
    const auto count = static_cast<double>(transfer.counts.count(place, cluster));
    if (count == 0.0)
        return glm::dvec3(0.0);
    const std::size_t block = place / prt::BlockSize, word = cluster / 64;
    const std::size_t tile = block / prt::VisibleCounts::TileBlocks;
    const BlockScene scene = light.block_scene();
    const std::uint64_t bit = std::uint64_t{1} << (cluster % 64);
    const bool is_whole =
        (transfer.counts.visible[transfer.counts.word(block, word)] & bit) != 0 &&
        (scene.words.across_of(scene.words.words[tile * transfer.counts.words_per_block() + word],
                               block - transfer.counts.tile_begin(tile)) &
         bit) == 0;
    const ClusterLights& lights = light.cluster_lights();
    const glm::dvec3 normal(transfer.normals[place]);
    const auto along = [&](const float* v) {
        return normal.x * static_cast<double>(v[0]) + normal.y * static_cast<double>(v[1]) +
               normal.z * static_cast<double>(v[2]);
    };
    if (is_whole || lights.is_spread(cluster)) {
        const float* e = lights.vectors.data() + cluster * ClusterLights::Stride;
        const glm::dvec3 given(along(e), along(e + 3), along(e + 6));
        return count * (is_whole ? given : glm::max(given, 0.0));
    }
    const float* d = lights.directionals.data() + cluster * ClusterLights::DirectionalStride;
    return count * std::max(along(d), 0.0) * glm::dvec3(d[3], d[4], d[5]);
}

/// Asks the few receivers of `places` alone.
Given given_to_few(const Relighter& relighter, std::span<const glm::vec3> weights,
                   std::span<const std::size_t> places) {
    const prt::Transfer& transfer = relighter.transfer();
    const ReceiverLight& light = relighter.receiver_light();
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    Given given{std::vector<glm::dvec3>(transfer.num_clusters()),
                std::vector<glm::dvec3>(sharp.size())};
    constexpr std::size_t Grain = 256;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, given.by_clusters.size(), Grain),
        [&](const auto& clusters) {
            for (std::size_t cluster = clusters.begin(); cluster < clusters.end(); ++cluster)
                for (const std::size_t place : places)
                    given.by_clusters[cluster] += glm::dvec3(weights[transfer.order[place]]) *
                                                  from_cluster(transfer, light, place, cluster);
        });
    for (std::size_t i = 0; i < sharp.size(); ++i) {
        const std::span<const std::uint16_t> reached = light.traced().reached(sharp[i]);
        for (const std::size_t place : places)
            if ((reached[place / prt::BlockSize] >> (place % prt::BlockSize) & 1u) != 0)
                given.by_sharp[i] += glm::dvec3(weights[transfer.order[place]]) *
                                     sharp[i].irradiance.on(transfer.normals[place]) *
                                     std::numbers::inv_pi;
    }
    return given;
}

Given given_to_surfaces(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const prt::Transfer& transfer = relighter.transfer();
    // So many cost less than a walk through the whole transfer.
    constexpr std::size_t Few = 64;
    if (const std::vector<std::size_t> places =
            weighted_places(transfer.order, weights, transfer.num_points, transfer.num_receivers());
        places.size() <= Few)
        return given_to_few(relighter, weights, places);
    LightDerivative derivative = light_derivative(relighter, weights);
    return {std::move(derivative.given_by_clusters), std::move(derivative.given_by_sharp)};
}

Given given_to(const Relighter& relighter, std::span<const glm::vec3> weights) {
    Given given = given_to_surfaces(relighter, weights);
    if (relighter.transfer().num_points == 0)
        return given;
    const Given more = given_to_points(relighter, weights);
    for (std::size_t i = 0; i < more.by_clusters.size(); ++i)
        given.by_clusters[i] += more.by_clusters[i];
    for (std::size_t i = 0; i < more.by_sharp.size(); ++i)
        given.by_sharp[i] += more.by_sharp[i];
    return given;
}

} // namespace

cubemap::CubeMap contribution_map(const Relighter& relighter,
                                  std::span<const std::uint32_t> receivers,
                                  const SurfaceBounces* bounces) {
    const prt::Transfer& transfer = relighter.transfer();
    if (receivers.empty())
        throw std::invalid_argument("expected at least one receiver");
    std::vector<glm::vec3> weights(transfer.num_receivers(), glm::vec3(0.0f));
    const float share = 1.0f / static_cast<float>(receivers.size());
    for (const std::uint32_t receiver : receivers) {
        if (receiver >= weights.size())
            throw std::invalid_argument("expected an index of a receiver");
        weights[receiver] += share;
    }
    if (bounces != nullptr) {
        const std::vector<glm::vec3> bounced = bounce_adjoint(*bounces, transfer, weights);
        for (std::size_t i = 0; i < weights.size(); ++i)
            weights[i] += bounced[i];
    }

    const Given given = given_to(relighter, weights);
    const std::span<const prt::Cell> cells = transfer.quadtree.leaves();
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    Spreader spreader(relighter.environment());
    for (std::size_t i = 0; i < sharp.size(); ++i)
        spreader.spread(sharp[i].cell, given.by_sharp[i], true);
    for (std::size_t cluster = 0; cluster < cells.size(); ++cluster)
        spreader.spread(cells[cluster], given.by_clusters[cluster], false);
    return spreader.take();
}

} // namespace relumine::relight
