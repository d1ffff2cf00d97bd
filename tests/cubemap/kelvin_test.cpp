#include "cubemap/kelvin.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "cubemap/luminance.h"

namespace relumine::cubemap {
namespace {

/// CIE 1931 x and y of linear sRGB.
glm::dvec2 chromaticity(const glm::dvec3& rgb) {
    const glm::dmat3 xyz_from_rgb(0.4124, 0.2126, 0.0193, 0.3576, 0.7152, 0.1192, 0.1805, 0.0722,
                                  0.9505);
    const glm::dvec3 xyz = xyz_from_rgb * rgb;
    return glm::dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
}

TEST(Kelvin, IsThePlanckianLocusWithLuminanceOne) {
    struct Known {
        double kelvin, x, y;
    };
    // Illuminant A, and points of the locus as Wyszecki and Stiles tabulate them.
    for (const Known& known : {Known{2856.0, 0.4476, 0.4074},
                               {4000.0, 0.3805, 0.3768},
                               {5000.0, 0.3451, 0.3516},
                               {6500.0, 0.3135, 0.3237},
                               {10000.0, 0.2807, 0.2884}}) {
        const glm::dvec2 at = chromaticity(kelvin_color(known.kelvin));
        EXPECT_NEAR(at.x, known.x, 4e-4) << known.kelvin;
        EXPECT_NEAR(at.y, known.y, 4e-4) << known.kelvin;
    }
    double blue_part = -1.0;
    for (double kelvin = LowestKelvin; kelvin <= HighestKelvin; kelvin += 500.0) {
        const glm::dvec3 color = kelvin_color(kelvin);
        EXPECT_NEAR(luminance(color), 1.0, 1e-6) << kelvin;
        EXPECT_GE(color.b / color.r, blue_part) << kelvin;
        blue_part = color.b / color.r;
    }
    EXPECT_EQ(kelvin_color(LowestKelvin).b, 0.0f) << "outside of sRGB";
}

} // namespace
} // namespace relumine::cubemap
