// Clear daylight: the sky's and the sun's radiance.
// Based on: Preetham, Shirley, Smits, "A practical analytic model for daylight", 1999 [P99].
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace relumine::data_gen {

struct DaylightOptions {
    /// Haze: 2 very clear, 3 clear, 6 light haze; [1.7, 10], where the model holds
    double turbidity = 3.0;
    /// Above the horizon, [0, 90]
    double sun_elevation_degrees = 35.0;
    /// From +Z towards +X, so -60 is the front left of a camera that looks to -Z
    double sun_azimuth_degrees = -60.0;
    /// Linear RGB reflectance of what lies below the horizon, [0, 1]
    glm::dvec3 ground_albedo{0.2};
    /// Radiance per kcd/m^2
    double scale = 1.0;
};

/// Direction from the scene towards a light at these angles; elevation above the horizon, azimuth
/// from +Z towards +X.
[[nodiscard]] glm::dvec3 direction_from_angles(double elevation_degrees, double azimuth_degrees);

/// The model for one place of the sun. Radiance is linear RGB with Rec. 709 primaries and white,
/// scaled so that its Rec. 709 luminance (0.2126 R + 0.7152 G + 0.0722 B) is `scale` times the
/// luminance in kcd/m^2; irradiance then comes out in `scale` times klx. Colours outside Rec. 709
/// are clamped at 0.
class Daylight {
public:
    /// Angular radius of the sun's disc; its diameter is 0.533 degrees.
    static constexpr double SunRadiusDegrees = 0.2665;

    /// Throws std::invalid_argument for an option out of its range.
    explicit Daylight(const DaylightOptions& options = {});

    /// The sky without the sun's disc, for a direction at or above the horizon (below it: the
    /// horizon's). Y = Y_z F(theta, gamma) / F(0, theta_s), with Perez's F = (1 + A e^(B / cos
    /// theta)) (1 + C e^(D gamma) + E cos^2 gamma); chromaticities x and y likewise [P99, Eq. 3 and
    /// 4, appendix A.2].
    [[nodiscard]] glm::dvec3 sky(const glm::dvec3& direction) const;

    /// The ground: white-furnace Lambertian, albedo / pi times the irradiance of sky and sun on a
    /// level surface.
    [[nodiscard]] glm::dvec3 ground() const { return ground_; }

    /// The sun's disc, uniform: the solar spectrum times the transmittances of Rayleigh scattering,
    /// aerosol, ozone and water vapour [P99, appendix A.1], weighted with the CIE 1931 observer in
    /// steps of 20 nm. Irradiance of a surface facing the sun is radiance times pi
    /// sin(SunRadiusDegrees)^2.
    [[nodiscard]] glm::dvec3 sun() const { return sun_; }
    [[nodiscard]] glm::dvec3 sun_direction() const { return sun_direction_; }

private:
    /// Of level ground
    [[nodiscard]] glm::dvec3 sky_irradiance() const;

    /// Perez's five coefficients of one of Y, x, y, and its zenith value over F(0, theta_s).
    struct Distribution {
        double A = 0.0, B = 0.0, C = 0.0, D = 0.0, E = 0.0;
        double zenith_over_F = 1.0;
    };
    /// Luminance Y, chromaticities x and y
    std::array<Distribution, 3> distributions_;
    double scale_ = 1.0;
    glm::dvec3 sun_direction_{0.0, 1.0, 0.0};
    glm::dvec3 sun_{0.0};
    glm::dvec3 ground_{0.0};
};

} // namespace relumine::data_gen
