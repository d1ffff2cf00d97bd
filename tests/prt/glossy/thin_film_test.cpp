// Thin films against the sum of all waves at all wavelengths: Airy's formula with Fresnel's exact
// equations, seen through the CIE's curves of 1931.
#include "prt/glossy/thin_film.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>

#include "prt/glossy/brdf.h"

namespace relumine::prt {
namespace {

double index_of(double f0) {
    return (1.0 + std::sqrt(f0)) / (1.0 - std::sqrt(f0));
}

/// What a film of an index and a thickness in nanometres mirrors of a wavelength.
double airy(double film, double thickness, double base, double cosine, double wavelength) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const double inside = std::sqrt(1.0 - sine * sine / (film * film));
    const double below = std::sqrt(1.0 - sine * sine / (base * base));
    const auto turn =
        std::polar(1.0, 4.0 * std::numbers::pi * film * thickness * inside / wavelength);
    const auto power = [&](double outer, double inner) {
        return std::norm((outer + inner * turn) / (1.0 + outer * inner * turn));
    };
    return 0.5 * (power((cosine - film * inside) / (cosine + film * inside),
                        (film * inside - base * below) / (film * inside + base * below)) +
                  power((film * cosine - inside) / (film * cosine + inside),
                        (base * inside - film * below) / (base * inside + film * below)));
}

/// Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching
/// Functions", JCGT 2013.
glm::dvec3 seen(double wavelength) {
    const auto bell = [&](double height, double middle, double left, double right) {
        const double t = (wavelength - middle) / (wavelength < middle ? left : right);
        return height * std::exp(-0.5 * t * t);
    };
    return {bell(1.056, 599.8, 37.9, 31.0) + bell(0.362, 442.0, 16.0, 26.7) -
                bell(0.065, 501.1, 20.4, 26.2),
            bell(0.821, 568.8, 46.9, 40.5) + bell(0.286, 530.9, 16.3, 31.1),
            bell(1.217, 437.0, 11.8, 36.0) + bell(0.681, 459.0, 26.0, 13.8)};
}

/// The sum of all waves, in linear sRGB; what mirrors all wavelengths is white.
glm::dvec3 integrated(double film, double thickness, double f0, double cosine) {
    const glm::dmat3 rgb_from_xyz(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108,
                                  -0.2040259, -0.4985314, 0.0415560, 1.0572252);
    glm::dvec3 sum(0.0), white(0.0);
    for (double wavelength = 380.0; wavelength <= 780.0; wavelength += 2.0) {
        const glm::dvec3 weight = seen(wavelength);
        sum += airy(film, thickness, index_of(f0), cosine, wavelength) * weight;
        white += weight;
    }
    return glm::clamp((rgb_from_xyz * sum) / (rgb_from_xyz * white), 0.0, 1.0);
}

TEST(ThinFilm, IsTheSumOfAllWaves) {
    struct Range {
        double least_cosine, largest_f0, error;
    };
    for (const Range range : {Range{0.8, 0.08, 0.015}, {0.5, 0.08, 0.04}, {0.8, 0.9, 0.035}})
        for (double f0 = 0.02; f0 <= range.largest_f0; f0 *= 2.0)
            for (const double ior : {1.2, 1.33, 1.5, 1.8})
                for (double thickness = 20.0; thickness <= 1000.0; thickness += 40.0)
                    for (double cosine = 1.0; cosine > range.least_cosine - 0.01; cosine -= 0.1) {
                        const glm::dvec3 expected = integrated(ior, thickness, f0, cosine);
                        const glm::vec3 film =
                            ThinFilm(static_cast<float>(ior), static_cast<float>(thickness),
                                     glm::vec3(static_cast<float>(f0)))
                                .mirrored(static_cast<float>(cosine));
                        for (int color = 0; color < 3; ++color)
                            ASSERT_NEAR(double{film[color]}, expected[color], range.error)
                                << "F0 " << f0 << " film " << ior << " " << thickness
                                << " nm, cosine " << cosine << " colour " << color;
                    }
}

/// Straight on a film of air is none. One of many wavelengths has no colours.
TEST(ThinFilm, OfAirIsNoneAndOfMillimetresIsGrey) {
    const glm::vec3 f0(0.04f, 0.5f, 0.9f);
    const glm::vec3 air = ThinFilm(1.0f, 300.0f, f0).mirrored(1.0f);
    for (int color = 0; color < 3; ++color)
        EXPECT_NEAR(air[color], f0[color], 1e-5f);
    for (const float cosine : {1.0f, 0.7f, 0.3f, 0.05f}) {
        const glm::vec3 thick = ThinFilm(1.4f, 1e6f, glm::vec3(0.3f)).mirrored(cosine);
        EXPECT_EQ(thick.r, thick.g);
        EXPECT_EQ(thick.g, thick.b);
    }
}

TEST(ThinFilm, NeverMirrorsMoreThanArrives) {
    for (const float f0 : {0.0f, 0.04f, 0.5f, 0.999f, 1.0f})
        for (const float ior : {1.0f, 1.1f, 1.5f, 2.5f, 1e6f})
            for (float thickness = 1.0f; thickness < 1e5f; thickness *= 1.3f)
                for (float cosine = 0.0f; cosine <= 1.0f; cosine += 0.125f) {
                    const glm::vec3 film = ThinFilm(ior, thickness, glm::vec3(f0)).mirrored(cosine);
                    for (int color = 0; color < 3; ++color) {
                        EXPECT_GE(film[color], 0.0f);
                        EXPECT_LE(film[color], 1.0f);
                    }
                }
}

} // namespace
} // namespace relumine::prt
