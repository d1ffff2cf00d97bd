// Pictures of rooms gather their soft light by rays.
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cubemap/face.h"
#include "data_gen/scenes.h"
#include "relumine/in/precompute.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "relumine/out/receiver_colors.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

/// A sky that is bright above, over grey ground.
cubemap::CubeMap sky() {
    constexpr std::uint32_t R = 16;
    cubemap::CubeMap map(R);
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < R; ++y)
            for (std::uint32_t x = 0; x < R; ++x) {
                const auto up =
                    static_cast<float>(cubemap::direction(face, (x + 0.5) / R, (y + 0.5) / R).y);
                map.at(face, x, y) = up > 0.0f ? glm::vec3(1.0f, 1.5f, 2.0f) * (0.5f + up)
                                               : glm::vec3(0.4f, 0.35f, 0.3f);
            }
    return map;
}

LitScene room(std::size_t num_vertices, float tolerance) {
    Mesh mesh(data_gen::room(num_vertices));
    LitScene lit(precompute(std::move(mesh), {.tolerance = tolerance, .no_refine = true}));
    lit.light(sky());
    lit.bounce({.albedo = bounce_albedo(lit.scene())});
    return lit;
}

/// The distance of two pictures over the second one, L2.
double distance(const Picture& a, const Picture& b) {
    double squares = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const glm::vec3 difference = a.pixels[i] - b.pixels[i];
        squares += glm::dot(difference, difference);
        whole += glm::dot(b.pixels[i], b.pixels[i]);
    }
    return std::sqrt(squares / whole);
}

TEST(RoomPicture, OfACoarseMeshIsNearerToThatOfAFineOne) {
    const OutputOptions options{.width = 120, .height = 90, .samples_per_axis = 1};
    const LitScene fine = room(12'000, 0.02f), coarse = room(1'500, 0.05f);
    Lighting of_vertices = fine.lighting();
    ASSERT_FALSE(of_vertices.sent.empty()) << "it is a room";
    of_vertices.sent = {};
    const Picture converged = Painter(fine, options).draw(of_vertices);
    Lighting light = coarse.lighting();
    const double gathered = distance(Painter(coarse, options).draw(light), converged);
    light.sent = {};
    const double of_coarse = distance(Painter(coarse, options).draw(light), converged);
    EXPECT_LT(gathered, 0.06);
    EXPECT_LT(gathered, 0.8 * of_coarse) << gathered << " " << of_coarse;
}

TEST(RoomPicture, GathersOnlyWhereAllBouncesAreThere) {
    LitScene lit = room(1'500, 0.05f);
    EXPECT_FALSE(lit.lighting().sent.empty());
    EXPECT_TRUE(lit.lighting(false).sent.empty()) << "nothing is drawn";
    lit.bounce({.albedo = bounce_albedo(lit.scene()), .limits = {.num_bounces = 1}});
    EXPECT_TRUE(lit.lighting().sent.empty()) << "the next bounce is not asked for";
    lit.light(cubemap::CubeMap(2));
    EXPECT_TRUE(lit.lighting().sent.empty()) << "no light bounces";
}

} // namespace
} // namespace relumine
