#include "relight/adjoint/contribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

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

/// Of points in space, whose radiance is the mean over the sphere.
Given given_to_points(const Relighter& relighter, std::span<const glm::vec3> weights) {
    const ReceiverLight& light = relighter.receiver_light();
    const std::span<const std::uint32_t> order = relighter.transfer().order;
    const std::span<const SharpLight> sharp = relighter.sharp_lights();
    std::vector<std::size_t> places;
    for (std::size_t place = 0; place < order.size(); ++place)
        if (weights[order[place]] != glm::vec3(0.0f))
            places.push_back(place);
    Given given{std::vector<glm::dvec3>(relighter.transfer().num_clusters()),
                std::vector<glm::dvec3>(sharp.size())};
    files::parallel_for(std::size_t{0}, given.by_clusters.size(), [&](std::size_t cluster) {
        for (const std::size_t place : places)
            given.by_clusters[cluster] +=
                glm::dvec3(weights[order[place]]) * light.of_point_from_cluster(place, cluster);
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

Given given_to(const Relighter& relighter, std::span<const glm::vec3> weights) {
    if (relighter.transfer().have_no_surface)
        return given_to_points(relighter, weights);
    LightDerivative derivative = light_derivative(relighter, weights);
    return {std::move(derivative.given_by_clusters), std::move(derivative.given_by_sharp)};
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
