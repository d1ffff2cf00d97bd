#include "mesh/materials/brdf_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace relumine::mesh {

namespace {

constexpr double Pi = std::numbers::pi, HalfPi = 0.5 * std::numbers::pi;
constexpr std::array<const char*, 3> Colors = {"red", "green", "blue"};

constexpr std::size_t place_of(std::size_t half, std::size_t difference, std::size_t azimuth) {
    return (half * BrdfTable::NumDifference + difference) * BrdfTable::NumAzimuth + azimuth;
}

/// The directions of a half vector at the azimuth 0, and of the light around it.
BrdfDirections directions_of(double theta_h, double theta_d, double phi_d) {
    const glm::dvec3 half(std::sin(theta_h), 0.0, std::cos(theta_h));
    const glm::dvec3 x(half.z, 0.0, -half.x), y(0.0, 1.0, 0.0);
    const glm::dvec3 light =
        std::sin(theta_d) * (std::cos(phi_d) * x + std::sin(phi_d) * y) + std::cos(theta_d) * half;
    return {glm::vec3(light), glm::vec3(2.0 * glm::dot(half, light) * half - light)};
}

double theta_h_at(double index) {
    const double root = index / BrdfTable::NumHalf;
    return HalfPi * root * root;
}

/// The middle of a place.
BrdfDirections directions_at(std::size_t half, std::size_t difference, std::size_t azimuth) {
    return directions_of(theta_h_at(static_cast<double>(half) + 0.5),
                         HalfPi * (static_cast<double>(difference) + 0.5) /
                             BrdfTable::NumDifference,
                         HalfPi * (static_cast<double>(azimuth) + 0.5) / BrdfTable::NumAzimuth);
}

bool is_above(const BrdfDirections& directions, float least = 0.0f) {
    return directions.to_light.z > least && directions.to_eye.z > least;
}

/// Whether a BRDF is defined at each place.
const std::vector<bool>& places_above() {
    static const std::vector<bool> above = [] {
        std::vector<bool> result;
        for (std::size_t h = 0; h < BrdfTable::NumHalf; ++h)
            for (std::size_t d = 0; d < BrdfTable::NumDifference; ++d)
                for (std::size_t a = 0; a < BrdfTable::NumAzimuth; ++a)
                    result.push_back(is_above(directions_at(h, d, a)));
        return result;
    }();
    return above;
}

/// Two places of a table along one of its sides, and the share of the second.
struct Between {
    Between(float index, std::size_t count) {
        const float x = std::clamp(index - 0.5f, 0.0f, static_cast<float>(count - 1));
        first = std::min(static_cast<std::size_t>(x), count - 2);
        share = x - static_cast<float>(first);
    }
    std::size_t first;
    float share;
};

} // namespace

BrdfTable::BrdfTable(std::vector<float> values) : rest_(std::move(values)) {
    if (rest_.size() != 3 * NumPlaces)
        throw std::invalid_argument(
            fmt::format("expected {} x {} x {} x 3 values of a BRDF, got {}", NumHalf,
                        NumDifference, NumAzimuth, rest_.size()));
    const std::vector<bool>& above = places_above();
    for (std::size_t i = 0; i < rest_.size(); ++i)
        if (above[i % NumPlaces] && !(std::isfinite(rest_[i]) && rest_[i] >= 0.0f))
            throw std::invalid_argument(fmt::format(
                "expected a BRDF of finite values of 0 or more, got {} of {} at place {}, {}, {}",
                rest_[i], Colors[i / NumPlaces], i % NumPlaces / (NumDifference * NumAzimuth),
                i / NumAzimuth % NumDifference, i % NumAzimuth));
    fill_horizon();
    split();
    measure();
}

/// Continues the values below the horizon: places between both are interpolated.
void BrdfTable::fill_horizon() {
    const std::vector<bool>& above = places_above();
    for (std::size_t color = 0; color < 3; ++color)
        for (std::size_t h = 0; h < NumHalf; ++h)
            for (std::size_t d = 1; d < NumDifference; ++d)
                for (std::size_t a = 0; a < NumAzimuth; ++a)
                    if (!above[place_of(h, d, a)])
                        rest_[color * NumPlaces + place_of(h, d, a)] =
                            rest_[color * NumPlaces + place_of(h, d - 1, a)];
}

/// Takes the Lambertian part out: the least value where both directions are well above the horizon,
/// since measurements there are poor.
void BrdfTable::split() {
    constexpr float LeastCosine = 0.1f;
    for (int color = 0; color < 3; ++color) {
        const auto own =
            std::span(rest_).subspan(static_cast<std::size_t>(color) * NumPlaces, NumPlaces);
        float least = own[0];
        for (std::size_t h = 0; h < NumHalf; ++h)
            for (std::size_t d = 0; d < NumDifference; ++d)
                for (std::size_t a = 0; a < NumAzimuth; ++a)
                    if (own[place_of(h, d, a)] < least &&
                        is_above(directions_at(h, d, a), LeastCosine))
                        least = own[place_of(h, d, a)];
        lambert_[color] = least * std::numbers::pi_v<float>;
        for (float& value : own)
            value = std::max(value - least, 0.0f);
    }
}

std::vector<float> BrdfTable::values() const {
    std::vector<float> result = rest_;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] += lambert_[static_cast<int>(i / NumPlaces)] * std::numbers::inv_pi_v<float>;
    return result;
}

glm::vec3 BrdfTable::rest(float n_w, float n_v, float sin2) const {
    const float sin_h = std::sqrt(std::clamp(sin2, 0.0f, 1.0f));
    const float cos_h = std::sqrt(std::max(1.0f - sin2, 1e-12f));
    // n.w + n.v = 2 cos_h cos_d, and n.w - n.v = 2 sin_h sin_d cos(phi_d).
    const float cos_d = std::clamp(0.5f * (n_w + n_v) / cos_h, 0.0f, 1.0f);
    const float sin_d = std::sqrt(1.0f - cos_d * cos_d);
    const float cos_phi =
        std::min(0.5f * std::abs(n_w - n_v) / std::max(sin_h * sin_d, 1e-9f), 1.0f);
    constexpr auto PerRadian = static_cast<float>(1.0 / HalfPi);
    const Between h(NumHalf * std::sqrt(std::asin(sin_h) * PerRadian), NumHalf);
    const Between d(NumDifference * std::acos(cos_d) * PerRadian, NumDifference);
    const Between a(NumAzimuth * std::acos(cos_phi) * PerRadian, NumAzimuth);
    const std::size_t first = place_of(h.first, d.first, a.first);
    glm::vec3 result;
    for (int color = 0; color < 3; ++color) {
        const float* at = rest_.data() + static_cast<std::size_t>(color) * NumPlaces + first;
        const auto row = [&](std::size_t offset) {
            return at[offset] + a.share * (at[offset + 1] - at[offset]);
        };
        const auto sheet = [&](std::size_t offset) {
            const float near = row(offset);
            return near + d.share * (row(offset + NumAzimuth) - near);
        };
        const float near = sheet(0);
        result[color] = near + h.share * (sheet(NumAzimuth * NumDifference) - near);
    }
    return result;
}

glm::vec3 BrdfTable::rest_albedo(float n_v) const {
    const auto last = static_cast<float>(albedo_.size() - 1);
    const float x = std::sqrt(std::clamp(n_v, 0.0f, 1.0f)) * last;
    const std::size_t i = std::min(static_cast<std::size_t>(x), albedo_.size() - 2);
    return glm::mix(albedo_[i], albedo_[i + 1], x - static_cast<float>(i));
}

namespace {

/// Integrates the rest over half vectors, which the table resolves.
glm::vec3 integrated(const BrdfTable& table, double n_v) {
    constexpr int Rings = 2 * BrdfTable::NumHalf, Spokes = 48;
    const glm::dvec3 eye(std::sqrt(std::max(1.0 - n_v * n_v, 0.0)), 0.0, n_v);
    glm::dvec3 sum(0.0);
    for (int i = 0; i < Rings; ++i) {
        const double root = (i + 0.5) / Rings, theta = HalfPi * root * root;
        const double ring = HalfPi * 2.0 * root / Rings * std::sin(theta);
        for (int j = 0; j < Spokes; ++j) {
            const double phi = Pi * (j + 0.5) / Spokes; // and its mirror image
            const glm::dvec3 half(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                  std::cos(theta));
            const double v_h = glm::dot(eye, half), n_w = 2.0 * v_h * half.z - eye.z;
            if (v_h <= 0.0 || n_w <= 0.0)
                continue;
            const auto sin2 = static_cast<float>(1.0 - half.z * half.z);
            const glm::dvec3 value(
                table.rest(static_cast<float>(n_w), static_cast<float>(n_v), sin2));
            // d(light) = 4 v.h d(half)
            sum += value * (n_w * 4.0 * v_h * ring * 2.0 * Pi / Spokes);
        }
    }
    return glm::vec3(sum);
}

/// Returns the roughness of a GGX lobe with the same middle of all half vectors: tan(theta_h) =
/// alpha has half of its energy on either side.
float roughness_of(std::span<const float> rest) {
    std::vector<double> sums;
    double sum = 0.0;
    for (std::size_t h = 0; h < BrdfTable::NumHalf; ++h) {
        double value = 0.0;
        for (std::size_t color = 0; color < 3; ++color)
            value += double{rest[color * BrdfTable::NumPlaces + place_of(h, 0, 0)]};
        const double theta = theta_h_at(static_cast<double>(h) + 0.5);
        const double width =
            theta_h_at(static_cast<double>(h) + 1.0) - theta_h_at(static_cast<double>(h));
        sums.push_back(sum += value * std::sin(theta) * std::cos(theta) * width);
    }
    if (!(sum > 0.0))
        return 1.0f;
    const auto middle = std::lower_bound(sums.begin(), sums.end(), 0.5 * sum);
    const double alpha = std::tan(theta_h_at(static_cast<double>(middle - sums.begin()) + 0.5));
    return static_cast<float>(std::sqrt(std::clamp(alpha, 0.0, 1.0)));
}

} // namespace

void BrdfTable::measure() {
    constexpr float LeastCosine = 0.17f, Most = 1.05f;
    const auto last = static_cast<double>(albedo_.size() - 1);
    for (std::size_t i = 0; i < albedo_.size(); ++i) {
        const double root = std::max(static_cast<double>(i) / last, 0.05);
        const auto n_v = static_cast<float>(root * root);
        albedo_[i] = integrated(*this, root * root);
        for (int color = 0; color < 3; ++color)
            if (n_v >= LeastCosine && !(albedo_[i][color] + lambert_[color] <= Most))
                throw std::invalid_argument(fmt::format(
                    "expected a BRDF that reflects at most what arrives, got {:.2f} of {} from a "
                    "view of {:.0f} degrees",
                    albedo_[i][color] + lambert_[color], Colors[static_cast<std::size_t>(color)],
                    std::acos(n_v) * 180.0 / Pi));
        albedo_[i] = glm::min(albedo_[i], 1.0f - glm::min(lambert_, 1.0f));
    }
    roughness_ = roughness_of(rest_);
}

namespace {

/// How the directions of a check differ; a BRDF must not.
struct Check {
    const char* expected;
    BrdfDirections (*changed)(const BrdfDirections& directions);
};

glm::vec3 turned(const glm::vec3& w) {
    constexpr float Cos = 0.6f, Sin = 0.8f;
    return {Cos * w.x - Sin * w.y, Sin * w.x + Cos * w.y, w.z};
}

constexpr std::array<Check, 3> Checks = {
    {{"a reciprocal BRDF: the same where light and eye change places",
      [](const BrdfDirections& of) {
          return BrdfDirections{of.to_eye, of.to_light};
      }},
     {"an isotropic BRDF: the same where light and eye turn about the normal",
      [](const BrdfDirections& of) {
          return BrdfDirections{turned(of.to_light), turned(of.to_eye)};
      }},
     {"a BRDF that is its own mirror image", [](const BrdfDirections& of) {
          return BrdfDirections{{of.to_light.x, -of.to_light.y, of.to_light.z},
                                {of.to_eye.x, -of.to_eye.y, of.to_eye.z}};
      }}}};

constexpr std::size_t NumChecked = 256;

/// Directions at least 6 degrees above the horizon.
std::vector<BrdfDirections> checked_directions() {
    std::mt19937 random(1);
    const auto next = [&random] {
        return static_cast<double>(random()) / 4294967296.0;
    };
    const auto direction = [&] {
        const double z = 0.1 + 0.9 * next(), r = std::sqrt(1.0 - z * z), phi = 2.0 * Pi * next();
        return glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
    };
    std::vector<BrdfDirections> result;
    for (std::size_t i = 0; i < NumChecked; ++i) {
        const glm::vec3 light = direction();
        result.push_back({light, direction()});
    }
    return result;
}

void check(std::span<const glm::vec3> answers) {
    constexpr float Slack = 0.01f;
    for (std::size_t c = 0; c < Checks.size(); ++c)
        for (std::size_t i = 0; i < NumChecked; ++i) {
            const glm::vec3 a = answers[i], b = answers[(c + 1) * NumChecked + i];
            for (int color = 0; color < 3; ++color)
                if (!(std::abs(a[color] - b[color]) <=
                      Slack * std::max({std::abs(a[color]), std::abs(b[color]), 1e-3f})))
                    throw std::invalid_argument(
                        fmt::format("expected {}, got {} and {} of {}", Checks[c].expected,
                                    a[color], b[color], Colors[static_cast<std::size_t>(color)]));
        }
}

} // namespace

std::vector<BrdfDirections> brdf_questions() {
    std::vector<BrdfDirections> result;
    const std::vector<bool>& above = places_above();
    for (std::size_t h = 0; h < BrdfTable::NumHalf; ++h)
        for (std::size_t d = 0; d < BrdfTable::NumDifference; ++d)
            for (std::size_t a = 0; a < BrdfTable::NumAzimuth; ++a)
                if (above[place_of(h, d, a)])
                    result.push_back(directions_at(h, d, a));
    const std::vector<BrdfDirections> checked = checked_directions();
    result.insert(result.end(), checked.begin(), checked.end());
    for (const Check& check : Checks)
        for (const BrdfDirections& directions : checked)
            result.push_back(check.changed(directions));
    return result;
}

std::shared_ptr<const BrdfTable> brdf_of(std::span<const glm::vec3> answers) {
    const std::vector<bool>& above = places_above();
    const auto num_above = static_cast<std::size_t>(std::count(above.begin(), above.end(), true));
    const std::size_t expected = num_above + (1 + Checks.size()) * NumChecked;
    if (answers.size() != expected)
        throw std::invalid_argument(
            fmt::format("expected {} values of a BRDF, got {}", expected, answers.size()));
    std::vector<float> values(3 * BrdfTable::NumPlaces);
    std::size_t next = 0;
    for (std::size_t i = 0; i < BrdfTable::NumPlaces; ++i)
        if (above[i]) {
            for (std::size_t color = 0; color < 3; ++color)
                values[color * BrdfTable::NumPlaces + i] = answers[next][static_cast<int>(color)];
            ++next;
        }
    // A value that is no number is told as such, not as one that is not reciprocal.
    auto table = std::make_shared<const BrdfTable>(std::move(values));
    check(answers.subspan(num_above));
    return table;
}

std::shared_ptr<const BrdfTable>
brdf_of(const std::function<glm::vec3(const BrdfDirections&)>& function) {
    std::vector<glm::vec3> answers;
    for (const BrdfDirections& directions : brdf_questions())
        answers.push_back(function(directions));
    return brdf_of(answers);
}

} // namespace relumine::mesh
