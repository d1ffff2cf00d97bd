#include "prt/refinement/coarse_transfer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/face.h"
#include "cubemap/luminance.h"
#include "cubemap/resample/resample.h"
#include "files/parallel.h"
#include "prt/clusters/cluster_kernels.h"
#include "prt/clusters/horizon.h"
#include "prt/receivers/receiver_order.h"

namespace relumine::prt {

namespace {

/// Weights of two squared errors beside the squared error under a small light anywhere: under even
/// light from everywhere, and under the environment that is named or the lamps. Under even light
/// errors are smaller, so they would count for little. Measured: these lower the relative errors
/// under all of them about alike.
constexpr double WeightOfEvenLight = 20.0, WeightOfLight = 4.0;

} // namespace

CoarseDirections::CoarseDirections(const cubemap::CubeMap* light) {
    constexpr std::uint32_t TileSide = 4, PatchSide = 8;
    // The cube map's texels by patch, then direction.
    std::vector<std::size_t> texels;
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(Resolution);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y0 = 0; y0 < Resolution; y0 += PatchSide)
            for (std::uint32_t x0 = 0; x0 < Resolution; x0 += PatchSide) {
                DirectionPatch& patch = patches_.emplace_back();
                for (std::uint32_t j = 0; j < DirectionPatch::Size; ++j) {
                    // Packets of 4 x 4 texels.
                    const std::uint32_t tile = j / PacketSize, lane = j % PacketSize;
                    const std::uint32_t x = x0 + tile % 2 * TileSide + lane % TileSide;
                    const std::uint32_t y = y0 + tile / 2 * TileSide + lane / TileSide;
                    patch.add(cubemap::texel_direction(face, x, y, Resolution));
                    texels.push_back(
                        (static_cast<std::size_t>(face) * Resolution + y) * Resolution + x);
                    shares_.push_back(static_cast<float>(
                        solid_angles[std::size_t{y} * Resolution + x] / (4.0 * std::numbers::pi)));
                }
            }
    lights_.resize(shares_.size());
    if (light != nullptr)
        add_light(*light, texels);
}

/// The samples of a texel of the coarse map lie where the light is that it has: evenly over the
/// cumulative power of its texels in the environment.
void CoarseDirections::add_light(const cubemap::CubeMap& light,
                                 std::span<const std::size_t> texels) {
    constexpr std::size_t PerFace = std::size_t{Resolution} * Resolution;
    const cubemap::CubeMap coarse = cubemap::resample(light, Resolution);
    const std::vector<double> coarse_angles = cubemap::texel_solid_angles(Resolution);
    std::vector<double> powers(coarse.texels.size());
    double all = 0.0;
    for (std::size_t i = 0; i < powers.size(); ++i) {
        powers[i] = cubemap::luminance(coarse.texels[i]) * coarse_angles[i % PerFace];
        all += powers[i];
    }
    if (!(all > 0.0))
        return;
    const std::vector<double> angles = cubemap::texel_solid_angles(light.resolution);
    std::vector<std::size_t> by_power(powers.size());
    std::iota(by_power.begin(), by_power.end(), std::size_t{0});
    std::stable_sort(by_power.begin(), by_power.end(),
                     [&](std::size_t a, std::size_t b) { return powers[a] > powers[b]; });
    for (std::size_t rank = 0; rank < MostBrightPatches; ++rank) {
        const std::size_t texel = by_power[rank];
        if (!(DirectionPatch::Size * powers[texel] > all) || light.resolution < 2 * Resolution ||
            !add_bright_patch(light, angles, texel, powers[texel] / (all * DirectionPatch::Size)))
            break;
        powers[texel] = 0.0;
    }
    // The others shine from their centres.
    for (std::size_t j = 0; j < texels.size(); ++j)
        lights_[j] = static_cast<float>(powers[texels[j]] / all);
}

/// Adds a patch for a bright texel of the coarse map. Each of its directions gets the weight.
/// Returns false for a texel without light.
bool CoarseDirections::add_bright_patch(const cubemap::CubeMap& light,
                                        std::span<const double> angles, std::size_t texel,
                                        double weight) {
    constexpr std::size_t PerFace = std::size_t{Resolution} * Resolution;
    const cubemap::Face face = cubemap::AllFaces[texel / PerFace];
    const auto y = static_cast<std::uint32_t>(texel % PerFace / Resolution);
    const auto x = static_cast<std::uint32_t>(texel % Resolution);
    struct Share {
        double sum;
        std::uint32_t x, y;
    };
    std::vector<Share> parts;
    double sum = 0.0;
    const auto first = [&](std::uint32_t place) {
        return place * light.resolution / Resolution;
    };
    for (std::uint32_t v = first(y); v < first(y + 1); ++v)
        for (std::uint32_t u = first(x); u < first(x + 1); ++u) {
            sum += cubemap::luminance(light.at(face, u, v)) *
                   angles[std::size_t{v} * light.resolution + u];
            parts.push_back({sum, u, v});
        }
    if (!(sum > 0.0))
        return false;
    DirectionPatch& patch = patches_.emplace_back();
    std::size_t part = 0;
    for (std::uint32_t j = 0; j < DirectionPatch::Size; ++j) {
        const double at = (j + 0.5) / DirectionPatch::Size * sum;
        while (part + 1 < parts.size() && parts[part].sum < at)
            ++part;
        const double before = part == 0 ? 0.0 : parts[part - 1].sum;
        const double across = (at - before) / (parts[part].sum - before);
        // Van der Corput's sequence.
        double along = 0.5 / DirectionPatch::Size;
        for (std::uint32_t bit = 0; bit < 6; ++bit)
            along += (j >> bit & 1u) / static_cast<double>(2u << bit);
        patch.add(glm::vec3(
            glm::normalize(cubemap::cube_point(face, (parts[part].x + across) / light.resolution,
                                               (parts[part].y + along) / light.resolution))));
        shares_.push_back(0.0f);
        lights_.push_back(static_cast<float>(weight));
    }
    return true;
}

std::vector<CoarseDirections::Bits>
CoarseDirections::trace(const Receivers& receivers, const Blockers& blockers, float bias,
                        const Progress& progress, std::span<const Neighbours> neighbours) const {
    const std::vector<std::uint32_t> order = spatial_order(receivers);
    std::vector<glm::vec3> origins, normals;
    for (const std::uint32_t receiver : order) {
        normals.push_back(receivers.normals[receiver]);
        origins.push_back(ray_origin(receivers.positions[receiver], normals.back(), bias));
    }
    const NormalArrays arrays(normals);
    std::vector<Bits> result(order.size());
    const std::size_t num_groups =
        (order.size() + ReceiverGroup::MaxSize - 1) / ReceiverGroup::MaxSize;
    files::parallel_for(std::size_t{0}, num_groups, [&](std::size_t group) {
        progress.poll();
        const std::size_t first = group * ReceiverGroup::MaxSize;
        const std::size_t size = std::min(order.size() - first, ReceiverGroup::MaxSize);
        std::array<std::uint64_t, ReceiverGroup::MaxSize> words{};
        for (std::size_t p = 0; p < patches_.size(); ++p) {
            const std::span<std::uint64_t> rays(words.data(), size);
            std::fill(rays.begin(), rays.end(), 0u);
            directions_above_horizon(arrays, first, patches_[p], rays);
            glm::vec3 mean_normal(0.0f);
            bool has_rays = false;
            for (std::size_t i = 0; i < size; ++i) {
                const std::uint32_t receiver = order[first + i];
                if (!neighbours.empty() && neighbours[receiver].low != nullptr) {
                    const std::uint64_t low = (*neighbours[receiver].low)[p];
                    const std::uint64_t high = (*neighbours[receiver].high)[p];
                    result[receiver][p] = rays[i] & low & high;
                    rays[i] &= low ^ high;
                }
                if (rays[i] != 0)
                    mean_normal += normals[first + i];
                has_rays = has_rays || rays[i] != 0;
            }
            if (has_rays)
                blockers.clear_blocked({std::span(origins).subspan(first, size), mean_normal},
                                       patches_[p], rays);
            for (std::size_t i = 0; i < size; ++i)
                result[order[first + i]][p] |= rays[i];
        }
    });
    return result;
}

int CoarseDirections::num_lit(const Bits& bits) {
    int result = 0;
    for (const std::uint64_t word : bits)
        result += std::popcount(word);
    return result;
}

float CoarseDirections::difference(const Point& point, std::span<const Point> others,
                                   Signs signs) const {
    const bool is_flat = std::all_of(others.begin(), others.end(), [&](const Point& other) {
        return other.normal == point.normal;
    });
    double squares = 0.0, under_even_light = 0.0, under_light = 0.0;
    for (std::size_t p = 0; p < patches_.size(); ++p) {
        // On a flat surface only directions that not all points see differ.
        std::uint64_t any = (*point.lit)[p], all = any;
        for (const Point& other : others) {
            any |= (*other.lit)[p];
            all &= (*other.lit)[p];
        }
        float squares_of_patch = 0.0f, even_of_patch = 0.0f, light_of_patch = 0.0f;
        for (std::uint64_t left = is_flat ? any & ~all : any; left != 0; left &= left - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(left));
            const glm::vec3 w = patches_[p].direction(j);
            const auto transfer = [&](const Point& at) {
                const float cosine = at.normal.x * w.x + at.normal.y * w.y + at.normal.z * w.z;
                return ((*at.lit)[p] >> j & 1u) != 0 ? cosine : 0.0f;
            };
            float difference = transfer(point);
            for (const Point& other : others)
                difference -= other.weight * transfer(other);
            if (signs == Signs::Dropped)
                difference = std::abs(difference);
            const float share = shares_[p * DirectionPatch::Size + j];
            squares_of_patch += difference * difference * share;
            even_of_patch += difference * share;
            light_of_patch += difference * lights_[p * DirectionPatch::Size + j];
        }
        squares += static_cast<double>(squares_of_patch);
        under_even_light += static_cast<double>(even_of_patch);
        under_light += static_cast<double>(light_of_patch);
    }
    double of_others = 0.0;
    for (const Point& other : others)
        of_others += double{other.weight} * double{other.lamps};
    const double under_lamps =
        (double{point.lamps} - of_others) / (1.0 + std::max(double{point.lamps}, of_others));
    return static_cast<float>(
        std::sqrt(squares + WeightOfEvenLight * under_even_light * under_even_light +
                  WeightOfLight * (under_light * under_light + under_lamps * under_lamps)) /
        std::numbers::pi);
}

} // namespace relumine::prt
