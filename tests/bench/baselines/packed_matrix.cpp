#include "tests/bench/baselines/packed_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

// Highway compiles the block below once per instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/baselines/packed_matrix.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "files/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace relumine::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t Lanes = 16;

/// sums: [3][16]
template<typename Integer>
void sum_block(const Integer* values, const glm::vec3* light, std::size_t num_columns,
               float* sums) {
    const hn::CappedTag<float, Lanes> d;
    const hn::Rebind<Integer, decltype(d)> small;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    for (std::size_t lane = 0; lane < Lanes; lane += hn::Lanes(d)) {
        auto red = hn::Zero(d), green = red, blue = red;
        for (std::size_t column = 0; column < num_columns; ++column) {
            const auto value = hn::ConvertTo(
                d, hn::PromoteTo(integers, hn::LoadU(small, values + column * Lanes + lane)));
            red = hn::MulAdd(value, hn::Set(d, light[column].r), red);
            green = hn::MulAdd(value, hn::Set(d, light[column].g), green);
            blue = hn::MulAdd(value, hn::Set(d, light[column].b), blue);
        }
        hn::StoreU(red, d, sums + lane);
        hn::StoreU(green, d, sums + Lanes + lane);
        hn::StoreU(blue, d, sums + 2 * Lanes + lane);
    }
}

void sum_bytes(const std::int8_t* values, const glm::vec3* light, std::size_t num_columns,
               float* sums) {
    sum_block(values, light, num_columns, sums);
}
void sum_unsigned_bytes(const std::uint8_t* values, const glm::vec3* light, std::size_t num_columns,
                        float* sums) {
    sum_block(values, light, num_columns, sums);
}
void sum_words(const std::int16_t* values, const glm::vec3* light, std::size_t num_columns,
               float* sums) {
    sum_block(values, light, num_columns, sums);
}

} // namespace relumine::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine::bench {

HWY_EXPORT(sum_bytes);
HWY_EXPORT(sum_unsigned_bytes);
HWY_EXPORT(sum_words);

namespace {

constexpr std::size_t Lanes = 16;

void sum(const std::int8_t* values, const glm::vec3* light, std::size_t count, float* sums) {
    HWY_DYNAMIC_DISPATCH(sum_bytes)(values, light, count, sums);
}
void sum(const std::uint8_t* values, const glm::vec3* light, std::size_t count, float* sums) {
    HWY_DYNAMIC_DISPATCH(sum_unsigned_bytes)(values, light, count, sums);
}
void sum(const std::int16_t* values, const glm::vec3* light, std::size_t count, float* sums) {
    HWY_DYNAMIC_DISPATCH(sum_words)(values, light, count, sums);
}

/// The largest magnitude of each column.
std::vector<float> largest(const BlockedRows& rows) {
    std::vector<float> result(rows.num_columns, 0.0f);
    std::mutex mutex;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, rows.num_blocks(), 16), [&](const auto& blocks) {
            std::vector<float> values(rows.num_columns * Lanes), own(rows.num_columns, 0.0f);
            for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                rows.read(block, values);
                for (std::size_t i = 0; i < values.size(); ++i)
                    own[i / Lanes] = std::max(own[i / Lanes], std::abs(values[i]));
            }
            const std::scoped_lock lock(mutex);
            for (std::size_t i = 0; i < own.size(); ++i)
                result[i] = std::max(result[i], own[i]);
        });
    return result;
}

} // namespace

template<typename Integer>
PackedMatrix<Integer> packed(const BlockedRows& rows) {
    constexpr auto Largest = static_cast<float>(std::numeric_limits<Integer>::max());
    PackedMatrix<Integer> matrix{.num_receivers = rows.num_receivers,
                                 .num_columns = rows.num_columns};
    matrix.values.resize(rows.num_blocks() * rows.num_columns * Lanes);
    matrix.scales = largest(rows);
    for (float& scale : matrix.scales)
        scale = scale > 0.0f ? scale / Largest : 1.0f;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, rows.num_blocks(), 16), [&](const auto& blocks) {
            std::vector<float> values(rows.num_columns * Lanes);
            for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
                rows.read(block, values);
                Integer* const to = matrix.values.data() + block * values.size();
                for (std::size_t i = 0; i < values.size(); ++i)
                    to[i] = static_cast<Integer>(std::lround(values[i] / matrix.scales[i / Lanes]));
            }
        });
    return matrix;
}

template<typename Integer>
void multiply(const PackedMatrix<Integer>& matrix, std::span<const glm::vec3> light,
              std::vector<glm::vec3>& radiance) {
    std::vector<glm::vec3> scaled(light.begin(), light.end());
    for (std::size_t i = 0; i < scaled.size(); ++i)
        scaled[i] *= matrix.scales[i];
    radiance.resize(matrix.num_receivers);
    const std::size_t num_blocks = (matrix.num_receivers + Lanes - 1) / Lanes;
    files::parallel_for(files::IndexRange<std::size_t>(0, num_blocks, 16), [&](const auto& blocks) {
        for (std::size_t block = blocks.begin(); block < blocks.end(); ++block) {
            std::array<float, 3 * Lanes> sums;
            sum(matrix.values.data() + block * matrix.num_columns * Lanes, scaled.data(),
                matrix.num_columns, sums.data());
            const std::size_t first = block * Lanes;
            for (std::size_t i = 0; i < std::min(Lanes, radiance.size() - first); ++i)
                radiance[first + i] = {sums[i], sums[Lanes + i], sums[2 * Lanes + i]};
        }
    });
}

template PackedMatrix<std::int8_t> packed(const BlockedRows&);
template PackedMatrix<std::uint8_t> packed(const BlockedRows&);
template PackedMatrix<std::int16_t> packed(const BlockedRows&);
template void multiply(const PackedMatrix<std::int8_t>&, std::span<const glm::vec3>,
                       std::vector<glm::vec3>&);
template void multiply(const PackedMatrix<std::uint8_t>&, std::span<const glm::vec3>,
                       std::vector<glm::vec3>&);
template void multiply(const PackedMatrix<std::int16_t>&, std::span<const glm::vec3>,
                       std::vector<glm::vec3>&);

} // namespace relumine::bench
#endif // HWY_ONCE
