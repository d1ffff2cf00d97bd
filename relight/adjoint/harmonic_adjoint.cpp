#include "relight/adjoint/harmonic_adjoint.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"
#include "prt/clusters/lattice.h"
#include "relight/adjoint/harmonic_adjoint_kernel.h"
#include "relight/adjoint/word_ranges.h"
#include "relight/receiver_light.h"

namespace relumine::relight {

namespace {

using Coefficients = std::array<double, MaxHarmonics>;

/// Returns the derivative by a light's vector, given that by its coefficients and by its flux: the
/// transpose of harmonics_of() where the light has the direction `u`.
glm::dvec3 by_vector(const Coefficients& weights, double by_flux, const glm::dvec3& u,
                     double coherence) {
    const double pi = std::numbers::pi;
    const double c0 = 0.5 / std::sqrt(pi), c1 = std::sqrt(3.0 / (4.0 * pi));
    const double c2 = 0.5 * std::sqrt(15.0 / pi), c20 = 0.25 * std::sqrt(5.0 / pi);
    // Band 0 is the vector's length, band 1 the vector, band 2 a square over the length.
    glm::dvec3 result = (by_flux + c0 * weights[0]) / coherence * u +
                        c1 * glm::dvec3(weights[3], weights[1], weights[2]);
    const glm::dvec3 square_slope =
        c2 * weights[4] * glm::dvec3(u.y, u.x, 0.0) + c2 * weights[5] * glm::dvec3(0.0, u.z, u.y) +
        c20 * weights[6] * glm::dvec3(-2.0 * u.x, -2.0 * u.y, 4.0 * u.z) +
        c2 * weights[7] * glm::dvec3(u.z, 0.0, u.x) + c2 * weights[8] * glm::dvec3(u.x, -u.y, 0.0);
    // A square is half of its slope along the vector.
    result += coherence * coherence * (square_slope - 0.5 * glm::dot(square_slope, u) * u);
    return result;
}

void require_coefficients(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const std::uint32_t order = relighter.receiver_light().harmonic_order();
    if (order == 0)
        throw std::invalid_argument("expected a Relighter with harmonics, got one without");
    require_weights(weights, relighter.transfer().num_receivers() * num_harmonics(order));
}

/// Three channels of it. A channel without light has the direction `dark`.
VectorIrradiance by_light(const double* weights, std::size_t count, const glm::dvec3& by_flux,
                          const VectorIrradiance& light, const glm::dvec3& dark, double coherence,
                          double scale) {
    const std::array channels = {light.red, light.green, light.blue};
    std::array<glm::dvec3, 3> result;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        Coefficients of_channel{};
        std::copy_n(weights + channel * count, count, of_channel.begin());
        const double length = glm::length(channels[channel]);
        result[channel] =
            scale * by_vector(of_channel, by_flux[static_cast<int>(channel)],
                              length > 0.0 ? channels[channel] / length : dark, coherence);
    }
    return {.red = result[0], .green = result[1], .blue = result[2]};
}

/// Sums the weights of all receivers into clusters. A thread has words of clusters.
HarmonicSums summed_weights(const ReceiverLight& light, const HarmonicWeights& weights) {
    const BlockScene scene = light.block_scene();
    const ClusterHarmonics& lights = light.harmonic_light()->lights();
    HarmonicSums sums(lights);
    for_word_ranges(scene.counts, [&](std::size_t first, std::size_t last) {
        add_receivers(scene, first, last, lights, weights, sums);
    });
    for (std::size_t i = lights.stride(); i < sums.whole_steps.size(); ++i)
        sums.whole_steps[i] += sums.whole_steps[i - lights.stride()];
    return sums;
}

/// Goes on from a group's basis functions to its clusters: the functions are sums of the clusters'
/// coefficients over the sum of their fluxes.
void through_bases(const ClusterHarmonics& lights, HarmonicSums& sums) {
    const std::size_t stride = lights.stride(), count = stride / 3;
    std::vector<double> of_groups(lights.groups().size() * stride);
    for (std::size_t word = 0; word + 1 < sums.first_slot.size(); ++word)
        for (std::size_t slot = sums.first_slot[word]; slot < sums.first_slot[word + 1]; ++slot) {
            const std::size_t group = lights.group_of()[word * 64] + slot - sums.first_slot[word];
            for (std::size_t i = 0; i < stride; ++i)
                of_groups[group * stride + i] += sums.bases[slot * stride + i];
        }
    for (std::size_t index = 0; index < lights.groups().size(); ++index) {
        const HarmonicGroup& group = lights.groups()[index];
        const float* basis = lights.bases().data() + index * stride;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            double flux = 0.0, along = 0.0;
            for (std::size_t cluster = group.begin; cluster < group.end; ++cluster)
                flux += static_cast<double>(lights.fluxes()[cluster * 3 + channel]);
            if (flux == 0.0)
                continue; // The functions are about the middle then, whatever the light is.
            const double* weights = of_groups.data() + index * stride + channel * count;
            for (std::size_t k = 0; k < count; ++k)
                along += weights[k] * static_cast<double>(basis[channel * count + k]);
            for (std::size_t cluster = group.begin; cluster < group.end; ++cluster) {
                sums.fluxes[cluster * 3 + channel] -= along / flux;
                for (std::size_t k = 0; k < count; ++k)
                    sums.whole_steps[cluster * stride + channel * count + k] += weights[k] / flux;
            }
        }
    }
}

/// Returns the derivative by a light that is traced.
VectorIrradiance by_traced(const SharpLight& light, std::span<const std::uint16_t> reached,
                           const HarmonicWeights& weights) {
    std::vector<double> sums(weights.stride);
    for (std::size_t block = 0; block < reached.size(); ++block)
        for (std::uint32_t bits = reached[block]; bits != 0; bits &= bits - 1)
            for (std::size_t i = 0; i < sums.size(); ++i)
                sums[i] += static_cast<double>(
                    weights.lanes[(block * weights.stride + i) * prt::BlockSize +
                                  static_cast<std::size_t>(std::countr_zero(bits))]);
    return by_light(sums.data(), sums.size() / 3, glm::dvec3(0.0), light.irradiance,
                    light.direction, 1.0, 1.0);
}

/// Takes the weights of each receiver's irradiance at its own normal, to which its coefficients are
/// bound, out of those of its coefficients. Returns them, as weights of radiance for albedo 1.
std::vector<glm::vec3> take_bound(const prt::Transfer& transfer, std::span<glm::vec3> weights) {
    const std::size_t count = weights.size() / transfer.num_receivers();
    std::vector<glm::vec3> bound(transfer.num_receivers(), glm::vec3(0.0f));
    for (std::size_t place = 0; place < bound.size(); ++place) {
        const glm::vec3& normal = transfer.normals[place];
        if (normal == glm::vec3(0.0f))
            continue;
        const Coefficients values = irradiance_harmonics(normal);
        glm::vec3* own = weights.data() + transfer.order[place] * count;
        double squares = 0.0;
        glm::dvec3 along(0.0);
        for (std::size_t k = 0; k < count; ++k) {
            squares += values[k] * values[k];
            along += values[k] * glm::dvec3(own[k]);
        }
        along /= squares;
        for (std::size_t k = 0; k < count; ++k)
            own[k] -= glm::vec3(along * values[k]);
        bound[transfer.order[place]] = along * std::numbers::pi;
    }
    return bound;
}

/// Returns the weights of points in space by place, [num_points][order^2].
std::vector<glm::vec3> weights_of_points(const prt::Transfer& transfer,
                                         std::span<const glm::vec3> weights) {
    const std::size_t count = weights.size() / transfer.num_receivers();
    std::vector<glm::vec3> result;
    result.reserve(transfer.num_points * count);
    for (std::size_t place = 0; place < transfer.num_points; ++place) {
        const auto own = weights.subspan(transfer.order[place] * count, count);
        result.insert(result.end(), own.begin(), own.end());
    }
    return result;
}

/// Adds what surfaces give to the bound values and to points: of direct light and of bounces.
void add_surfaces(const Relighter& relighter, std::vector<glm::vec3> bound,
                  std::span<const glm::vec3> of_points, const SurfaceBounces* bounces,
                  LightDerivative& sum) {
    const prt::Transfer& transfer = relighter.transfer();
    if (bounces != nullptr) {
        // A black surface shows no bounces, so its coefficients have none.
        std::vector<glm::vec3> of_bounces = bound;
        for (std::size_t place = 0; place < transfer.surfaces.size(); ++place)
            for (int channel = 0; channel < 3; ++channel)
                if (!(transfer.surfaces[place].albedo[channel] > 0.0f))
                    of_bounces[transfer.order[place]][channel] = 0.0f;
        const std::vector<glm::vec3> more =
            bounce_adjoint(*bounces, transfer, of_bounces, of_points);
        for (std::size_t i = 0; i < bound.size(); ++i)
            bound[i] += more[i];
    }
    if (transfer.num_points < transfer.num_receivers())
        add(light_derivative(relighter, bound), sum);
}

} // namespace

LightDerivative unbound_derivative(const Relighter& relighter, std::span<const glm::vec3> given) {
    const prt::Transfer& transfer = relighter.transfer();
    const ReceiverLight& light = relighter.receiver_light();
    require_coefficients(relighter, given);
    const ClusterHarmonics& lights = light.harmonic_light()->lights();
    const HarmonicWeights weights(given, transfer.order);
    HarmonicSums sums = summed_weights(light, weights);
    through_bases(lights, sums);

    LightDerivative result;
    const std::span<const prt::Cell> cells = transfer.quadtree.leaves();
    result.clusters.resize(cells.size());
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t cluster) {
        const double* by_flux = sums.fluxes.data() + cluster * 3;
        const prt::Cell& cell = cells[cluster];
        result.clusters[cluster] =
            by_light(sums.whole_steps.data() + cluster * lights.stride(), lights.stride() / 3,
                     {by_flux[0], by_flux[1], by_flux[2]}, relighter.cluster_light(cluster),
                     cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                        (cell.y + 0.5) * cell.size()),
                     lights.coherence(cluster), 1.0 / prt::FullCount);
    });
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    result.sharp.resize(sharp.size());
    files::parallel_for(std::size_t{0}, sharp.size(), [&](std::size_t i) {
        result.sharp[i] = by_traced(sharp[i], light.traced().reached(sharp[i]), weights);
    });
    return result;
}

cubemap::CubeMap harmonics_adjoint(const Relighter& relighter, std::span<const glm::vec3> weights,
                                   const SurfaceBounces* bounces) {
    require_environment(relighter);
    require_coefficients(relighter, weights);
    const prt::Transfer& transfer = relighter.transfer();
    std::vector<glm::vec3> unbound(weights.begin(), weights.end());
    std::vector<glm::vec3> bound = take_bound(transfer, unbound);
    LightDerivative derivative = unbound_derivative(relighter, unbound);
    add_surfaces(relighter, std::move(bound), weights_of_points(transfer, unbound), bounces,
                 derivative);
    return by_texels(relighter, derivative);
}

LightDerivative points_derivative(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const prt::Transfer& transfer = relighter.transfer();
    require_weights(weights, transfer.num_receivers());
    const std::size_t count = num_harmonics(relighter.receiver_light().harmonic_order());
    std::vector<glm::vec3> first(weights.size() * count, glm::vec3(0.0f));
    for (std::size_t place = 0; place < transfer.num_points; ++place)
        first[transfer.order[place] * count] = mean_radiance(weights[transfer.order[place]]);
    return unbound_derivative(relighter, first);
}

} // namespace relumine::relight
