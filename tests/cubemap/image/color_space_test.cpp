#include "cubemap/image/color_space.h"

#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace relumine::cubemap {
namespace {

constexpr Primaries Rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
constexpr Primaries AcesCg{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

TEST(ColorSpace, AcesCgIsAsItsDocumentHasIt) {
    // ACES' own matrix from AP1 to Rec. 709, Bradford.
    const glm::dmat3 expected = glm::transpose(glm::dmat3(
        1.70505, -0.62179, -0.08326, -0.13026, 1.14080, -0.01055, -0.02400, -0.12897, 1.15297));
    const glm::dmat3 found = to_rec709(AcesCg);
    for (int i = 0; i < 3; ++i)
        EXPECT_LT(glm::distance(found[i], expected[i]), 2e-4) << i;
}

TEST(ColorSpace, WhiteStaysWhite) {
    for (const Primaries& each :
         {Rec709, AcesCg, Primaries{{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, {0.3333, 0.3333}}})
        EXPECT_LT(glm::distance(to_rec709(each) * glm::dvec3(1.0), glm::dvec3(1.0)), 1e-12);
    EXPECT_LT(glm::distance(rec709_from_xyz() * glm::dvec3(0.95046, 1.0, 1.08906), glm::dvec3(1.0)),
              1e-3);
}

TEST(ColorSpace, IsNamed) {
    EXPECT_FALSE(space_of(Rec709));
    EXPECT_EQ(space_of(AcesCg)->name, "ACEScg");
    EXPECT_EQ(space_of({{0.6, 0.3}, {0.2, 0.7}, {0.1, 0.1}, {0.3, 0.3}})->name, "");
    for (const char* id : {"", "lin", "data", "unknown", "lin_rec709_scene", "pq_rec2020_display",
                           "lin_xyz_scene", "_", "__"})
        EXPECT_FALSE(space_of_id(id)) << id;
    EXPECT_EQ(space_of_id("lin_ap1_scene")->primaries.red, AcesCg.red);
    EXPECT_EQ(space_of_id("g22_adobergb_scene")->transfer, Transfer::Gamma22);
}

TEST(ColorSpace, PrimariesOnALineAreRefused) {
    EXPECT_THROW(static_cast<void>(to_rec709({{0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3}, {0.3, 0.3}})),
                 std::invalid_argument);
    EXPECT_THROW(static_cast<void>(to_rec709({{0.6, 0.3}, {0.3, 0.6}, {0.1, 0.1}, {0.3, 0.0}})),
                 std::invalid_argument);
}

TEST(ColorSpace, ConversionKeepsBadPixelsAndCutsOthers) {
    Picture picture{.width = 3, .height = 1, .pixels = {{0, 1, 0}, {-1, 0, 0}, {1, 1, 1}}};
    const std::string remark =
        convert(ColorConversion({.primaries = AcesCg, .name = "ACEScg"}), picture);
    EXPECT_EQ(picture.pixels[0].r, 0.0f);
    EXPECT_LT(picture.pixels[1].r, -1.0f) << "what was negative stays for those who judge it";
    EXPECT_LT(glm::distance(picture.pixels[2], glm::vec3(1.0f)), 1e-5f);
    EXPECT_EQ(remark, "ACEScg converted to Rec. 709, which cannot show the colour of 1 pixel");
}

} // namespace
} // namespace relumine::cubemap
