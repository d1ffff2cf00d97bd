// Means over the pixels of one lat-long for the pixels of another that has the same vertical.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

/// Whether a matrix, orthogonal up to rounding, leaves the vertical axis where it is or turns it
/// over. Rows and columns of a lat-long then stay rows and columns.
[[nodiscard]] bool keeps_vertical(const glm::dmat3& turn);

/// Averages lat-longs over the footprint of each pixel of a lat-long of another size. The means are
/// exact: a footprint is a range of longitudes times a range of latitudes.
///
/// Not thread-safe: its memory serves one picture after the other.
class LatLongResize {
public:
    /// `target_from_source` must keep the vertical.
    LatLongResize(const ImageShape& source, const ImageShape& target,
                  const glm::dmat3& target_from_source);
    ~LatLongResize();

    /// `from` and `to` have the pixels of source and target; `to` gets its size here.
    ///
    /// Cost:  one addition per source pixel and per pixel of a picture with the source's height and
    ///        the target's width. Parallel.
    void average(std::span<const glm::vec3> from, std::vector<glm::vec3>& to);

private:
    struct Tables;
    std::unique_ptr<const Tables> tables_;
    /// Means of columns, on the source's rows.
    std::vector<glm::vec3> wide_;
};

} // namespace relumine::cubemap
