// Based on: Johan and Nishita, "Efficient Relighting by Clustering Environment Lights" [JN], Section 5.
#include "relight/relighter.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "prt/lattice.h"

namespace relumine::relight {

namespace {

/// Blocks of one task: 64 blocks are about 50 microseconds of work, well above the cost of starting a task.
constexpr std::size_t BlocksPerTask = 64;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void require_radiance(std::span<const glm::vec3> texels) {
    // One branch per texel: NaN fails both comparisons.
    const auto good = [](float value) {
        return value >= 0.0f && value <= std::numeric_limits<float>::max();
    };
    for (const glm::vec3& texel : texels)
        if (!good(texel.r) || !good(texel.g) || !good(texel.b))
            throw std::invalid_argument(
                fmt::format("expected finite radiance >= 0, got ({}, {}, {})", texel.r, texel.g, texel.b));
}

} // namespace

Relighter::Relighter(const prt::Transfer& transfer)
    : transfer_(transfer), normals_(transfer.counts.num_blocks()), light_(transfer.counts.num_blocks()),
      lights_(transfer.num_clusters()), radiance_(transfer.num_receivers()) {
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place)
        for (int axis = 0; axis < 3; ++axis)
            normals_[place / prt::BlockSize].axes[static_cast<std::size_t>(axis)][place % prt::BlockSize] =
                transfer.normals[place][axis];
}

RelightTimes Relighter::set_environment(cubemap::CubeMap environment) {
    require_radiance(environment.texels);
    RelightTimes times;
    auto start = std::chrono::steady_clock::now();
    environment_ = std::move(environment);
    if (!binning_ || binning_->resolution() != environment_.resolution)
        binning_.emplace(environment_.resolution);
    const std::span<const prt::Cell> cells = transfer_.quadtree.leaves();
    tbb::parallel_for(std::size_t{0}, cells.size(),
                      [&](std::size_t i) { lights_.set(i, binning_->sum(environment_, cells[i])); });
    lights_.sum_prefix();
    times.seconds_bin = seconds_since(start);

    start = std::chrono::steady_clock::now();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, light_.size(), BlocksPerTask),
                      [&](const auto& blocks) {
                          for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                              light_block(transfer_.counts, block, normals_[block], lights_, light_[block]);
                              write_radiance(block);
                          }
                      });
    lit_by_ = lights_.vectors;
    times.seconds_relight = seconds_since(start);
    return times;
}

UpdateReport Relighter::update_region(const TexelRectangle& rectangle, std::span<const glm::vec3> radiance) {
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t r = environment_.resolution;
    if (r == 0)
        throw std::invalid_argument("expected an environment before its first update");
    if (rectangle.x0 >= rectangle.x1 || rectangle.y0 >= rectangle.y1 || rectangle.x1 > r || rectangle.y1 > r)
        throw std::invalid_argument(fmt::format("expected a rectangle inside the {0} x {0} face", r));
    const std::size_t width = rectangle.x1 - rectangle.x0;
    if (radiance.size() != width * (rectangle.y1 - rectangle.y0))
        throw std::invalid_argument("expected one radiance per texel of the rectangle");
    require_radiance(radiance);

    for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
        std::copy_n(radiance.data() + (y - rectangle.y0) * width, width,
                    &environment_.at(rectangle.face, rectangle.x0, y));

    // The clusters that the rectangle meets get their light summed anew, not by differences: nothing can drift.
    touched_leaves_.clear();
    transfer_.quadtree.find_leaves({.face = rectangle.face,
                                    .s0 = static_cast<double>(rectangle.x0) / r,
                                    .t0 = static_cast<double>(rectangle.y0) / r,
                                    .s1 = static_cast<double>(rectangle.x1) / r,
                                    .t1 = static_cast<double>(rectangle.y1) / r},
                                   touched_leaves_);
    tbb::parallel_for(std::size_t{0}, touched_leaves_.size(), [&](std::size_t i) {
        const std::uint32_t cluster = touched_leaves_[i];
        lights_.set(cluster, binning_->sum(environment_, transfer_.quadtree.leaves()[cluster]));
    });
    changes_.clear();
    for (const std::uint32_t cluster : touched_leaves_) {
        if (changes_.empty() || changes_.back().word != cluster / 64)
            changes_.push_back({.word = cluster / 64});
        changes_.back().clusters |= std::uint64_t{1} << (cluster % 64);
    }

    std::atomic<std::size_t> num_blocks = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, light_.size(), BlocksPerTask),
                      [&](const auto& blocks) {
                          for (std::size_t block = blocks.begin(); block < blocks.end(); ++block)
                              if (update_block(transfer_.counts, block, normals_[block], changes_, lit_by_,
                                               lights_.vectors, light_[block])) {
                                  write_radiance(block);
                                  ++num_blocks;
                              }
                      });
    for (const std::uint32_t cluster : touched_leaves_) {
        const auto first = static_cast<std::ptrdiff_t>(cluster * ClusterLights::Stride);
        std::copy_n(lights_.vectors.begin() + first, ClusterLights::Stride, lit_by_.begin() + first);
    }
    return {.num_clusters = touched_leaves_.size(),
            .num_receivers = std::min(num_blocks * prt::BlockSize, radiance_.size()),
            .seconds = seconds_since(start)};
}

void Relighter::write_radiance(std::size_t block) {
    const BlockLight& light = light_[block];
    const BlockNormals& normals = normals_[block];
    const std::size_t begin = block * prt::BlockSize;
    const std::size_t end = std::min(begin + prt::BlockSize, radiance_.size());
    for (std::size_t place = begin; place < end; ++place) {
        const std::size_t lane = place - begin;
        glm::vec3& target = radiance_[transfer_.order[place]];
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double* e = light.visible.data() + 3 * channel;
            const double visible = static_cast<double>(normals.axes[0][lane]) * e[0] +
                                   static_cast<double>(normals.axes[1][lane]) * e[1] +
                                   static_cast<double>(normals.axes[2][lane]) * e[2];
            // A whole cluster counts 16. Sums of nothing may round to a hair below zero.
            const double sum = std::max(0.0, prt::FullCount * visible + light.mixed[channel][lane]);
            target[static_cast<int>(channel)] = static_cast<float>(sum);
        }
    }
}

std::vector<glm::vec3> relight(const prt::Transfer& transfer, const cubemap::CubeMap& environment) {
    Relighter relighter(transfer);
    relighter.set_environment(environment);
    return {relighter.radiance().begin(), relighter.radiance().end()};
}

} // namespace relumine::relight
