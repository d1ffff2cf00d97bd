#include "tests/bench/baselines/dense_transport.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::bench {

namespace {

constexpr std::size_t Lanes = 16;

/// Nothing is merged.
constexpr float NoTolerance = 0.0f;

Scene traced(const Mesh& mesh, std::uint32_t resolution) {
    return precompute(mesh, {.tolerance = NoTolerance,
                             .min_level = static_cast<std::uint32_t>(std::countr_zero(resolution)),
                             .face_resolution = resolution,
                             .no_refine = true,
                             .bounce_tolerance = 0.0f});
}

/// Adds the columns of 2 x 2 texels, [6 R R][16] to [6 R/2 R/2][16].
void add_neighbours(std::span<const float> fine, std::uint32_t fine_resolution,
                    std::span<float> coarse) {
    const std::size_t half = fine_resolution / 2;
    std::ranges::fill(coarse, 0.0f);
    for (std::size_t face = 0; face < cubemap::NumFaces; ++face)
        for (std::size_t y = 0; y < fine_resolution; ++y)
            for (std::size_t x = 0; x < fine_resolution; ++x) {
                const float* const from =
                    &fine[((face * fine_resolution + y) * fine_resolution + x) * Lanes];
                float* const to = &coarse[((face * half + y / 2) * half + x / 2) * Lanes];
                for (std::size_t lane = 0; lane < Lanes; ++lane)
                    to[lane] += from[lane];
            }
}

} // namespace

DenseTransport::DenseTransport(const Mesh& mesh, std::uint32_t resolution)
    : scene_(traced(mesh, resolution)), resolution_(resolution) {
    const std::size_t expected = cubemap::NumFaces * std::size_t{resolution} * resolution;
    const auto leaves = scene_.transfer.quadtree.leaves();
    if (leaves.size() != expected)
        throw std::logic_error(
            fmt::format("expected a leaf for each of {} texels, got {}", expected, leaves.size()));
    texels_.reserve(leaves.size());
    for (const prt::Cell& cell : leaves) {
        const double size = cell.size(), s = cell.x * size, t = cell.y * size;
        texels_.push_back(
            {.direction = cubemap::direction(cell.face, s + size / 2.0, t + size / 2.0),
             .solid_angle = static_cast<float>(cubemap::solid_angle(s, t, s + size, t + size)),
             .index = (static_cast<std::uint32_t>(cell.face) * resolution + cell.y) * resolution +
                      cell.x});
    }
}

void DenseTransport::read(std::size_t block, std::span<float> rows) const {
    const prt::Transfer& transfer = scene_.transfer;
    const std::size_t begin = block * Lanes,
                      end = std::min(begin + Lanes, transfer.num_receivers());
    std::ranges::fill(rows, 0.0f);
    for (std::size_t leaf = 0; leaf < texels_.size(); ++leaf) {
        const Texel& texel = texels_[leaf];
        const float scale = texel.solid_angle / 16.0f * std::numbers::inv_pi_v<float>;
        for (std::size_t place = begin; place < end; ++place)
            rows[texel.index * Lanes + place - begin] =
                scale * static_cast<float>(transfer.counts.count(place, leaf)) *
                std::max(glm::dot(transfer.normals[place], texel.direction), 0.0f);
    }
}

BlockedRows DenseTransport::rows() const {
    return {.num_receivers = num_receivers(),
            .num_columns = num_texels(),
            .read = [this](std::size_t block, std::span<float> rows) {
                read(block, rows);
            }};
}

BlockedRows DenseTransport::rows(std::uint32_t coarser_resolution) const {
    if (coarser_resolution == resolution_)
        return rows();
    const BlockedRows fine = rows(2 * coarser_resolution);
    return {.num_receivers = num_receivers(),
            .num_columns = fine.num_columns / 4,
            .read = [fine, coarser_resolution](std::size_t block, std::span<float> rows) {
                std::vector<float> values(fine.num_columns * Lanes);
                fine.read(block, values);
                add_neighbours(values, 2 * coarser_resolution, rows);
            }};
}

std::vector<glm::vec3> mean_radiance(const cubemap::CubeMap& map, std::uint32_t resolution) {
    const cubemap::CubeMap coarse = cubemap::halved_to(map, resolution);
    if (coarse.resolution != resolution)
        throw std::invalid_argument(
            fmt::format("expected a map that halves to {}, got {}", resolution, map.resolution));
    return coarse.texels;
}

} // namespace relumine::bench
