#include "cubemap/layers/square_coverage.h"

namespace relumine::cubemap {

namespace {

/// Integral of smoothstep from 0.
double first_integral(double t) {
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? t - 0.5 : t * t * t * (1.0 - 0.5 * t);
}

/// Integral of first_integral() from 0.
double second_integral(double t) {
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? 0.5 * t * (t - 1.0) + 0.15 : t * t * t * t * (0.25 - 0.1 * t);
}

} // namespace

double mean_smoothstep(double a, double p, double q) {
    if (std::abs(p) < std::abs(q))
        std::swap(p, q);
    // Where a slope is small, differences of the integrals lose digits and the midpoint is good
    // enough. Its error is the square of the slope: 1e-7 in the first case, 1e-9 in the second.
    if (std::abs(p) < 1e-3)
        return smoothstep(a + 0.5 * (p + q));
    double mean = 0.0;
    if (std::abs(q) < 1e-4 * std::max(1.0, std::abs(p)))
        mean = (first_integral(a + p + 0.5 * q) - first_integral(a + 0.5 * q)) / p;
    else
        mean = (second_integral(a + p + q) - second_integral(a + p) - second_integral(a + q) +
                second_integral(a)) /
               (p * q);
    return std::clamp(mean, 0.0, 1.0);
}

detail::RampFit::RampFit(const std::array<double, 4>& corners, double centre) {
    const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
    const double low = std::min(*least, centre), high = std::max(*most, centre);
    const double p = 0.5 * (corners[1] - corners[0] + corners[3] - corners[2]);
    const double q = 0.5 * (corners[2] - corners[0] + corners[3] - corners[1]);
    const double corner_mean = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    none = high <= 0.0;
    full = low >= 1.0;
    if (none || full) {
        mean = full ? 1.0 : 0.0;
    } else {
        // Two thirds of the centre and one third of the corners make the mean of a quadratic
        // function exactly. So a bend up to the bounds below leaves only an error of the next
        // order. The energy tests check that the bounds are good enough.
        const double level = (2.0 * centre + corner_mean) / 3.0;
        mean = mean_smoothstep(level - 0.5 * (p + q), p, q);
    }
    const double bend = std::abs(centre - corner_mean);
    smooth = high - low <= 0.25 && bend <= 0.02;
    linear = bend <= 0.02 * (std::abs(p) + std::abs(q));
}

} // namespace relumine::cubemap
