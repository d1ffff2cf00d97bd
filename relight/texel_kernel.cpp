#include "relight/texel_kernel.h"

#include <algorithm>
#include <array>
#include <cstdint>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/texel_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t MaxLanes = 16;
constexpr std::size_t RowsPerRun = 64;

/// As many columns side by side as D has lanes. Their texels' colours fill three vectors as they
/// lie in memory. Each weight is spread over the three lanes of its texel.
template<class D>
class Columns {
    using Vec = hn::Vec<D>;
    static constexpr std::size_t NumFloats = 3 * MaxLanes;

public:
    Columns() {
        for (std::size_t i = 0; i < NumFloats; ++i)
            texel_of_[i] = static_cast<std::int32_t>(i / 3);
    }

    void add_to(TexelSums& sums, const glm::vec3* radiance, const float* weights,
                std::size_t stride, std::size_t first_x, std::size_t height) const {
        const D d;
        const std::size_t n = hn::Lanes(d);
        const auto* values = reinterpret_cast<const float*>(radiance);
        for (std::size_t begin = 0; begin < height; begin += RowsPerRun) {
            const std::size_t end = std::min(begin + RowsPerRun, height);
            auto one_0 = hn::Zero(d), one_1 = hn::Zero(d), one_2 = hn::Zero(d);
            auto y_0 = hn::Zero(d), y_1 = hn::Zero(d), y_2 = hn::Zero(d);
            for (std::size_t row = begin; row < end; ++row) {
                const float* l = values + 3 * row * stride;
                const auto q = hn::LoadU(d, weights + row * stride);
                const auto y = hn::Set(d, static_cast<float>(row - begin));
                add(hn::Mul(spread(q, 0), hn::LoadU(d, l)), y, one_0, y_0);
                add(hn::Mul(spread(q, 1), hn::LoadU(d, l + n)), y, one_1, y_1);
                add(hn::Mul(spread(q, 2), hn::LoadU(d, l + 2 * n)), y, one_2, y_2);
            }
            std::array<float, NumFloats> one, y;
            hn::StoreU(one_0, d, one.data());
            hn::StoreU(one_1, d, one.data() + n);
            hn::StoreU(one_2, d, one.data() + 2 * n);
            hn::StoreU(y_0, d, y.data());
            hn::StoreU(y_1, d, y.data() + n);
            hn::StoreU(y_2, d, y.data() + 2 * n);
            add_columns(one.data(), y.data(), n, static_cast<double>(first_x),
                        static_cast<double>(begin), sums);
        }
    }

private:
    static void add(Vec weighted, Vec y, Vec& sum, Vec& sum_y) {
        sum = hn::Add(sum, weighted);
        sum_y = hn::MulAdd(weighted, y, sum_y);
    }

    /// Returns the weights for the given third of the columns' colours.
    Vec spread(Vec weights, std::size_t third) const {
        const D d;
        return hn::TableLookupLanes(
            weights, hn::SetTableIndices(d, texel_of_.data() + third * hn::Lanes(d)));
    }

    static void add_columns(const float* one, const float* y, std::size_t num_columns,
                            double first_x, double first_y, TexelSums& sums) {
        glm::dvec3 of_one(0.0), of_x(0.0), of_y(0.0);
        for (std::size_t i = 0; i < num_columns; ++i, one += 3, y += 3) {
            const glm::dvec3 column(one[0], one[1], one[2]);
            of_one += column;
            of_x += column * static_cast<double>(i);
            of_y += glm::dvec3(y[0], y[1], y[2]);
        }
        sums.one += of_one;
        sums.x += of_x + of_one * first_x;
        sums.y += of_y + of_one * first_y;
    }

    std::array<std::int32_t, NumFloats> texel_of_;
};

TexelSums texel_sums(const glm::vec3* radiance, const float* weights, std::size_t stride,
                     std::size_t width, std::size_t height) {
    TexelSums sums;
    std::size_t x = 0;
    const auto add_columns = [&](auto d) {
        const Columns<decltype(d)> columns;
        for (const std::size_t n = hn::Lanes(d); x + n <= width; x += n)
            columns.add_to(sums, radiance + x, weights + x, stride, x, height);
    };
    add_columns(hn::CappedTag<float, MaxLanes>());
    add_columns(hn::CappedTag<float, 8>());
    add_columns(hn::CappedTag<float, 4>());
    for (; x < width; ++x)
        for (std::size_t y = 0; y < height; ++y) {
            const glm::dvec3 weighted =
                glm::dvec3(radiance[y * stride + x]) * static_cast<double>(weights[y * stride + x]);
            sums.one += weighted;
            sums.x += weighted * static_cast<double>(x);
            sums.y += weighted * static_cast<double>(y);
        }
    return sums;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(texel_sums);
}

TexelSums texel_sums(const glm::vec3* radiance, const float* weights, std::size_t stride,
                     std::size_t width, std::size_t height) {
    return HWY_DYNAMIC_DISPATCH(texel_sums)(radiance, weights, stride, width, height);
}

} // namespace relumine::relight
#endif // HWY_ONCE
