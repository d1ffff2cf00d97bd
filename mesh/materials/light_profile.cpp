#include "mesh/materials/light_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace relumine::mesh {

namespace {

constexpr double Degree = std::numbers::pi / 180.0;

[[noreturn]] void fail(const std::string& expected, const std::string& got) {
    throw std::invalid_argument(fmt::format("expected {}, got {}", expected, got));
}

/// The steps on both sides of an angle, and the weight of the second.
struct Steps {
    std::size_t first = 0, second = 0;
    double weight = 0.0;
};

/// `angle` lies within the angles.
Steps steps_beside(const std::vector<float>& angles, double angle) {
    const auto above = static_cast<std::size_t>(
        std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin());
    if (above == angles.size())
        return {above - 1, above - 1, 0.0};
    const std::size_t below = above == 0 ? 0 : above - 1;
    const double low{angles[below]}, width = double{angles[above]} - low;
    return {below, above, width > 0.0 ? std::max(angle - low, 0.0) / width : 0.0};
}

double span_of(const std::vector<float>& horizontal) {
    return double{horizontal.back()} - double{horizontal.front()};
}

/// Brings any angle to where the table has it.
double folded(const std::vector<float>& horizontal, double degrees) {
    const double span = span_of(horizontal);
    double angle = std::fmod(degrees - double{horizontal.front()}, 360.0);
    if (angle < 0.0)
        angle += 360.0;
    if (span <= 180.0 && angle > 180.0)
        angle = 360.0 - angle;
    if (span <= 90.0 && angle > 90.0)
        angle = 180.0 - angle;
    return double{horizontal.front()} + std::min(angle, span);
}

void check_angles(const char* name, const std::vector<float>& angles) {
    for (std::size_t i = 0; i < angles.size(); ++i)
        if (!(angles[i] >= (i == 0 ? 0.0f : angles[i - 1]) && angles[i] <= 360.0f))
            fail(fmt::format("{} angles that ascend from 0 on", name),
                 i == 0 ? fmt::format("{}", angles[i])
                        : fmt::format("{} behind {}", angles[i], angles[i - 1]));
}

void check(const LightProfileTable& table) {
    if (table.vertical.size() < 2)
        fail("two vertical angles or more", fmt::format("{}", table.vertical.size()));
    if (table.horizontal.empty())
        fail("a horizontal angle", "none");
    if (table.candela.size() != table.vertical.size() * table.horizontal.size())
        fail(fmt::format("{} x {} intensities", table.horizontal.size(), table.vertical.size()),
             fmt::format("{}", table.candela.size()));
    check_angles("vertical", table.vertical);
    check_angles("horizontal", table.horizontal);
    if (table.vertical.back() > 180.0f)
        fail("vertical angles up to 180", fmt::format("{}", table.vertical.back()));
    const std::pair ends(table.horizontal.front(), table.horizontal.back());
    constexpr std::array<std::pair<float, float>, 4> Ends = {
        {{0.0f, 90.0f}, {0.0f, 180.0f}, {0.0f, 360.0f}, {90.0f, 270.0f}}};
    if (table.horizontal.size() > 1 && std::find(Ends.begin(), Ends.end(), ends) == Ends.end())
        fail("horizontal angles of 0 to 90, 0 to 180, 0 to 360 or 90 to 270",
             fmt::format("{} to {}", ends.first, ends.second));
    for (const float candela : table.candela)
        if (!(candela >= 0.0f && candela <= MaxCandela))
            fail(fmt::format("intensities of 0 to {:g} candela", MaxCandela),
                 fmt::format("{}", candela));
}

/// The integral of candela times the sine over vertical angles, exact for what at() interpolates.
double integral_over_vertical(const std::vector<float>& vertical, const float* candela) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < vertical.size(); ++i) {
        const double a = Degree * double{vertical[i]}, b = Degree * double{vertical[i + 1]};
        const double at_a{candela[i]}, at_b{candela[i + 1]};
        if (b > a)
            sum += at_a * std::cos(a) - at_b * std::cos(b) +
                   (at_b - at_a) * (std::sin(b) - std::sin(a)) / (b - a);
    }
    return sum;
}

} // namespace

LightProfile::LightProfile(LightProfileTable table) {
    check(table);
    table_ = std::make_shared<const LightProfileTable>(std::move(table));
}

double LightProfile::at(double vertical_degrees, double horizontal_degrees) const {
    if (empty() || !(vertical_degrees >= double{table_->vertical.front()} &&
                     vertical_degrees <= double{table_->vertical.back()}))
        return 0.0;
    const Steps v = steps_beside(table_->vertical, vertical_degrees);
    const Steps h =
        steps_beside(table_->horizontal, folded(table_->horizontal, horizontal_degrees));
    const auto row = [&](std::size_t index) {
        const float* candela = table_->candela.data() + index * table_->vertical.size();
        return std::lerp(double{candela[v.first]}, double{candela[v.second]}, v.weight);
    };
    return std::lerp(row(h.first), row(h.second), h.weight);
}

double LightProfile::flux() const {
    if (empty())
        return 0.0;
    const auto row = [this](std::size_t index) {
        return integral_over_vertical(table_->vertical,
                                      table_->candela.data() + index * table_->vertical.size());
    };
    const std::vector<float>& horizontal = table_->horizontal;
    if (horizontal.size() == 1)
        return 2.0 * std::numbers::pi * row(0);
    double sum = 0.0, before = row(0);
    for (std::size_t i = 1; i < horizontal.size(); ++i) {
        const double next = row(i);
        sum += 0.5 * (before + next) * Degree * (double{horizontal[i]} - double{horizontal[i - 1]});
        before = next;
    }
    return sum * 360.0 / span_of(horizontal);
}

float LightProfile::largest() const {
    return empty() ? 0.0f : *std::max_element(table_->candela.begin(), table_->candela.end());
}

bool LightProfile::operator==(const LightProfile& other) const {
    return table_ == other.table_ || (!empty() && !other.empty() && *table_ == *other.table_);
}

} // namespace relumine::mesh
