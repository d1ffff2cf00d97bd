#include "relight/kernels/cluster_lights.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/kernels/band_sums.h"
#include "relight/kernels/texel_kernel.h"
#include "relight/radiance.h"

namespace relumine::relight {

namespace {

/// Ranges of texels along one axis for an interval.
struct TexelRange {
    /// Texels that the interval meets.
    std::uint32_t begin, end;
    /// Texels inside the interval; empty (begin == end) for an interval within one texel.
    std::uint32_t whole_begin, whole_end;
};

TexelRange texel_range(double low, double high) {
    TexelRange range{};
    range.begin = static_cast<std::uint32_t>(std::floor(low));
    range.end = static_cast<std::uint32_t>(std::ceil(high));
    range.whole_begin = static_cast<std::uint32_t>(std::ceil(low));
    range.whole_end = std::max(range.whole_begin, static_cast<std::uint32_t>(std::floor(high)));
    return range;
}

/// Sums of L q, L q u and L q v, where q (u, v, 1) is a texel's solid angle times its direction in
/// face coordinates.
struct FaceSums {
    glm::dvec3 one{0.0};
    glm::dvec3 u{0.0};
    glm::dvec3 v{0.0};

    void add(const glm::dvec3& weighted, double at_u, double at_v) {
        one += weighted;
        u += weighted * at_u;
        v += weighted * at_v;
    }
};

/// Adds whole texels. (x, y) is the first of them.
void add_whole(const TexelSums& whole, std::uint32_t x, std::uint32_t y, double step,
               FaceSums& sums) {
    sums.one += whole.one;
    sums.u += whole.x * step + whole.one * ((x + 0.5) * step - 1.0);
    sums.v += whole.y * step + whole.one * ((y + 0.5) * step - 1.0);
}

/// Turns sums in the coordinates of a face to the world.
VectorIrradiance to_world(cubemap::Face face, const FaceSums& sums) {
    const cubemap::FaceAxes axes(face);
    const auto channel = [&](int i) {
        return sums.one[i] * axes.outwards + sums.u[i] * axes.right + sums.v[i] * axes.down;
    };
    return {.red = channel(0), .green = channel(1), .blue = channel(2)};
}

/// Visits the texels of a cell. Parts of texels lie around a rectangle of whole ones; without whole
/// ones, all texels are parts. Calls `part(x, y, u, v, weight)`, where weight times (u, v, 1) is
/// the part's solid angle times its direction, then `whole(columns, rows)` once where there are
/// some.
template<typename Part, typename Whole>
void for_texels(const prt::Cell& cell, std::uint32_t resolution, const Part& part,
                const Whole& whole) {
    const double r = resolution;
    const double s0 = cell.x * cell.size() * r; // in texels
    const double t0 = cell.y * cell.size() * r;
    const double s1 = s0 + cell.size() * r;
    const double t1 = t0 + cell.size() * r;
    const TexelRange columns = texel_range(s0, s1);
    const TexelRange rows = texel_range(t0, t1);
    const auto visit_part = [&](std::uint32_t x, std::uint32_t y) {
        const double part_s0 = std::max(s0, static_cast<double>(x)) / r;
        const double part_s1 = std::min(s1, x + 1.0) / r;
        const double part_t0 = std::max(t0, static_cast<double>(y)) / r;
        const double part_t1 = std::min(t1, y + 1.0) / r;
        const double u = part_s0 + part_s1 - 1.0;
        const double v = part_t0 + part_t1 - 1.0;
        part(x, y, u, v,
             cubemap::solid_angle(part_s0, part_t0, part_s1, part_t1) /
                 std::sqrt(u * u + v * v + 1.0));
    };
    const bool any_whole =
        columns.whole_begin < columns.whole_end && rows.whole_begin < rows.whole_end;
    for (std::uint32_t y = rows.begin; y < rows.end; ++y) {
        const bool whole_row = any_whole && y >= rows.whole_begin && y < rows.whole_end;
        for (std::uint32_t x = columns.begin; x < (whole_row ? columns.whole_begin : columns.end);
             ++x)
            visit_part(x, y);
        for (std::uint32_t x = columns.whole_end; whole_row && x < columns.end; ++x)
            visit_part(x, y);
    }
    if (any_whole)
        whole(columns, rows);
}

} // namespace

VectorIrradiance& VectorIrradiance::operator+=(const VectorIrradiance& other) {
    red += other.red;
    green += other.green;
    blue += other.blue;
    return *this;
}

VectorIrradiance& VectorIrradiance::operator-=(const VectorIrradiance& other) {
    red -= other.red;
    green -= other.green;
    blue -= other.blue;
    return *this;
}

LightBinning::LightBinning(std::uint32_t face_resolution) : resolution_(face_resolution) {
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(face_resolution);
    weights_.resize(solid_angles.size());
    const double step = 2.0 / face_resolution;
    files::parallel_for(std::size_t{0}, std::size_t{face_resolution}, [&](std::size_t y) {
        for (std::size_t x = 0; x < face_resolution; ++x) {
            const double u = (static_cast<double>(x) + 0.5) * step - 1.0;
            const double v = (static_cast<double>(y) + 0.5) * step - 1.0;
            const std::size_t i = y * face_resolution + x;
            weights_[i] = static_cast<float>(solid_angles[i] / std::sqrt(u * u + v * v + 1.0));
        }
    });
}

VectorIrradiance LightBinning::sum(const cubemap::CubeMap& environment,
                                   const prt::Cell& cell) const {
    FaceSums sums;
    for_texels(
        cell, resolution_,
        [&](std::uint32_t x, std::uint32_t y, double u, double v, double weight) {
            sums.add(glm::dvec3(environment.at(cell.face, x, y)) * weight, u, v);
        },
        [&](const TexelRange& columns, const TexelRange& rows) {
            const TexelSums whole = texel_sums(
                &environment.at(cell.face, columns.whole_begin, rows.whole_begin),
                weights_.data() + std::size_t{rows.whole_begin} * resolution_ + columns.whole_begin,
                resolution_, columns.whole_end - columns.whole_begin,
                rows.whole_end - rows.whole_begin);
            add_whole(whole, columns.whole_begin, rows.whole_begin, 2.0 / resolution_, sums);
        });
    return to_world(cell.face, sums);
}

void LightBinning::add_derivative(const prt::Cell& cell, const VectorIrradiance& derivative,
                                  cubemap::CubeMap& texels) const {
    const cubemap::FaceAxes axes(cell.face);
    const auto along = [&](const glm::dvec3& axis) {
        return glm::dvec3(glm::dot(derivative.red, axis), glm::dot(derivative.green, axis),
                          glm::dot(derivative.blue, axis));
    };
    const glm::dvec3 one = along(axes.outwards), of_u = along(axes.right), of_v = along(axes.down);
    for_texels(
        cell, resolution_,
        [&](std::uint32_t x, std::uint32_t y, double u, double v, double weight) {
            texels.at(cell.face, x, y) += glm::vec3(weight * (one + u * of_u + v * of_v));
        },
        [&](const TexelRange& columns, const TexelRange& rows) {
            const double step = 2.0 / resolution_;
            for (std::uint32_t y = rows.whole_begin; y < rows.whole_end; ++y) {
                const glm::dvec3 of_row = one + ((y + 0.5) * step - 1.0) * of_v;
                for (std::uint32_t x = columns.whole_begin; x < columns.whole_end; ++x)
                    texels.at(cell.face, x, y) +=
                        glm::vec3(static_cast<double>(weights_[std::size_t{y} * resolution_ + x]) *
                                  (of_row + ((x + 0.5) * step - 1.0) * of_u));
            }
        });
}

std::vector<VectorIrradiance> LightBinning::sums(const cubemap::CubeMap& environment,
                                                 std::span<const prt::Cell> cells,
                                                 Texels texels) const {
    return sums(environment, BandSums(resolution_, cells), texels);
}

std::vector<VectorIrradiance> LightBinning::sums(const cubemap::CubeMap& environment,
                                                 const BandSums& bands, Texels texels) const {
    const std::span<const prt::Cell> cells = bands.cells();
    const BandSums::Result whole = bands.sums(environment, weights_);
    std::uint32_t most_bits = 0; // Emscripten's library has no std::bit_cast
    std::memcpy(&most_bits, &MaxRadiance, sizeof most_bits);
    const bool is_good = bands.reads_all() && whole.largest_bits <= most_bits;
    if (texels == Texels::Unchecked && !is_good)
        require_radiance(environment.texels);
    std::vector<VectorIrradiance> result(cells.size());
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        const prt::Cell& cell = cells[i];
        if (!bands.has(i)) {
            result[i] = sum(environment, cell);
            return;
        }
        const std::uint32_t edge = resolution_ >> cell.level;
        FaceSums sums;
        add_whole(whole.sums[i], cell.x * edge, cell.y * edge, 2.0 / resolution_, sums);
        result[i] = to_world(cell.face, sums);
    });
    return result;
}

} // namespace relumine::relight
