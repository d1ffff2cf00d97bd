#include "data_gen/daylight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace relumine::data_gen {
namespace {

constexpr double Pi = std::numbers::pi;

// One wavelength: the sun's radiance above the atmosphere and the absorption of ozone and water
// ([P99] Table 2), and the CIE 1931 2-degree observer.
struct SpectralRow {
    /// In micrometres.
    double wavelength;
    /// In W / (m^2 sr nm).
    double sun;
    /// In 1/cm.
    double ozone;
    /// In 1/cm.
    double water;
    double x, y, z;
};
constexpr double RowWidth = 20.0; // nm
constexpr std::array<SpectralRow, 16> Spectrum = {{
    {0.40, 21127.5, 0.000, 0.000, 0.01431, 0.00040, 0.06785},
    {0.42, 25829.1, 0.000, 0.000, 0.13438, 0.00400, 0.64560},
    {0.44, 26760.5, 0.000, 0.000, 0.34828, 0.02300, 1.74706},
    {0.46, 30545.4, 0.006, 0.000, 0.29080, 0.06000, 1.66920},
    {0.48, 30663.7, 0.014, 0.000, 0.09564, 0.13902, 0.81295},
    {0.50, 28712.1, 0.030, 0.000, 0.00490, 0.32300, 0.27200},
    {0.52, 27100.6, 0.048, 0.000, 0.06327, 0.71000, 0.07825},
    {0.54, 26361.3, 0.075, 0.000, 0.29040, 0.95400, 0.02030},
    {0.56, 25060.2, 0.103, 0.000, 0.59450, 0.99500, 0.00390},
    {0.58, 25355.9, 0.120, 0.000, 0.91630, 0.87000, 0.00165},
    {0.60, 24631.5, 0.125, 0.000, 1.06220, 0.63100, 0.00080},
    {0.62, 23685.3, 0.105, 0.000, 0.85445, 0.38100, 0.00019},
    {0.64, 22827.7, 0.079, 0.000, 0.44790, 0.17500, 0.00002},
    {0.66, 21970.2, 0.057, 0.000, 0.16490, 0.06100, 0.00000},
    {0.68, 21097.9, 0.036, 0.000, 0.04677, 0.01700, 0.00000},
    {0.70, 20240.4, 0.023, 0.024, 0.01136, 0.00410, 0.00000},
}};

// Linear Rec. 709 from CIE XYZ (IEC 61966-2-1). Negative values become 0.
glm::dvec3 rgb_from_xyz(const glm::dvec3& c) {
    return glm::max(glm::dvec3(0.0), glm::dvec3(3.2406 * c.x - 1.5372 * c.y - 0.4986 * c.z,
                                                -0.9689 * c.x + 1.8758 * c.y + 0.0415 * c.z,
                                                0.0557 * c.x - 0.2040 * c.y + 1.0570 * c.z));
}

// The part of the light of one wavelength that passes straight through the air [P99, A.1]. Mixed
// gases absorb only beyond 759 nm.
double transmittance(const SpectralRow& row, double turbidity, double air_mass) {
    const double m = air_mass;
    const double rayleigh = std::exp(-0.008735 * m * std::pow(row.wavelength, -4.08));
    const double beta = 0.04608 * turbidity - 0.04586; // Angstrom's turbidity coefficient
    const double aerosol = std::exp(-beta * m * std::pow(row.wavelength, -1.3));
    constexpr double OzoneCm = 0.35;
    constexpr double WaterCm = 2.0;
    const double ozone = std::exp(-row.ozone * OzoneCm * m);
    const double water = std::exp(-0.2385 * row.water * WaterCm * m /
                                  std::pow(1.0 + 20.07 * row.water * WaterCm * m, 0.45));
    return rayleigh * aerosol * ozone * water;
}

// The sun's radiance in kcd/m^2 as linear RGB.
glm::dvec3 sun_radiance(double turbidity, double zenith_angle) {
    const double zenith_degrees = zenith_angle * 180.0 / Pi;
    const double air_mass =
        1.0 / (std::cos(zenith_angle) + 0.15 * std::pow(93.885 - zenith_degrees, -1.253));
    glm::dvec3 xyz(0.0);
    for (const SpectralRow& row : Spectrum) {
        xyz += row.sun * transmittance(row, turbidity, air_mass) * glm::dvec3(row.x, row.y, row.z);
    }
    constexpr double LumensPerWatt = 683.0;
    return rgb_from_xyz(xyz * (LumensPerWatt * RowWidth / 1000.0));
}

// Luminance Y and chromaticities x and y at the zenith, for a sun at the angle `theta` from it
// [P99, A.2].
std::array<double, 3> zenith_values(double T, double theta) {
    const double chi = (4.0 / 9.0 - T / 120.0) * (Pi - 2.0 * theta);
    const auto cubic = [&](double a, double b, double c, double d) {
        return ((a * theta + b) * theta + c) * theta + d;
    };
    return {(4.0453 * T - 4.9710) * std::tan(chi) - 0.2155 * T + 2.4192,
            T * T * cubic(0.00166, -0.00375, 0.00209, 0.0) +
                T * cubic(-0.02903, 0.06377, -0.03202, 0.00394) +
                cubic(0.11693, -0.21196, 0.06052, 0.25886),
            T * T * cubic(0.00275, -0.00610, 0.00317, 0.0) +
                T * cubic(-0.04214, 0.08970, -0.04153, 0.00516) +
                cubic(0.15346, -0.26756, 0.06670, 0.26688)};
}

void check(bool valid, const char* what, double value) {
    if (!valid) {
        throw std::invalid_argument(fmt::format("daylight: expected {}, got {}", what, value));
    }
}

} // namespace

glm::dvec3 direction_from_angles(double elevation_degrees, double azimuth_degrees) {
    const double elevation = glm::radians(elevation_degrees);
    const double azimuth = glm::radians(azimuth_degrees);
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
            std::cos(elevation) * std::cos(azimuth)};
}

Daylight::Daylight(const DaylightOptions& options) : scale_(options.scale) {
    const double T = options.turbidity;
    check(T >= 1.7 && T <= 10.0, "a turbidity of 1.7 to 10", T);
    check(options.sun_elevation_degrees >= 0.0 && options.sun_elevation_degrees <= 90.0,
          "a sun 0 to 90 degrees above the horizon", options.sun_elevation_degrees);
    check(std::isfinite(options.sun_azimuth_degrees), "a finite azimuth",
          options.sun_azimuth_degrees);
    check(options.scale > 0.0 && std::isfinite(options.scale), "a positive scale", options.scale);
    for (int channel = 0; channel < 3; ++channel) {
        const double albedo = options.ground_albedo[channel];
        check(albedo >= 0.0 && albedo <= 1.0, "a ground albedo of 0 to 1", albedo);
    }
    sun_direction_ =
        direction_from_angles(options.sun_elevation_degrees, options.sun_azimuth_degrees);
    const double theta = glm::radians(90.0 - options.sun_elevation_degrees);

    // [P99, A.2]: coefficients of the distributions.
    distributions_ = {{{0.1787 * T - 1.4630, -0.3554 * T + 0.4275, -0.0227 * T + 5.3251,
                        0.1206 * T - 2.5771, -0.0670 * T + 0.3703},
                       {-0.0193 * T - 0.2592, -0.0665 * T + 0.0008, -0.0004 * T + 0.2125,
                        -0.0641 * T - 0.8989, -0.0033 * T + 0.0452},
                       {-0.0167 * T - 0.2608, -0.0950 * T + 0.0092, -0.0079 * T + 0.2102,
                        -0.0441 * T - 1.6537, -0.0109 * T + 0.0529}}};
    const std::array<double, 3> zenith = zenith_values(T, theta);
    for (std::size_t i = 0; i < 3; ++i) {
        Distribution& d = distributions_[i];
        const double cos_theta = std::cos(theta);
        d.zenith_over_F =
            zenith[i] / ((1.0 + d.A * std::exp(d.B)) *
                         (1.0 + d.C * std::exp(d.D * theta) + d.E * cos_theta * cos_theta));
    }

    sun_ = scale_ * sun_radiance(T, theta);

    const double sun_sine = std::sin(glm::radians(SunRadiusDegrees));
    const glm::dvec3 from_sun = sun_ * (Pi * sun_sine * sun_sine * sun_direction_.y);
    ground_ = options.ground_albedo / Pi * (sky_irradiance() + from_sun);
}

glm::dvec3 Daylight::sky_irradiance() const {
    // The midpoint rule in azimuth and in the squared sine of the angle from the zenith.
    constexpr int NumRings = 128;
    constexpr int NumSectors = 256;
    glm::dvec3 sum(0.0);
    for (int ring = 0; ring < NumRings; ++ring) {
        const double sin_squared = (ring + 0.5) / NumRings;
        for (int sector = 0; sector < NumSectors; ++sector) {
            const double azimuth = 2.0 * Pi * (sector + 0.5) / NumSectors;
            const double sine = std::sqrt(sin_squared);
            sum += sky(
                {sine * std::sin(azimuth), std::sqrt(1.0 - sin_squared), sine * std::cos(azimuth)});
        }
    }
    return sum * (Pi / (NumRings * NumSectors));
}

glm::dvec3 Daylight::sky(const glm::dvec3& direction) const {
    const glm::dvec3 w = glm::normalize(direction);
    const double cos_theta = std::max(w.y, 1e-4);
    const double cos_gamma = std::clamp(glm::dot(w, sun_direction_), -1.0, 1.0);
    const double gamma = std::acos(cos_gamma);
    std::array<double, 3> values = {};
    for (std::size_t i = 0; i < 3; ++i) {
        const Distribution& d = distributions_[i];
        values[i] = d.zenith_over_F * (1.0 + d.A * std::exp(d.B / cos_theta)) *
                    (1.0 + d.C * std::exp(d.D * gamma) + d.E * cos_gamma * cos_gamma);
    }
    const auto [Y, x, y] = values;
    return scale_ * rgb_from_xyz(Y * glm::dvec3(x / y, 1.0, (1.0 - x - y) / y));
}

} // namespace relumine::data_gen
