// Clear daylight: the radiance of sky and sun.
// Based on: Preetham, Shirley, Smits, "A practical analytic model for daylight", 1999 [P99].
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace relumine::data_gen {

/// The sun's place, the air and the ground.
struct DaylightOptions {
    /// Haze in [1.7, 10], where the model holds: 2 very clear, 3 clear, 6 light haze.
    double turbidity = 3.0;
    /// Angle above the horizon, in [0, 90].
    double sun_elevation_degrees = 35.0;
    /// Angle from +Z towards +X. -60 is the front left of a camera that looks to -Z.
    double sun_azimuth_degrees = -60.0;
    /// Linear RGB reflectance of the ground below the horizon, in [0, 1].
    glm::dvec3 ground_albedo{0.2};
    /// Radiance per kcd/m^2.
    double scale = 1.0;
};

/// Returns the direction from the scene towards a light. Elevation is the angle above the horizon;
/// azimuth runs from +Z towards +X.
[[nodiscard]] glm::dvec3 direction_from_angles(double elevation_degrees, double azimuth_degrees);

/// The model for one position of the sun.
///
/// Unit:    linear RGB with Rec. 709 primaries and white. The Rec. 709 luminance (0.2126 R + 0.7152
///          G + 0.0722 B) is `scale` times the luminance in kcd/m^2, so irradiance is in `scale`
///          times klx. Colours outside Rec. 709 are clamped at 0.
class Daylight {
public:
    /// Angular radius of the sun's disc, whose diameter is 0.533 degrees.
    static constexpr double SunRadiusDegrees = 0.2665;

    /// Throws:  std::invalid_argument for an option outside its range.
    explicit Daylight(const DaylightOptions& options = {});

    /// Returns the sky's radiance without the sun's disc. Directions below the horizon get the
    /// horizon's radiance.
    ///
    /// Y = Y_z F(theta, gamma) / F(0, theta_s), with Perez's F = (1 + A e^(B / cos theta)) (1 + C
    /// e^(D gamma) + E cos^2 gamma). Chromaticities x and y follow likewise [P99, Eq. 3 and 4,
    /// appendix A.2].
    [[nodiscard]] glm::dvec3 sky(const glm::dvec3& direction) const;

    /// Returns the ground's radiance: Lambertian, albedo / pi times the irradiance of sky and sun
    /// on a level surface.
    [[nodiscard]] glm::dvec3 ground() const { return ground_; }

    /// Returns the radiance of the sun's uniform disc: the solar spectrum times the transmittances
    /// of Rayleigh scattering, aerosol, ozone and water vapour [P99, appendix A.1], weighted with
    /// the CIE 1931 observer in steps of 20 nm. The irradiance of a surface that faces the sun is
    /// radiance times pi sin(SunRadiusDegrees)^2.
    [[nodiscard]] glm::dvec3 sun() const { return sun_; }
    [[nodiscard]] glm::dvec3 sun_direction() const { return sun_direction_; }

private:
    /// Returns the sky's irradiance of level ground.
    [[nodiscard]] glm::dvec3 sky_irradiance() const;

    /// Perez's five coefficients for one of Y, x, y, and its zenith value over F(0, theta_s).
    struct Distribution {
        double A = 0.0, B = 0.0, C = 0.0, D = 0.0, E = 0.0;
        double zenith_over_F = 1.0;
    };
    /// Luminance Y, chromaticities x and y.
    std::array<Distribution, 3> distributions_;
    double scale_ = 1.0;
    glm::dvec3 sun_direction_{0.0, 1.0, 0.0};
    glm::dvec3 sun_{0.0};
    glm::dvec3 ground_{0.0};
};

} // namespace relumine::data_gen
