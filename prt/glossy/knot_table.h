// A place in a square table over roughness and the cosine between normal and eye.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace relumine::prt {

/// Interpolates between knots that are even in roughness and in the square root of the cosine:
/// integrals of lobes change fast at grazing views.
class KnotPlace {
public:
    KnotPlace(std::size_t num_knots, float roughness, float n_v) {
        const auto last = static_cast<float>(num_knots - 1);
        const float y = std::clamp(roughness, 0.0f, 1.0f) * last;
        const float x = std::sqrt(std::clamp(n_v, 0.0f, 1.0f)) * last;
        row_ = std::min(static_cast<std::size_t>(y), num_knots - 2);
        column_ = std::min(static_cast<std::size_t>(x), num_knots - 2);
        t_ = y - static_cast<float>(row_);
        s_ = x - static_cast<float>(column_);
    }

    /// `at(row, column)` is the value of a knot.
    template<class At>
    [[nodiscard]] float between(const At& at) const {
        const auto of_row = [&](std::size_t row) {
            return (1.0f - s_) * at(row, column_) + s_ * at(row, column_ + 1);
        };
        return (1.0f - t_) * of_row(row_) + t_ * of_row(row_ + 1);
    }

private:
    std::size_t row_, column_;
    float t_, s_;
};

} // namespace relumine::prt
