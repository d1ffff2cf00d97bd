#include "relight/adjoint/adjoint.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "relight/adjoint/adjoint_kernel.h"
#include "relight/adjoint/harmonic_adjoint.h"
#include "relight/adjoint/word_ranges.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

/// The light of a cluster as the kernels have it.
struct KernelLight {
    std::array<glm::dvec3, 3> vectors;
    glm::dvec3 direction;
    glm::dvec3 colour;

    KernelLight(const ClusterLights& lights, std::size_t cluster) {
        const float* v = lights.vectors.data() + cluster * ClusterLights::Stride;
        for (std::size_t channel = 0; channel < 3; ++channel)
            vectors[channel] = {v[3 * channel], v[3 * channel + 1], v[3 * channel + 2]};
        const float* d = lights.directionals.data() + cluster * ClusterLights::DirectionalStride;
        direction = {d[0], d[1], d[2]};
        colour = {d[3], d[4], d[5]};
    }
};

/// Clusters that are seen in part light from their own direction, or from one for each channel. A
/// cluster or channel without light has the direction of the cell's centre.
Gates gates_of(const ClusterLights& lights, std::span<const prt::Cell> cells) {
    Gates gates{.vectors = std::vector<float>(lights.vectors.size()), .differ = lights.spread};
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t cluster) {
        const prt::Cell& cell = cells[cluster];
        const glm::vec3 centre(cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                                  (cell.y + 0.5) * cell.size()));
        const KernelLight light(lights, cluster);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            glm::vec3 gate(lights.is_spread(cluster) ? light.vectors[channel] : light.direction);
            if (gate == glm::vec3(0.0f))
                gate = centre;
            for (int axis = 0; axis < 3; ++axis)
                gates.vectors[cluster * NumWeightSums + 3 * channel +
                              static_cast<std::size_t>(axis)] = gate[axis];
        }
    });
    return gates;
}

using Vectors = std::array<glm::dvec3, 3>;

Vectors vectors_of(const WeightSums& sums) {
    Vectors result;
    for (std::size_t channel = 0; channel < 3; ++channel)
        result[channel] = {sums[3 * channel], sums[3 * channel + 1], sums[3 * channel + 2]};
    return result;
}

/// Turns the derivative by n.E of the receivers inside of a cluster's gate, `sums`, into the
/// derivative by E, where the cluster lights as one directional light: max(n.d, 0) (E.d) for each
/// channel, where d is the direction of the luminance of E. Both E.d and d change with E.
Vectors through_direction(const Vectors& sums, const KernelLight& light) {
    const glm::dvec3& d = light.direction;
    const double length =
        glm::length(cubemap::luminance(light.vectors[0], light.vectors[1], light.vectors[2]));
    if (length == 0.0)
        return sums;
    const double per_square = 1.0 / glm::dot(d, d);
    Vectors result;
    glm::dvec3 turning(0.0);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double along = glm::dot(sums[channel], d);
        result[channel] = along * per_square * d;
        turning += light.colour[static_cast<int>(channel)] * sums[channel] +
                   along * light.vectors[channel];
    }
    turning = (turning - glm::dot(turning, d) * per_square * d) / length;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        glm::dvec3 unit(0.0);
        unit[static_cast<int>(channel)] = 1.0;
        result[channel] += cubemap::luminance(unit) * turning;
    }
    return result;
}

VectorIrradiance scaled(const Vectors& vectors, double scale) {
    return {.red = scale * vectors[0], .green = scale * vectors[1], .blue = scale * vectors[2]};
}

/// Sums the weights of all receivers into clusters. A thread has words of clusters, which nobody
/// else writes, and goes through all tiles.
ClusterWeights summed_weights(const BlockScene& scene, const Gates& gates,
                              const BlockWeights& weights) {
    ClusterWeights sums(scene.counts.num_leaves);
    for_word_ranges(scene.counts, [&](std::size_t first, std::size_t last) {
        add_receivers(scene, first, last, gates, weights, sums);
    });
    return sums;
}

/// Returns the derivative by a light that is traced.
VectorIrradiance derivative_by(const SharpLight& light, std::span<const std::uint16_t> reached,
                               std::span<const glm::vec3> weights,
                               std::span<const glm::vec3> normals) {
    const std::array channels = {light.irradiance.red, light.irradiance.green,
                                 light.irradiance.blue};
    Vectors sums{};
    for (std::size_t block = 0; block < reached.size(); ++block)
        for (std::uint32_t bits = reached[block]; bits != 0; bits &= bits - 1) {
            const std::size_t place =
                block * prt::BlockSize + static_cast<std::size_t>(std::countr_zero(bits));
            const glm::dvec3 normal(normals[place]);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const bool is_dark = channels[channel] == glm::dvec3(0.0);
                if (glm::dot(normal, is_dark ? light.direction : channels[channel]) > 0.0)
                    sums[channel] +=
                        static_cast<double>(weights[place][static_cast<int>(channel)]) * normal;
            }
        }
    return scaled(sums, std::numbers::inv_pi);
}

} // namespace

void require_weights(std::span<const glm::vec3> weights, std::size_t count) {
    if (weights.size() != count)
        throw std::invalid_argument(
            fmt::format("expected {} weights, got {}", count, weights.size()));
    for (const glm::vec3& weight : weights)
        for (int channel = 0; channel < 3; ++channel)
            if (!std::isfinite(weight[channel]))
                throw std::invalid_argument(
                    fmt::format("expected finite weights, got {}", weight[channel]));
}

void require_environment(const Relighter& relighter) {
    if (relighter.binning() == nullptr || relighter.environment().resolution == 0)
        throw std::invalid_argument("expected an environment, got none");
}

void add(const LightDerivative& part, LightDerivative& sum) {
    sum.clusters.resize(part.clusters.size());
    sum.sharp.resize(part.sharp.size());
    for (std::size_t i = 0; i < part.clusters.size(); ++i)
        sum.clusters[i] += part.clusters[i];
    for (std::size_t i = 0; i < part.sharp.size(); ++i)
        sum.sharp[i] += part.sharp[i];
}

LightDerivative light_derivative(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const prt::Transfer& transfer = relighter.transfer();
    const ReceiverLight& light = relighter.receiver_light();
    const ClusterLights& lights = light.cluster_lights();
    const std::span<const prt::Cell> cells = transfer.quadtree.leaves();
    require_weights(weights, transfer.num_receivers());
    std::vector<glm::vec3> by_place(weights.size(), glm::vec3(0.0f));
    for (std::size_t place = transfer.num_points; place < by_place.size(); ++place)
        by_place[place] = weights[transfer.order[place]];

    ClusterWeights sums = summed_weights(light.block_scene(), gates_of(lights, cells),
                                         BlockWeights(by_place, transfer.normals));
    for (std::size_t cluster = 1; cluster < cells.size(); ++cluster)
        for (std::size_t i = 0; i < NumWeightSums; ++i)
            sums.whole_steps[cluster][i] += sums.whole_steps[cluster - 1][i];

    LightDerivative result;
    result.clusters.resize(cells.size());
    result.given_by_clusters.resize(cells.size());
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t cluster) {
        const KernelLight here(lights, cluster);
        const Vectors whole = vectors_of(sums.whole_steps[cluster]);
        const Vectors gated = vectors_of(sums.gated[cluster]);
        const bool has_directional = !lights.is_spread(cluster);
        Vectors all = has_directional ? through_direction(gated, here) : gated;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            all[channel] += whole[channel];
            const auto c = static_cast<int>(channel);
            result.given_by_clusters[cluster][c] =
                glm::dot(whole[channel], here.vectors[channel]) +
                (has_directional ? glm::dot(gated[channel], here.direction) * here.colour[c]
                                 : glm::dot(gated[channel], here.vectors[channel]));
        }
        result.clusters[cluster] =
            scaled(all, std::numbers::inv_pi / static_cast<double>(prt::FullCount));
    });
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    result.sharp.resize(sharp.size());
    result.given_by_sharp.resize(sharp.size());
    files::parallel_for(std::size_t{0}, sharp.size(), [&](std::size_t i) {
        result.sharp[i] =
            derivative_by(sharp[i], light.traced().reached(sharp[i]), by_place, transfer.normals);
        result.given_by_sharp[i] = {glm::dot(result.sharp[i].red, sharp[i].irradiance.red),
                                    glm::dot(result.sharp[i].green, sharp[i].irradiance.green),
                                    glm::dot(result.sharp[i].blue, sharp[i].irradiance.blue)};
    });
    return result;
}

cubemap::CubeMap adjoint(const Relighter& relighter, std::span<const glm::vec3> weights,
                         const SurfaceBounces* bounces) {
    const prt::Transfer& transfer = relighter.transfer();
    require_environment(relighter);
    if (transfer.glossy)
        throw std::invalid_argument("expected receivers without highlights, got some with");
    require_weights(weights, transfer.num_receivers());
    std::vector<glm::vec3> direct(weights.begin(), weights.end());
    if (!transfer.surfaces.empty())
        for (std::size_t place = 0; place < direct.size(); ++place)
            direct[transfer.order[place]] *= transfer.surfaces[place].albedo;
    if (bounces != nullptr) {
        const std::vector<glm::vec3> bounced = bounce_adjoint(*bounces, transfer, direct);
        for (std::size_t i = 0; i < direct.size(); ++i)
            direct[i] += bounced[i];
    }
    LightDerivative derivative;
    if (transfer.num_points < transfer.num_receivers())
        derivative = light_derivative(relighter, direct);
    if (transfer.num_points != 0)
        add(points_derivative(relighter, direct), derivative);
    return by_texels(relighter, derivative);
}

cubemap::CubeMap by_texels(const Relighter& relighter, const LightDerivative& derivative) {
    const LightBinning& binning = *relighter.binning();
    const std::span<const prt::Cell> cells = relighter.transfer().quadtree.leaves();
    cubemap::CubeMap result(relighter.environment().resolution);
    // Cells may share texels with others of their face only.
    files::parallel_for(std::size_t{0}, cubemap::NumFaces, [&](std::size_t face) {
        for (std::size_t cluster = 0; cluster < cells.size(); ++cluster)
            if (static_cast<std::size_t>(cells[cluster].face) == face)
                binning.add_derivative(cells[cluster], derivative.clusters[cluster], result);
        for (std::size_t i = 0; i < derivative.sharp.size(); ++i) {
            const SharpLight& light = relighter.sharp_lights()[i];
            VectorIrradiance difference = derivative.sharp[i];
            difference -= derivative.clusters[light.cluster];
            if (static_cast<std::size_t>(light.cell.face) == face)
                binning.add_derivative(light.cell, difference, result);
        }
    });
    return result;
}

} // namespace relumine::relight
