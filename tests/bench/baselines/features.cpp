#include "tests/bench/baselines/features.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "files/parallel.h"

namespace relumine::bench {

namespace {

constexpr std::size_t Lanes = 16;

/// [6 R R] of texels' centres
std::vector<std::vector<double>> harmonics_of_texels(std::uint32_t resolution,
                                                     std::uint32_t order) {
    std::vector<std::vector<double>> result;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < resolution; ++y)
            for (std::uint32_t x = 0; x < resolution; ++x)
                result.push_back(
                    spherical_harmonics(cubemap::texel_direction(face, x, y, resolution), order));
    return result;
}

double kept(Window window, std::uint32_t band, std::uint32_t order) {
    return window == Window::None ? 1.0 : 0.5 * (1.0 + std::cos(std::numbers::pi * band / order));
}

/// The coefficients of an environment, by its own texels.
std::vector<glm::vec3> harmonics_of(const cubemap::CubeMap& map, std::uint32_t order,
                                    Window window) {
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(map.resolution);
    std::vector<glm::dvec3> sums(std::size_t{order} * order, glm::dvec3(0.0));
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < map.resolution; ++y)
            for (std::uint32_t x = 0; x < map.resolution; ++x) {
                const glm::dvec3 light = solid_angles[std::size_t{y} * map.resolution + x] *
                                         glm::dvec3(map.at(face, x, y));
                const std::vector<double> basis = spherical_harmonics(
                    cubemap::texel_direction(face, x, y, map.resolution), order);
                for (std::size_t i = 0; i < sums.size(); ++i)
                    sums[i] += basis[i] * light;
            }
    for (std::uint32_t band = 0; band < order; ++band)
        for (std::size_t i = std::size_t{band} * band; i < std::size_t{band + 1} * (band + 1); ++i)
            sums[i] *= kept(window, band, order);
    return {sums.begin(), sums.end()};
}

/// One step of Haar's transform of a square whose rows are `stride` values apart: the upper left
/// quarter gets the sums, the others get the differences.
void transform_once(float* face, std::size_t stride, std::size_t size, std::size_t lanes,
                    std::vector<float>& scratch) {
    const std::size_t half = size / 2;
    scratch.resize(size * size * lanes);
    for (std::size_t y = 0; y < half; ++y)
        for (std::size_t x = 0; x < half; ++x)
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const auto value = [&](std::size_t row, std::size_t column) {
                    return face[((2 * y + row) * stride + 2 * x + column) * lanes + lane];
                };
                const float a = value(0, 0), b = value(0, 1), c = value(1, 0), d = value(1, 1);
                const auto put = [&](std::size_t row, std::size_t column, float sum) {
                    scratch[((row * half + y) * size + column * half + x) * lanes + lane] =
                        0.5f * sum;
                };
                put(0, 0, a + b + c + d);
                put(0, 1, a - b + c - d);
                put(1, 0, a + b - c - d);
                put(1, 1, a - b - c + d);
            }
    for (std::size_t y = 0; y < size; ++y)
        std::copy_n(&scratch[y * size * lanes], size * lanes, face + y * stride * lanes);
}

} // namespace

std::vector<double> spherical_harmonics(const glm::dvec3& direction, std::uint32_t order) {
    // Legendre's functions P(l, m) by l(l+1)/2 + m, without Condon and Shortley's phase and without
    // the power of the sine, which x and y bring along.
    const double z = direction.z;
    std::vector<double> legendre(std::size_t{order} * (order + 1) / 2);
    const auto at = [](std::uint32_t l, std::uint32_t m) {
        return std::size_t{l} * (l + 1) / 2 + m;
    };
    for (std::uint32_t m = 0; m < order; ++m) {
        legendre[at(m, m)] = m == 0 ? 1.0 : (2.0 * m - 1.0) * legendre[at(m - 1, m - 1)];
        for (std::uint32_t l = m + 1; l < order; ++l)
            legendre[at(l, m)] = ((2.0 * l - 1.0) * z * legendre[at(l - 1, m)] -
                                  (l >= m + 2 ? (l + m - 1.0) * legendre[at(l - 2, m)] : 0.0)) /
                                 (l - m);
    }
    std::vector<double> result(std::size_t{order} * order);
    double cosine = 1.0, sine = 0.0;
    for (std::uint32_t m = 0; m < order; ++m) {
        if (m > 0)
            std::tie(cosine, sine) = std::pair(direction.x * cosine - direction.y * sine,
                                               direction.x * sine + direction.y * cosine);
        double factorials = 1.0; // (l - m)! / (l + m)!
        for (std::uint32_t i = 1; i <= 2 * m; ++i)
            factorials /= i;
        for (std::uint32_t l = m; l < order; ++l) {
            if (l > m)
                factorials *= (l - m) / static_cast<double>(l + m);
            const double scale = std::sqrt((m == 0 ? 1.0 : 2.0) * (2.0 * l + 1.0) /
                                           (4.0 * std::numbers::pi) * factorials) *
                                 legendre[at(l, m)];
            result[std::size_t{l} * l + l + m] = scale * cosine;
            if (m > 0)
                result[std::size_t{l} * l + l - m] = scale * sine;
        }
    }
    return result;
}

HarmonicTransport::HarmonicTransport(const DenseTransport& transport, std::uint32_t max_order)
    : num_receivers_(transport.num_receivers()), max_order_(max_order) {
    const BlockedRows rows = transport.rows();
    const std::vector<std::vector<double>> basis =
        harmonics_of_texels(transport.resolution(), max_order);
    const std::size_t num = std::size_t{max_order} * max_order;
    values_.resize(rows.num_blocks() * num * Lanes);
    files::parallel_for(std::size_t{0}, rows.num_blocks(), [&](std::size_t block) {
        std::vector<float> values(rows.num_columns * Lanes);
        rows.read(block, values);
        std::vector<double> sums(num * Lanes, 0.0);
        for (std::size_t texel = 0; texel < rows.num_columns; ++texel)
            for (std::size_t i = 0; i < num; ++i)
                for (std::size_t lane = 0; lane < Lanes; ++lane)
                    sums[i * Lanes + lane] +=
                        basis[texel][i] * static_cast<double>(values[texel * Lanes + lane]);
        std::copy(sums.begin(), sums.end(),
                  values_.begin() + static_cast<std::ptrdiff_t>(block * num * Lanes));
    });
}

Features HarmonicTransport::features(std::uint32_t order, Window window) const {
    const std::size_t all = std::size_t{max_order_} * max_order_ * Lanes;
    return {.rows = {.num_receivers = num_receivers_,
                     .num_columns = std::size_t{order} * order,
                     .read =
                         [this, all](std::size_t block, std::span<float> rows) {
                             std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(block * all),
                                         rows.size(), rows.begin());
                         }},
            .project = [order, window](const cubemap::CubeMap& map) {
                return harmonics_of(map, order, window);
            }};
}

Features texel_features(const DenseTransport& transport, std::uint32_t resolution) {
    return {.rows = transport.rows(resolution),
            .project = [resolution](const cubemap::CubeMap& map) {
                return mean_radiance(map, resolution);
            }};
}

void transform_faces(std::span<float> values, std::uint32_t resolution, std::size_t lanes) {
    const std::size_t of_face = std::size_t{resolution} * resolution * lanes;
    std::vector<float> scratch;
    for (std::size_t face = 0; face < cubemap::NumFaces; ++face)
        for (std::size_t size = resolution; size > 1; size /= 2)
            transform_once(values.data() + face * of_face, resolution, size, lanes, scratch);
}

Features wavelet_features(const DenseTransport& transport) {
    const std::uint32_t resolution = transport.resolution();
    BlockedRows rows = transport.rows();
    const auto read = rows.read;
    rows.read = [read, resolution](std::size_t block, std::span<float> values) {
        read(block, values);
        transform_faces(values, resolution, Lanes);
    };
    return {.rows = std::move(rows), .project = [resolution](const cubemap::CubeMap& map) {
                const std::vector<glm::vec3> mean = mean_radiance(map, resolution);
                std::vector<float> channels;
                for (const glm::vec3& light : mean)
                    channels.insert(channels.end(), {light.r, light.g, light.b});
                transform_faces(channels, resolution, 3);
                std::vector<glm::vec3> result;
                for (std::size_t i = 0; i < channels.size(); i += 3)
                    result.emplace_back(channels[i], channels[i + 1], channels[i + 2]);
                return result;
            }};
}

Features cluster_features(const prt::Transfer& transfer) {
    struct Leaf {
        prt::Cell cell;
        glm::vec3 direction;
        float solid_angle;
    };
    auto leaves = std::make_shared<std::vector<Leaf>>();
    for (const prt::Cell& cell : transfer.quadtree.leaves()) {
        const double size = cell.size(), s = cell.x * size, t = cell.y * size;
        leaves->push_back({cell, cubemap::direction(cell.face, s + size / 2.0, t + size / 2.0),
                           static_cast<float>(cubemap::solid_angle(s, t, s + size, t + size))});
    }
    const auto read = [&transfer, leaves](std::size_t block, std::span<float> rows) {
        std::ranges::fill(rows, 0.0f);
        const std::size_t begin = block * Lanes,
                          end = std::min(begin + Lanes, transfer.num_receivers());
        for (std::size_t leaf = 0; leaf < leaves->size(); ++leaf)
            for (std::size_t place = begin; place < end; ++place)
                rows[leaf * Lanes + place - begin] =
                    (*leaves)[leaf].solid_angle / 16.0f * std::numbers::inv_pi_v<float> *
                    static_cast<float>(transfer.counts.count(place, leaf)) *
                    std::max(glm::dot(transfer.normals[place], (*leaves)[leaf].direction), 0.0f);
    };
    const auto project = [leaves](const cubemap::CubeMap& map) {
        std::vector<cubemap::CubeMap> pyramid{map}; // finest first
        while (pyramid.back().resolution > 1)
            pyramid.push_back(cubemap::halved(pyramid.back()));
        const auto finest = static_cast<std::uint32_t>(pyramid.size() - 1);
        std::vector<glm::vec3> light;
        for (const Leaf& leaf : *leaves) {
            const prt::Cell cell = leaf.cell.above(finest);
            light.push_back(pyramid[finest - cell.level].at(cell.face, cell.x, cell.y));
        }
        return light;
    };
    return {.rows = {.num_receivers = transfer.num_receivers(),
                     .num_columns = leaves->size(),
                     .read = read},
            .project = project};
}

} // namespace relumine::bench
