#include "relight/row_kernel.h"

#include <algorithm>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relight/row_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::relight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t RunLength = 256;

/// Sums of one run, u counted from the run's own start in steps: small whole numbers, exact in float.
struct RunSums {
    glm::dvec3 one{0.0};
    glm::dvec3 index{0.0};
};

RunSums sum_run(const glm::vec3* radiance, const float* weights, std::size_t count) {
    const hn::CappedTag<float, 16> d;
    const std::size_t num_lanes = hn::Lanes(d);
    const auto* values = reinterpret_cast<const float*>(radiance);
    auto one_r = hn::Zero(d);
    auto one_g = hn::Zero(d);
    auto one_b = hn::Zero(d);
    auto index_r = hn::Zero(d);
    auto index_g = hn::Zero(d);
    auto index_b = hn::Zero(d);
    auto index = hn::Iota(d, 0.0f);
    const auto next = hn::Set(d, static_cast<float>(num_lanes));
    std::size_t i = 0;
    for (; i + num_lanes <= count; i += num_lanes) {
        auto r = hn::Zero(d);
        auto g = hn::Zero(d);
        auto b = hn::Zero(d);
        hn::LoadInterleaved3(d, values + 3 * i, r, g, b);
        const auto q = hn::LoadU(d, weights + i);
        const auto qi = hn::Mul(q, index);
        one_r = hn::MulAdd(q, r, one_r);
        one_g = hn::MulAdd(q, g, one_g);
        one_b = hn::MulAdd(q, b, one_b);
        index_r = hn::MulAdd(qi, r, index_r);
        index_g = hn::MulAdd(qi, g, index_g);
        index_b = hn::MulAdd(qi, b, index_b);
        index = hn::Add(index, next);
    }
    const auto total = [&](auto v) {
        return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v)));
    };
    RunSums sums{.one = {total(one_r), total(one_g), total(one_b)},
                 .index = {total(index_r), total(index_g), total(index_b)}};
    for (; i < count; ++i) {
        const glm::dvec3 weighted = glm::dvec3(radiance[i]) * static_cast<double>(weights[i]);
        sums.one += weighted;
        sums.index += weighted * static_cast<double>(i);
    }
    return sums;
}

RowSums row_sums(const glm::vec3* radiance, const float* weights, std::size_t count, double first_u,
                 double step) {
    RowSums row;
    for (std::size_t begin = 0; begin < count; begin += RunLength) {
        const RunSums run = sum_run(radiance + begin, weights + begin, std::min(RunLength, count - begin));
        row.one += run.one;
        row.u += run.one * (first_u + static_cast<double>(begin) * step) + run.index * step;
    }
    return row;
}

} // namespace relumine::relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::relight {

namespace {
HWY_EXPORT(row_sums);
}

RowSums row_sums(const glm::vec3* radiance, const float* weights, std::size_t count, double first_u,
                 double step) {
    return HWY_DYNAMIC_DISPATCH(row_sums)(radiance, weights, count, first_u, step);
}

} // namespace relumine::relight
#endif // HWY_ONCE
