// Highlights for an eye that moves, against the plain sum over clusters and exact integration.
#include "relight/moving_eye/moving_eye.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/glossy/ggx_energy.h"
#include "prt/glossy/glossy_precompute.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/moving_eye/visibility_pyramid.h"
#include "relight/reference/exact.h"
#include "relight/reference/flicker.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/relight/environments.h"
#include "tests/relight/relit_scene.h"

namespace relumine::relight {
namespace {

prt::Surface shiny(float roughness) {
    return {.albedo = glm::vec3(0.3f),
            .specular = {0.5f, 0.4f, 0.3f},
            .highlight = prt::Highlight::GgxWhole,
            .roughness_or_exponent = roughness};
}

const glm::vec3 Eye(1.5f, 2.5f, 3.0f);

/// The scene's receivers with one surface everywhere, for one eye.
prt::Receivers seen_from(const glm::vec3& eye, const prt::Surface& surface) {
    prt::Receivers receivers = scenes::relit_scene().receivers;
    receivers.surfaces.assign(receivers.size(), surface);
    prt::look_from(receivers, eye);
    return receivers;
}

/// Its light, and an eye that moves.
struct Lit {
    Lit(const prt::Surface& surface, cubemap::CubeMap environment,
        const ShadowRays& rays = scenes::relit_scene().shadow_rays())
        : relighter(scenes::relit_scene().transfer, rays),
          eye(scenes::relit_scene().transfer, scenes::relit_scene().receivers.positions,
              std::vector(scenes::relit_scene().receivers.size(), surface),
              scenes::relit_scene().mesh.triangles) {
        relighter.set_environment(std::move(environment));
        eye.set_light(relighter);
    }
    std::span<const glm::vec3> look(const EyeOptions& options = {}) {
        return eye.look(Eye, relighter.radiance(), options);
    }
    Relighter relighter;
    MovingEye eye;
};

/// The plain sum over all clusters: light times visible part times lobe, `parts` lights along each
/// edge of a cluster.
std::vector<glm::vec3> plain_sum(const prt::Receivers& receivers, const Relighter& relighter,
                                 std::uint32_t depth) {
    const prt::Transfer& transfer = relighter.transfer();
    struct Light {
        std::uint32_t cluster;
        glm::vec3 direction, power;
    };
    std::vector<Light> lights;
    const auto add = [&](const auto& self, std::uint32_t cluster, const prt::Cell& cell,
                         std::uint32_t levels) -> void {
        for (std::uint32_t i = 0; levels > 0 && i < 4; ++i)
            self(self, cluster, cell.child(i), levels - 1);
        if (levels > 0)
            return;
        const VectorIrradiance sum = relighter.binning()->sum(relighter.environment(), cell);
        const glm::dvec3 power(glm::length(sum.red), glm::length(sum.green), glm::length(sum.blue));
        if (power != glm::dvec3(0.0))
            lights.push_back({cluster, glm::normalize(sum.luminance()), power});
    };
    for (std::uint32_t i = 0; i < transfer.num_clusters(); ++i)
        add(add, i, transfer.quadtree.leaves()[i], depth);
    std::vector<glm::vec3> result(receivers.size());
    files::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t place) {
        const std::uint32_t receiver = transfer.order[place];
        const glm::vec3 &normal = receivers.normals[receiver], &to_eye = receivers.to_eye[receiver];
        prt::Lobes<glm::vec3> sums;
        for (const Light& light : lights) {
            const auto lobes =
                prt::evaluate_lobes(receivers.surfaces[receiver], normal, to_eye, light.direction);
            const auto part =
                static_cast<float>(transfer.counts.count(place, light.cluster)) / 16.0f;
            prt::add_scaled(sums, prt::converted<glm::vec3>(lobes), part * light.power);
        }
        result[receiver] = prt::reflect(receivers.surfaces[receiver], sums,
                                        {receivers.surfaces[receiver], normal, to_eye});
    });
    return result;
}

/// Of receivers that face the eye.
double relative_l2(const prt::Receivers& receivers, std::span<const glm::vec3> actual,
                   std::span<const glm::vec3> expected) {
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        if (glm::dot(receivers.normals[i], receivers.to_eye[i]) <= 0.0f)
            continue;
        const glm::dvec3 error = actual[i] - expected[i];
        difference += glm::dot(error, error);
        all += glm::dot(glm::dvec3(expected[i]), glm::dvec3(expected[i]));
    }
    return std::sqrt(difference / all);
}

std::vector<glm::vec3> exact(const prt::Receivers& receivers, const cubemap::CubeMap& environment) {
    std::vector<std::uint32_t> all(receivers.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    const auto radiance = exact_radiance(receivers, all, scenes::relit_scene().rays, environment,
                                         {.bias = scenes::relit_scene().options.bias});
    return {radiance.begin(), radiance.end()};
}

TEST(MovingEye, ThePlainSumIsExactIntegration) {
    const prt::Receivers receivers = seen_from(Eye, shiny(0.4f));
    const cubemap::CubeMap sky = scenes::smooth_environment(32);
    Relighter relighter(scenes::relit_scene().transfer);
    relighter.set_environment(sky);
    EXPECT_LT(relative_l2(receivers, plain_sum(receivers, relighter, 1), exact(receivers, sky)),
              0.02);
}

TEST(MovingEye, CutsAreThePlainSum) {
    const prt::Receivers receivers = seen_from(Eye, shiny(0.4f));
    Lit lit(shiny(0.4f), scenes::random_environment(32, 3), {});
    const std::vector<glm::vec3> sum = plain_sum(receivers, lit.relighter, 2);
    const double fine = relative_l2(receivers, lit.look({.tolerance = 1e-3f}), sum);
    const std::size_t many = lit.eye.report().num_cells;
    EXPECT_LT(fine, 0.02);
    EXPECT_LT(relative_l2(receivers, lit.look({.tolerance = 0.05f}), sum), 0.05);
    EXPECT_LT(lit.eye.report().num_cells, many / 3);
}

TEST(MovingEye, LooksAreExactIntegration) {
    for (const float roughness : {0.2f, 0.3f, 0.7f}) {
        const prt::Receivers receivers = seen_from(Eye, shiny(roughness));
        const cubemap::CubeMap sky = scenes::smooth_environment(64);
        Lit lit(shiny(roughness), sky);
        EXPECT_LT(relative_l2(receivers, lit.look(), exact(receivers, sky)),
                  roughness < 0.3f ? 0.08 : 0.03)
            << roughness;
    }
}

TEST(MovingEye, TracedLightsHaveTheirHighlightInClosedForm) {
    cubemap::CubeMap sky(64);
    sky.at(cubemap::Face::PositiveY, 40, 24) = glm::vec3(5e3f);
    const prt::Receivers receivers = seen_from(Eye, shiny(0.3f));
    Lit lit(shiny(0.3f), sky);
    ASSERT_FALSE(lit.relighter.sharp_lights().empty());
    EXPECT_LT(relative_l2(receivers, lit.look(), exact(receivers, sky)), 0.01);
}

TEST(MovingEye, AgreesWithHighlightsThatAreStoredForItsEye) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    const prt::Receivers receivers = seen_from(Eye, shiny(0.3f));
    prt::Transfer stored = scene.transfer;
    stored.glossy = prt::precompute_glossy(
        receivers, scene.rays, stored,
        {.tolerance = 0.03f, .face_resolution = 64, .bias = scene.options.bias});
    prt::set_surfaces(stored, receivers);
    for (const cubemap::CubeMap& sky :
         {scenes::smooth_environment(64), scenes::random_environment(64, 5)}) {
        Lit lit(shiny(0.3f), sky);
        Relighter fixed(stored, scene.shadow_rays());
        fixed.set_environment(sky);
        EXPECT_LT(relative_l2(receivers, lit.look(), fixed.radiance()), 0.02);
    }
}

// A turn of three degrees a frame, as of a turntable of 120 frames. The change from frame to frame
// is measured as the inconsistency with a picture that stands still.
TEST(MovingEye, ATurntableFlickersNoMoreThanExactIntegration) {
    const cubemap::CubeMap sky = scenes::smooth_environment(32);
    Lit lit(shiny(0.3f), sky);
    FlickerMeter of_looks, of_exact, between;
    std::vector<glm::vec3> still;
    for (int frame = 0; frame < 6; ++frame) {
        const double angle = frame * std::numbers::pi / 60.0;
        const glm::vec3 eye(3.0 * std::cos(angle), 2.5, 3.0 * std::sin(angle));
        prt::Receivers receivers = seen_from(eye, shiny(0.3f));
        const auto look = lit.eye.look(eye, lit.relighter.radiance());
        std::vector<glm::vec3> reference = exact(receivers, sky);
        // Those that come into view or leave it change at once.
        for (std::size_t i = 0; i < receivers.size(); ++i)
            if (glm::dot(receivers.normals[i], receivers.to_eye[i]) <= 0.0f)
                reference[i] = look[i];
        if (still.empty())
            still.assign(reference.size(), glm::vec3(0.0f));
        of_looks.add_frame(look, still);
        of_exact.add_frame(reference, still);
        between.add_frame(look, reference);
    }
    const double exact_change = of_exact.report().mean_inconsistency;
    EXPECT_GT(exact_change, 0.0);
    EXPECT_LT(of_looks.report().mean_inconsistency, 1.2 * exact_change);
    EXPECT_LT(between.report().mean_inconsistency, exact_change);
}

TEST(MovingEye, AWhiteMetalIsWhiteUnderAWhiteSky) {
    const mesh::TriangleMesh sphere = scenes::icosphere(3, 1.0f, glm::vec3(0.0f));
    // The facets of the sphere would be in the way of what it mirrors near its horizons.
    const scenes::AnalyticBlockers open = scenes::no_blockers();
    const prt::Receivers receivers = prt::vertex_receivers(sphere);
    const prt::Transfer transfer = prt::precompute(
        receivers, open, {.tolerance = 0.0135f, .face_resolution = 64, .bias = 1e-4f});
    Relighter relighter(transfer);
    relighter.set_environment(cubemap::CubeMap(16, glm::vec3(1.0f)));
    for (const float roughness : {0.15f, 0.3f, 0.6f, 1.0f}) {
        const prt::Surface metal{.albedo = glm::vec3(0.0f),
                                 .specular = glm::vec3(1.0f),
                                 .highlight = prt::Highlight::GgxWhole,
                                 .roughness_or_exponent = roughness,
                                 .metallic = 1.0f};
        MovingEye eye(transfer, receivers.positions, std::vector(receivers.size(), metal));
        eye.set_light(relighter);
        // A block of so coarse a sphere has lobes 20 degrees apart.
        const auto radiance =
            eye.look({0.0f, 0.0f, 4.0f}, relighter.radiance(), {.tolerance = 2e-4f});
        for (std::size_t i = 0; i < receivers.size(); ++i)
            if (const glm::vec3 ray = glm::vec3(0.0f, 0.0f, 4.0f) - receivers.positions[i];
                glm::dot(receivers.normals[i], glm::normalize(ray)) > 0.3f) {
                EXPECT_NEAR(radiance[i].g, 1.0f, 0.03f) << roughness << " " << i;
            }
    }
}

TEST(MovingEye, ThreadsAndOtherLooksChangeNoBit) {
    Lit lit(shiny(0.3f), scenes::random_environment(32, 7));
    const std::span<const glm::vec3> first = lit.look();
    const std::vector<glm::vec3> expected(first.begin(), first.end());
    static_cast<void>(lit.eye.look({-3.0f, 1.0f, 0.0f}, lit.relighter.radiance()));
    const files::ThreadLimit one(1);
    const std::span<const glm::vec3> again = lit.look();
    EXPECT_TRUE(std::equal(again.begin(), again.end(), expected.begin()));
}

TEST(MovingEye, MattSurfacesAndThoseThatLookAwayStay) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    std::vector<prt::Surface> surfaces(scene.receivers.size(), shiny(0.3f));
    for (std::size_t i = 0; i < surfaces.size(); i += 2)
        surfaces[i] = {};
    Relighter relighter(scene.transfer);
    relighter.set_environment(scenes::smooth_environment(16));
    MovingEye eye(scene.transfer, scene.receivers.positions, surfaces);
    eye.set_light(relighter);
    const auto radiance = eye.look(Eye, relighter.radiance());
    std::size_t num_changed = 0;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const bool faces =
            glm::dot(scene.receivers.normals[i], Eye - scene.receivers.positions[i]) > 0.0f;
        if (i % 2 == 0 || !faces) {
            EXPECT_EQ(radiance[i], relighter.radiance()[i]);
        } else {
            num_changed += radiance[i] != relighter.radiance()[i] ? 1 : 0;
        }
    }
    EXPECT_GT(num_changed, surfaces.size() / 10);
}

TEST(MovingEye, ABudgetMovesTheTolerance) {
    Lit lit(shiny(0.3f), scenes::random_environment(32, 7));
    static_cast<void>(lit.look({.budget_ms = 1e-3}));
    static_cast<void>(lit.look({.budget_ms = 1e-3}));
    EXPECT_FLOAT_EQ(lit.eye.report().tolerance, 2.0f * EyeOptions{}.tolerance);
    static_cast<void>(lit.look({.budget_ms = 1e6}));
    EXPECT_FLOAT_EQ(lit.eye.report().tolerance, EyeOptions{}.tolerance);
}

TEST(MovingEye, RefusesWhatItCannotLight) {
    const scenes::RelitScene& scene = scenes::relit_scene();
    EXPECT_THROW(MovingEye(scene.transfer, scene.receivers.positions, {}), std::invalid_argument);
    EXPECT_THROW(MovingEye(scene.transfer, scene.receivers.positions,
                           std::vector<prt::Surface>(scene.receivers.size())),
                 std::invalid_argument);
    MovingEye eye(scene.transfer, scene.receivers.positions,
                  std::vector(scene.receivers.size(), shiny(0.3f)));
    EXPECT_THROW(static_cast<void>(eye.look(Eye, {})), std::logic_error);
}

/// Two fine spheres, one of which hides a part of the other from most eyes.
struct TwoSpheres {
    mesh::TriangleMesh mesh = scenes::joined(scenes::icosphere(5, 1.0f, glm::vec3(0.0f)),
                                             scenes::icosphere(4, 0.8f, {2.2f, 0.3f, 0.0f}));
    prt::Receivers receivers = prt::vertex_receivers(mesh);
    prt::RayScene rays{mesh};
    float bias = prt::automatic_bias(mesh);
    prt::Transfer transfer =
        prt::precompute(receivers, rays, {.tolerance = 0.03f, .face_resolution = 64, .bias = bias});
    Relighter relighter{transfer};
    MovingEye eye{transfer, receivers.positions, std::vector(receivers.size(), shiny(0.3f)),
                  mesh.triangles};

    TwoSpheres() {
        relighter.set_environment(scenes::random_environment(32, 7));
        eye.set_light(relighter);
    }
    std::vector<glm::vec3> look(const glm::vec3& from, const EyeOptions& options = {},
                                std::span<const glm::vec4> sides = {}) {
        const auto radiance = eye.look(from, relighter.radiance(), options, sides);
        return {radiance.begin(), radiance.end()};
    }
    /// Whether a triangle of a receiver has a corner that an eye sees, by rays.
    [[nodiscard]] std::vector<bool> shown_by_rays(const glm::vec3& from) const {
        const auto sees = [&](std::uint32_t i) {
            const glm::vec3 ray = from - receivers.positions[i];
            return glm::dot(ray, receivers.normals[i]) > 0.0f &&
                   !rays.occluded(receivers.positions[i] + bias * receivers.normals[i], ray, 1.0f);
        };
        std::vector<bool> shown(receivers.size());
        for (const mesh::Triangle& triangle : mesh.triangles)
            if (std::any_of(triangle.begin(), triangle.end(), sees))
                for (const std::uint32_t corner : triangle)
                    shown[corner] = true;
        return shown;
    }
};

TEST(MovingEye, APictureHasAllThatItShows) {
    TwoSpheres scene;
    for (const glm::vec3& from : {glm::vec3(-4.0f, 0.6f, 1.0f), glm::vec3(6.0f, 1.0f, 0.1f),
                                  glm::vec3(5.0f, 0.4f, -3.0f)}) {
        const std::vector<glm::vec3> all = scene.look(from);
        const std::size_t num_blocks = scene.eye.report().num_blocks;
        const std::vector<glm::vec3> seen = scene.look(from, {.seen_only = true});
        EXPECT_LT(scene.eye.report().num_blocks, num_blocks);
        const std::vector<bool> shown = scene.shown_by_rays(from);
        for (std::size_t i = 0; i < all.size(); ++i)
            if (shown[i]) {
                EXPECT_EQ(seen[i], all[i]) << i;
            } else {
                EXPECT_TRUE(seen[i] == all[i] || seen[i] == scene.relighter.radiance()[i]) << i;
            }
    }
}

TEST(MovingEye, APictureHasAllBetweenItsSides) {
    TwoSpheres scene;
    const glm::vec3 from(0.5f, 1.0f, 5.0f), across(1.0f, 0.0f, 0.0f);
    const std::vector<glm::vec3> all = scene.look(from);
    const std::array sides = {glm::vec4(across, -glm::dot(across, from))};
    static_cast<void>(scene.look(from, {.seen_only = true}));
    const std::size_t num_blocks = scene.eye.report().num_blocks;
    const std::vector<glm::vec3> part = scene.look(from, {.seen_only = true}, sides);
    EXPECT_LT(scene.eye.report().num_blocks, num_blocks);
    const std::vector<bool> shown = scene.shown_by_rays(from);
    std::size_t num_inside = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (shown[i] && glm::dot(across, scene.receivers.positions[i] - from) > 0.0f) {
            ++num_inside;
            EXPECT_EQ(part[i], all[i]) << i;
        }
    EXPECT_GT(num_inside, all.size() / 10);
}

// A light is dragged over the map while the eye stands still; each look is compared with that of an
// eye that comes new.
TEST(MovingEye, AStandingEyeTakesTheChangesOfTheLight) {
    TwoSpheres scene;
    const glm::vec3 from(0.5f, 1.0f, 5.0f);
    MovingEye fresh(scene.transfer, scene.receivers.positions,
                    std::vector(scene.receivers.size(), shiny(0.3f)));
    std::size_t num_updated = 0, num_blocks = 0;
    for (std::uint32_t step = 0; step < 12; ++step) {
        cubemap::CubeMap map = scenes::smooth_environment(32);
        for (std::uint32_t y = 10; y < 14; ++y)
            for (std::uint32_t x = 2 * step; x < 2 * step + 4; ++x)
                map.at(cubemap::Face::PositiveZ, x, y) += glm::vec3(8.0f, 6.0f, 4.0f);
        scene.relighter.set_environment(map);
        scene.eye.set_light(scene.relighter);
        const std::vector<glm::vec3> kept = scene.look(from);
        if (step > 2) {
            num_updated += scene.eye.report().num_updated;
            num_blocks += scene.eye.report().num_blocks;
        }
        fresh.set_light(scene.relighter);
        // Another eye in between, so that nothing is kept.
        static_cast<void>(fresh.look(-from, scene.relighter.radiance()));
        const auto expected = fresh.look(from, scene.relighter.radiance());
        EXPECT_EQ(fresh.report().num_updated, 0u);
        for (std::size_t i = 0; i < kept.size(); ++i)
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(kept[i][channel], expected[i][channel], 1e-5f) << step << " " << i;
    }
    EXPECT_GT(num_updated, num_blocks / 2);
    // The same light again changes nothing, not a bit.
    const std::vector<glm::vec3> before = scene.look(from);
    scene.eye.set_light(scene.relighter);
    EXPECT_EQ(scene.look(from), before);
    EXPECT_EQ(scene.eye.report().num_updated, scene.eye.report().num_blocks);
}

// Blockers may stand behind an eye that is among them, so all that faces it is lit.
TEST(MovingEye, AnEyeWithinTheSceneSeesAllThatFacesIt) {
    Lit lit(shiny(0.3f), scenes::random_environment(32, 7));
    const prt::Receivers& receivers = scenes::relit_scene().receivers;
    glm::vec3 low = receivers.positions[0], high = low;
    for (const glm::vec3& position : receivers.positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    const glm::vec3 eye(0.5f * (low.x + high.x), low.y + 0.3f * (high.y - low.y),
                        0.5f * (low.z + high.z));
    const std::span<const glm::vec3> look = lit.eye.look(eye, lit.relighter.radiance());
    const std::vector<glm::vec3> all(look.begin(), look.end());
    const auto seen = lit.eye.look(eye, lit.relighter.radiance(), {.seen_only = true});
    EXPECT_TRUE(std::equal(all.begin(), all.end(), seen.begin()));
}

/// Compares what a block sees of a cell, and of the cells below it, with the counts. Returns how
/// many cells it sees in part.
class PyramidWalk {
public:
    PyramidWalk(const prt::Transfer& transfer, const VisibilityPyramid& pyramid, std::size_t block)
        : transfer_(transfer), pyramid_(pyramid), block_(block),
          flags_(transfer.quadtree.split_flags()) {}

    std::size_t run() {
        for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
            visit(pyramid_.face(block_, face));
        EXPECT_EQ(next_leaf_, transfer_.num_clusters());
        return num_mixed_;
    }

private:
    using Kind = VisibilityPyramid::Kind;

    void visit(const VisibilityPyramid::Place& place) {
        const std::uint32_t first_leaf = next_leaf_;
        if (flags_[next_flag_++]) {
            const VisibilityPyramid::Sights seen =
                place.kind() == Kind::Hidden ? VisibilityPyramid::Sights() : pyramid_.sights(place);
            EXPECT_EQ(seen.visible & seen.mixed, 0u);
            for (std::uint32_t i = 0; i < 4; ++i)
                visit(((seen.visible | seen.mixed) >> i & 1u) != 0
                          ? pyramid_.child(block_, place, seen, i)
                          : VisibilityPyramid::Place());
        } else {
            ++next_leaf_;
        }
        const VisibilityPyramid::Parts parts = pyramid_.parts(place);
        num_mixed_ += place.kind() != Kind::Hidden && place.kind() != Kind::Visible ? 1 : 0;
        for (std::size_t i = 0; i < prt::BlockSize; ++i) {
            int least = 16, most = 0, sum = 0;
            for (std::uint32_t leaf = first_leaf; leaf < next_leaf_; ++leaf) {
                const int count = transfer_.counts.count(block_ * prt::BlockSize + i, leaf);
                least = std::min(least, count);
                most = std::max(most, count);
                sum += count;
            }
            const float part = 16.0f * static_cast<float>(parts.parts[i]) * parts.unit;
            EXPECT_GE(part, static_cast<float>(least) - 0.04f);
            EXPECT_LE(part, static_cast<float>(most) + 0.04f);
            // What is seen alike has no entry; a quad has the plain mean.
            EXPECT_TRUE(place.kind() != Kind::Hidden || most == 0);
            EXPECT_TRUE(place.kind() != Kind::Visible || least == 16);
            if (place.kind() == Kind::Quad) {
                EXPECT_EQ(next_leaf_ - first_leaf, 4u);
                EXPECT_NEAR(part, static_cast<float>(sum) / 4.0f, 1e-5f);
            }
        }
    }

    const prt::Transfer& transfer_;
    const VisibilityPyramid& pyramid_;
    std::size_t block_;
    std::vector<bool> flags_;
    std::size_t next_flag_ = 0, num_mixed_ = 0;
    std::uint32_t next_leaf_ = 0;
};

TEST(VisibilityPyramid, HasTheMeansOfItsClusters) {
    const prt::Transfer& transfer = scenes::relit_scene().transfer;
    const VisibilityPyramid pyramid(transfer);
    std::size_t num_mixed = 0;
    for (std::size_t block = 0; block < transfer.num_receivers() / prt::BlockSize; block += 7)
        num_mixed += PyramidWalk(transfer, pyramid, block).run();
    EXPECT_GT(num_mixed, 100u);
    EXPECT_LT(pyramid.num_bytes(),
              transfer.counts.counts.size() + 24 * transfer.counts.mixed.size());
}

} // namespace
} // namespace relumine::relight
