#include "relight/kernels/texel_kernel.h"

#include <algorithm>
#include <cstdint>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/kernels/texel_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, TexelColumn::Width>;
using Vec = hn::Vec<Lanes>;
using BitLanes = hn::RebindToUnsigned<Lanes>;
using Bits = hn::Vec<BitLanes>;

/// The texel of each colour of a column, as the colours lie in memory.
constexpr auto TexelOf = [] {
    std::array<std::int32_t, 3 * TexelColumn::Width> texel_of{};
    for (std::size_t i = 0; i < texel_of.size(); ++i)
        texel_of[i] = static_cast<std::int32_t>(i / 3);
    return texel_of;
}();

/// Spreads weights over their texels' colours: as many texels as there are lanes, whose colours
/// fill three vectors. Returns the weights for the given third of the colours.
Vec spread(Vec weights, std::size_t third) {
    const Lanes d;
    return hn::TableLookupLanes(weights,
                                hn::SetTableIndices(d, TexelOf.data() + third * hn::Lanes(d)));
}

/// Adds rows to texels [x, x + lanes) of a column, and takes the larger of `largest` and the bits.
HWY_INLINE void add_rows_at(std::size_t x, const float* radiance, const float* weights,
                            std::size_t stride, std::size_t num_rows, TexelColumn& column,
                            Bits& largest) {
    const Lanes d;
    const std::size_t n = hn::Lanes(d);
    float* const one = column.one.data() + 3 * x;
    float* const of_y = column.y.data() + 3 * x;
    auto one_0 = hn::LoadU(d, one), one_1 = hn::LoadU(d, one + n),
         one_2 = hn::LoadU(d, one + 2 * n);
    auto y_0 = hn::LoadU(d, of_y), y_1 = hn::LoadU(d, of_y + n), y_2 = hn::LoadU(d, of_y + 2 * n);
    const auto next = hn::Set(d, 1.0f);
    auto y = hn::Set(d, static_cast<float>(column.height));
    for (std::size_t row = 0; row < num_rows; ++row, y = hn::Add(y, next)) {
        const float* l = radiance + 3 * (row * stride + x);
        const auto q = hn::LoadU(d, weights + row * stride + x);
        const auto colors = [&](std::size_t i) {
            const Vec values = hn::LoadU(d, l + i * n);
            largest = hn::Max(largest, hn::BitCast(BitLanes(), values));
            return hn::Mul(spread(q, i), values);
        };
        const auto first = colors(0), second = colors(1), third = colors(2);
        one_0 = hn::Add(one_0, first);
        one_1 = hn::Add(one_1, second);
        one_2 = hn::Add(one_2, third);
        y_0 = hn::MulAdd(first, y, y_0);
        y_1 = hn::MulAdd(second, y, y_1);
        y_2 = hn::MulAdd(third, y, y_2);
    }
    hn::StoreU(one_0, d, one);
    hn::StoreU(one_1, d, one + n);
    hn::StoreU(one_2, d, one + 2 * n);
    hn::StoreU(y_0, d, of_y);
    hn::StoreU(y_1, d, of_y + n);
    hn::StoreU(y_2, d, of_y + 2 * n);
}

std::uint32_t add_rows(const glm::vec3* radiance, const float* weights, std::size_t stride,
                       std::size_t num_rows, TexelColumn* columns, std::size_t num_columns) {
    const auto* values = reinterpret_cast<const float*>(radiance);
    Bits largest = hn::Zero(BitLanes());
    for (TexelColumn* column = columns; column < columns + num_columns; ++column) {
        for (std::size_t x = 0; x < TexelColumn::Width; x += hn::Lanes(Lanes()))
            add_rows_at(x, values, weights, stride, num_rows, *column, largest);
        column->height += num_rows;
        values += 3 * TexelColumn::Width;
        weights += TexelColumn::Width;
    }
    return hn::GetLane(hn::MaxOfLanes(BitLanes(), largest));
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(add_rows);
}

std::uint32_t add_rows(const glm::vec3* radiance, const float* weights, std::size_t stride,
                       std::size_t num_rows, std::span<TexelColumn> columns) {
    return HWY_DYNAMIC_DISPATCH(add_rows)(radiance, weights, stride, num_rows, columns.data(),
                                          columns.size());
}

void TexelColumn::add_to(TexelSums& sums, std::size_t first_x, std::size_t first_y) const {
    glm::dvec3 of_one(0.0), of_x(0.0), of_y(0.0);
    for (std::size_t i = 0; i < Width; ++i) {
        const glm::dvec3 texel(one[3 * i], one[3 * i + 1], one[3 * i + 2]);
        of_one += texel;
        of_x += texel * static_cast<double>(i);
        of_y += glm::dvec3(y[3 * i], y[3 * i + 1], y[3 * i + 2]);
    }
    sums.one += of_one;
    sums.x += of_x + of_one * static_cast<double>(first_x);
    sums.y += of_y + of_one * static_cast<double>(first_y);
}

TexelSums texel_sums(const glm::vec3* radiance, const float* weights, std::size_t stride,
                     std::size_t width, std::size_t height) {
    TexelSums sums;
    for (std::size_t begin = 0; begin < height; begin += TexelColumn::MaxHeight) {
        const std::size_t num_rows = std::min(TexelColumn::MaxHeight, height - begin);
        std::size_t x = 0;
        for (; x + TexelColumn::Width <= width; x += TexelColumn::Width) {
            TexelColumn column;
            add_rows(radiance + x, weights + x, stride, num_rows, {&column, 1});
            column.add_to(sums, x, begin);
        }
        for (; x < width; ++x)
            for (std::size_t y = 0; y < num_rows; ++y) {
                const glm::dvec3 weighted = glm::dvec3(radiance[y * stride + x]) *
                                            static_cast<double>(weights[y * stride + x]);
                sums.one += weighted;
                sums.x += weighted * static_cast<double>(x);
                sums.y += weighted * static_cast<double>(begin + y);
            }
        radiance += num_rows * stride;
        weights += num_rows * stride;
    }
    return sums;
}

} // namespace relumine::relight
#endif // HWY_ONCE
