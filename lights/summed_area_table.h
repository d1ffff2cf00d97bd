// Sums over rectangles of an image in constant time.
// Based on: F. Crow, "Summed-area tables for texture mapping", SIGGRAPH 1984.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "files/parallel.h"
#include "lights/lat_long_grid.h"

namespace relumine::lights {

/// Prefix sums over the columns and rows of an image. Values are of type T: double, or a vector of
/// doubles.
///
/// Error:   a sum has the rounding error of the whole image's sum, about 1e-16 of it. The sum over
///          a rectangle of zeros may therefore differ from 0.
template<typename T>
class SummedAreaTable {
public:
    /// Builds the table. `row_values(y, T* row)` writes the values of a row.
    ///
    /// Cost:    O(pixels), in parallel; bitwise the same for any number of threads.
    template<typename RowValues>
    SummedAreaTable(std::uint32_t width, std::uint32_t height, const RowValues& row_values);

    /// Returns the sum over pixels [x0, x1) x [y0, y1).
    [[nodiscard]] T sum(const PixelRectangle& region) const {
        return (at(region.x1, region.y1) - at(region.x0, region.y1)) -
               (at(region.x1, region.y0) - at(region.x0, region.y0));
    }

private:
    [[nodiscard]] const T& at(std::uint32_t x, std::uint32_t y) const {
        return table_[y * stride_ + x];
    }

    std::size_t stride_;
    /// [(height + 1) * (width + 1)]: sums over the pixels to the left and above.
    std::unique_ptr<T[]> table_;
};

template<typename T>
template<typename RowValues>
SummedAreaTable<T>::SummedAreaTable(std::uint32_t width, std::uint32_t height,
                                    const RowValues& row_values)
    : stride_(std::size_t{width} + 1),
      table_(std::make_unique_for_overwrite<T[]>(stride_ * (std::size_t{height} + 1))) {
    std::fill_n(table_.get(), stride_, T(0.0));
    files::parallel_for(std::uint32_t{0}, height, [&](std::uint32_t y) {
        T* row = table_.get() + (std::size_t{y} + 1) * stride_;
        row[0] = T(0.0);
        row_values(y, row + 1);
        for (std::size_t x = 1; x < stride_; ++x)
            row[x] += row[x - 1];
    });
    // Columns are added in strips of 4 KiB per row, so the row above is still in the cache.
    constexpr std::size_t Width = 4096 / sizeof(T);
    files::parallel_for(std::size_t{0}, (stride_ + Width - 1) / Width, [&](std::size_t strip) {
        const std::size_t begin = strip * Width, end = std::min(begin + Width, stride_);
        for (std::size_t y = 1; y <= height; ++y) {
            const T* above = table_.get() + (y - 1) * stride_;
            T* row = table_.get() + y * stride_;
            for (std::size_t x = begin; x < end; ++x)
                row[x] += above[x];
        }
    });
}

} // namespace relumine::lights
