#include "relight/harmonics/harmonic_light.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>

#include "files/parallel.h"
#include "prt/clusters/lattice.h"

namespace relumine::relight {

HarmonicLight::HarmonicLight(const prt::Transfer& transfer, std::uint32_t order)
    : transfer_(transfer), lights_(transfer.quadtree, order),
      visible_(transfer.counts.num_blocks() * lights_.stride()),
      mixed_(visible_.size() * prt::BlockSize), brightness_(transfer.counts.num_blocks()) {}

HarmonicBlocks HarmonicLight::blocks() {
    return {.visible = visible_.data(), .mixed = mixed_.data()};
}

void HarmonicLight::take_traced(std::span<const SharpLight> lights, const TracedLight& traced) {
    traced_.clear();
    if (lights.empty() || !traced.is_traced())
        return;
    const std::size_t count = num_harmonics(order());
    traced_.resize(mixed_.size());
    std::vector<std::array<std::array<double, MaxHarmonics>, 3>> coefficients;
    coefficients.reserve(lights.size());
    for (const SharpLight& light : lights)
        coefficients.push_back(harmonics_of(light.irradiance, 1.0));
    files::parallel_for(std::size_t{0}, transfer_.counts.num_blocks(), [&](std::size_t block) {
        double* of_block = traced_.data() + block * lights_.stride() * prt::BlockSize;
        for (std::size_t light = 0; light < lights.size(); ++light)
            for (std::uint32_t bits = traced.reached(light, block); bits != 0; bits &= bits - 1) {
                double* of_receiver = of_block + std::countr_zero(bits);
                for (std::size_t channel = 0; channel < 3; ++channel)
                    for (std::size_t k = 0; k < count; ++k)
                        of_receiver[(channel * count + k) * prt::BlockSize] +=
                            coefficients[light][channel][k];
            }
    });
}

double HarmonicLight::brightness(std::size_t block) const {
    double largest = 0.0;
    const std::size_t count = num_harmonics(order());
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const std::size_t number = block * lights_.stride() + channel * count;
        largest = std::max(largest, prt::FullCount * std::abs(visible_[number]));
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            largest = std::max(largest, std::abs(mixed_[number * prt::BlockSize + i]));
    }
    return largest;
}

void HarmonicLight::sum(const BlockScene& scene, const ClusterSums& sums) {
    constexpr std::size_t Grain = 64;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, sums.all.size(), Grain), [&](const auto& range) {
            for (std::size_t cluster = range.begin(); cluster < range.end(); ++cluster)
                lights_.set(cluster, sums.without_sharp(cluster));
        });
    lights_.sum_prefix();
    files::parallel_for(files::IndexRange<std::size_t>(0, lights_.groups().size(), Grain),
                        [&](const auto& range) {
                            for (std::size_t group = range.begin(); group < range.end(); ++group)
                                lights_.sum_group(group);
                        });
    const prt::VisibleCounts& counts = transfer_.counts;
    files::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
        light_harmonics(scene, tile, lights_, ~std::uint64_t{0}, blocks());
        for (std::size_t block = counts.tile_begin(tile); block < counts.tile_begin(tile + 1);
             ++block)
            brightness_[block].set_summed(brightness(block));
    });
}

std::size_t HarmonicLight::update(const BlockScene& scene, const ClusterSums& sums,
                                  std::span<const std::uint32_t> changed) {
    changes_.set(lights_, changed,
                 [&](std::uint32_t cluster) { return sums.without_sharp(cluster); });
    const prt::VisibleCounts& counts = transfer_.counts;
    dimmed_.assign(counts.num_tiles(), 0);
    std::atomic<std::size_t> num_blocks = 0;
    files::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
        const std::uint64_t touched = update_harmonics(scene, tile, lights_, changes_, blocks());
        for (std::uint64_t bits = touched; bits != 0; bits &= bits - 1) {
            const std::size_t block =
                counts.tile_begin(tile) + static_cast<std::size_t>(std::countr_zero(bits));
            if (brightness_[block].has_dimmed_to(brightness(block)))
                dimmed_[tile] |= bits & (~bits + 1);
        }
        num_blocks += static_cast<std::size_t>(std::popcount(touched));
    });
    if (std::any_of(dimmed_.begin(), dimmed_.end(), [](auto blocks) { return blocks != 0; })) {
        lights_.sum_prefix();
        files::parallel_for(std::size_t{0}, counts.num_tiles(), [&](std::size_t tile) {
            if (dimmed_[tile] == 0)
                return;
            light_harmonics(scene, tile, lights_, dimmed_[tile], blocks());
            for (std::uint64_t bits = dimmed_[tile]; bits != 0; bits &= bits - 1) {
                const std::size_t block =
                    counts.tile_begin(tile) + static_cast<std::size_t>(std::countr_zero(bits));
                brightness_[block].set_summed(brightness(block));
            }
        });
    }
    return num_blocks;
}

double HarmonicLight::value(std::size_t place, std::size_t number, bool with_sharp) const {
    const std::size_t at = place / prt::BlockSize * lights_.stride() + number;
    const std::size_t of_receiver = at * prt::BlockSize + place % prt::BlockSize;
    return prt::FullCount * visible_[at] + mixed_[of_receiver] +
           (with_sharp && !traced_.empty() ? traced_[of_receiver] : 0.0);
}

void HarmonicLight::read(std::size_t place, std::span<glm::vec3> light, bool with_sharp) const {
    const std::size_t count = num_harmonics(order());
    for (std::size_t k = 0; k < count; ++k)
        light[k] = {value(place, k, with_sharp), value(place, count + k, with_sharp),
                    value(place, 2 * count + k, with_sharp)};
}

glm::vec3 HarmonicLight::mean(std::size_t place, bool with_sharp) const {
    const std::size_t count = num_harmonics(order());
    // A sum of nothing may round to a hair below zero.
    const auto channel = [&](std::size_t i) {
        return std::max(0.0f, static_cast<float>(value(place, i * count, with_sharp)));
    };
    return mean_radiance({channel(0), channel(1), channel(2)});
}

glm::dvec3 HarmonicLight::mean_from_cluster(std::size_t cluster) const {
    const std::span<const float> flux = lights_.fluxes().subspan(cluster * 3, 3);
    return glm::dvec3(flux[0], flux[1], flux[2]) / (4.0 * std::numbers::pi);
}

} // namespace relumine::relight
