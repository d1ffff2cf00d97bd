#include "relight/kernels/cluster_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "relight/kernels/band_sums.h"
#include "relight/kernels/texel_kernel.h"

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
    // cube_point is linear in (2s - 1, 2t - 1, 1) for a fixed face.
    const glm::dvec3 centre = cubemap::cube_point(face, 0.5, 0.5);
    const glm::dvec3 right = cubemap::cube_point(face, 1.0, 0.5) - centre;
    const glm::dvec3 down = cubemap::cube_point(face, 0.5, 1.0) - centre;
    const auto channel = [&](int i) {
        return sums.one[i] * centre + sums.u[i] * right + sums.v[i] * down;
    };
    return {.red = channel(0), .green = channel(1), .blue = channel(2)};
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
    const double r = resolution_;
    const double s0 = cell.x * cell.size() * r; // in texels
    const double t0 = cell.y * cell.size() * r;
    const double s1 = s0 + cell.size() * r;
    const double t1 = t0 + cell.size() * r;
    const TexelRange columns = texel_range(s0, s1);
    const TexelRange rows = texel_range(t0, t1);
    const double step = 2.0 / r;
    FaceSums sums;

    const auto add_part = [&](std::uint32_t x, std::uint32_t y) {
        const double part_s0 = std::max(s0, static_cast<double>(x)) / r;
        const double part_s1 = std::min(s1, x + 1.0) / r;
        const double part_t0 = std::max(t0, static_cast<double>(y)) / r;
        const double part_t1 = std::min(t1, y + 1.0) / r;
        const double u = part_s0 + part_s1 - 1.0;
        const double v = part_t0 + part_t1 - 1.0;
        const double weight = cubemap::solid_angle(part_s0, part_t0, part_s1, part_t1) /
                              std::sqrt(u * u + v * v + 1.0);
        sums.add(glm::dvec3(environment.at(cell.face, x, y)) * weight, u, v);
    };
    // Parts of texels lie around a rectangle of whole ones. Without whole ones, all texels are
    // parts.
    const bool any_whole =
        columns.whole_begin < columns.whole_end && rows.whole_begin < rows.whole_end;
    for (std::uint32_t y = rows.begin; y < rows.end; ++y) {
        const bool whole_row = any_whole && y >= rows.whole_begin && y < rows.whole_end;
        for (std::uint32_t x = columns.begin; x < (whole_row ? columns.whole_begin : columns.end);
             ++x)
            add_part(x, y);
        for (std::uint32_t x = columns.whole_end; whole_row && x < columns.end; ++x)
            add_part(x, y);
    }
    if (any_whole) {
        const TexelSums whole = texel_sums(
            &environment.at(cell.face, columns.whole_begin, rows.whole_begin),
            weights_.data() + std::size_t{rows.whole_begin} * resolution_ + columns.whole_begin,
            resolution_, columns.whole_end - columns.whole_begin,
            rows.whole_end - rows.whole_begin);
        add_whole(whole, columns.whole_begin, rows.whole_begin, step, sums);
    }
    return to_world(cell.face, sums);
}

std::vector<VectorIrradiance> LightBinning::sums(const cubemap::CubeMap& environment,
                                                 std::span<const prt::Cell> cells) const {
    const BandSums bands(resolution_, cells);
    const std::vector<TexelSums> whole = bands.sums(environment, weights_);
    std::vector<VectorIrradiance> result(cells.size());
    files::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        const prt::Cell& cell = cells[i];
        if (!bands.has(i)) {
            result[i] = sum(environment, cell);
            return;
        }
        const std::uint32_t edge = resolution_ >> cell.level;
        FaceSums sums;
        add_whole(whole[i], cell.x * edge, cell.y * edge, 2.0 / resolution_, sums);
        result[i] = to_world(cell.face, sums);
    });
    return result;
}

} // namespace relumine::relight
