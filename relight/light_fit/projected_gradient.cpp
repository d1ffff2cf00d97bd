#include "relight/light_fit/projected_gradient.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <vector>

#include "prt/work.h"

namespace relumine::relight {

namespace {

// A step may raise the value, as long as it stays below the largest of so many before.
constexpr std::size_t Memory = 10;
// The part of the decrease that a straight line promises, which a step must bring.
constexpr double Sufficient = 1e-4;
constexpr double SmallestStep = 1e-30, LargestStep = 1e30;
constexpr int MaxHalvings = 40;

double dot(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

struct Point {
    std::vector<double> x, gradient;
    double value = 0.0;
};

/// Goes from `here` along `direction` as far as the value allows. Returns false where nothing
/// lowers it any more.
bool take_step(const Objective& objective, const Point& here, std::span<const double> direction,
               double largest_before, Point& there) {
    const double slope = dot(here.gradient, direction);
    double length = 1.0;
    for (int halving = 0; halving < MaxHalvings && slope < 0.0; ++halving) {
        for (std::size_t i = 0; i < there.x.size(); ++i)
            there.x[i] = std::max(0.0, here.x[i] + length * direction[i]);
        there.value = objective(there.x, there.gradient);
        if (there.value <= largest_before + Sufficient * length * slope)
            return true;
        // The least value of the parabola through what is known, kept away from both ends.
        const double curve = there.value - here.value - length * slope;
        const double best = curve > 0.0 ? -0.5 * slope * length * length / curve : 0.0;
        length = std::clamp(best, 0.1 * length, 0.5 * length);
    }
    return false;
}

} // namespace

GradientReport minimise_non_negative(const Objective& objective, std::span<double> x,
                                     const GradientOptions& options, const prt::Work& work) {
    const std::size_t size = x.size();
    Point here{{x.begin(), x.end()}, std::vector<double>(size)}, there = here;
    here.value = objective(here.x, here.gradient);
    GradientReport report{.value = here.value};
    std::deque<double> values = {here.value};
    std::vector<double> direction(size), best_values = {here.value};
    double step = 0.0;
    for (const double slope : here.gradient)
        step = std::max(step, std::abs(slope));
    step = step > 0.0 ? std::max(1e-3, *std::max_element(x.begin(), x.end())) / step : 1.0;
    while (report.num_iterations < options.max_iterations) {
        work.poll();
        for (std::size_t i = 0; i < size; ++i)
            direction[i] = std::max(0.0, here.x[i] - step * here.gradient[i]) - here.x[i];
        if (!take_step(objective, here, direction, *std::max_element(values.begin(), values.end()),
                       there))
            break;
        // The curvature along the last step is that of the next one [Barzilai and Borwein 1988].
        double moved = 0.0, curved = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            const double change = there.x[i] - here.x[i];
            moved += change * change;
            curved += change * (there.gradient[i] - here.gradient[i]);
        }
        step = std::clamp(curved > 0.0 ? moved / curved : LargestStep, SmallestStep, LargestStep);
        std::swap(here, there);
        ++report.num_iterations;
        values.push_back(here.value);
        if (values.size() > Memory)
            values.pop_front();
        if (here.value < report.value) {
            report.value = here.value;
            std::copy(here.x.begin(), here.x.end(), x.begin());
        }
        best_values.push_back(report.value);
        work.tell(static_cast<double>(report.num_iterations) /
                  static_cast<double>(options.max_iterations));
        if (best_values.size() > Memory &&
            best_values[best_values.size() - 1 - Memory] - report.value <=
                options.tolerance * report.value)
            break;
    }
    return report;
}

} // namespace relumine::relight
