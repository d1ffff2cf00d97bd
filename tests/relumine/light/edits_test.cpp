#include "relumine/light/edits.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/shared_radiance.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/prt/scenes.h"
#include "tests/relight/arrays.h"
#include "tests/relight/environments.h"
#include "tests/relumine/light/relit_lit_scene.h"

namespace relumine {
namespace {

using relight::copy;
using scenes::relative_difference;
using scenes::relit_scene;

Environment environment(cubemap::CubeMap map) {
    return {.map = std::move(map), .file = {}, .assumptions = {}};
}

cubemap::LightLayer named_disc(const std::string& name, const glm::dvec3& direction, double radius,
                               const glm::vec3& radiance) {
    cubemap::LightLayer layer;
    layer.name = name;
    layer.region = cubemap::Disc{.direction = direction, .radius_degrees = radius, .softness = 0.3};
    layer.effect = cubemap::Emit{.radiance = radiance};
    return layer;
}

cubemap::LightLayer random_layer(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    cubemap::LightLayer layer =
        named_disc("layer", scenes::random_direction(random), 1.0 + 30.0 * unit(random),
                   glm::vec3(static_cast<float>(5.0 * unit(random))));
    if (unit(random) < 0.4)
        layer.region = cubemap::Rectangle{.direction = scenes::random_direction(random),
                                          .width_degrees = 5.0 + 30.0 * unit(random),
                                          .height_degrees = 5.0 + 30.0 * unit(random),
                                          .roll_degrees = 90.0 * unit(random)};
    if (unit(random) < 0.3)
        layer.effect = cubemap::Gain{.factor = static_cast<float>(3.0 * unit(random))};
    layer.on = unit(random) < 0.9;
    layer.gain_ev = 4.0 * unit(random) - 2.0;
    layer.solo = unit(random) < 0.1;
    layer.camera = unit(random) < 0.7; // which changes no light
    layer.kelvin = unit(random) < 0.3 ? 1000.0 + 9000.0 * unit(random) : 0.0;
    return layer;
}

/// What the editor must show: base and layers composited whole, lit afresh.
std::vector<glm::vec3> lit_afresh(const LitScene& editor, const cubemap::CubeMap& base) {
    return relight::relight(editor.relighter().transfer(),
                            cubemap::composite(base, editor.environment().state().layers),
                            editor.relighter().shadow_rays());
}

TEST(LightEdits, FollowsRandomEditsOfAllKinds) {
    const cubemap::CubeMap base = scenes::random_environment(32, 5);
    LitScene editor = scenes::relit_clusters();
    editor.light(base);
    std::mt19937 random(7);
    std::vector<cubemap::LightLayer> layers;
    for (int edit = 0; edit < 200; ++edit) {
        const auto choice = random() % 4;
        if (layers.size() < 3 || choice == 0)
            layers.insert(layers.begin() +
                              static_cast<std::ptrdiff_t>(random() % (layers.size() + 1)),
                          random_layer(random));
        else if (choice == 1)
            layers.erase(layers.begin() + static_cast<std::ptrdiff_t>(random() % layers.size()));
        else if (choice == 2)
            std::swap(layers[random() % layers.size()], layers[random() % layers.size()]);
        else
            layers[random() % layers.size()] = random_layer(random);
        set_layers(editor, layers);
        if (edit % 20 == 19) {
            // The composite is the same texel by texel; the sums differ by the order of a few
            // additions in double.
            EXPECT_EQ(environment_of(editor).texels, cubemap::composite(base, layers).texels);
            EXPECT_LT(relative_difference(editor.radiance(), lit_afresh(editor, base)), 1e-6);
        }
    }
}

TEST(LightEdits, RegionsThatComeBackAreFoundInBasesOfAnySize) {
    // The editor keeps the texels of the last regions.
    std::mt19937 random(17);
    std::vector<cubemap::LightLayer> kinds(12);
    for (cubemap::LightLayer& kind : kinds)
        kind = random_layer(random);
    LitScene editor = scenes::relit_clusters();
    editor.light(scenes::random_environment(32, 5));
    set_layers(editor, {kinds[0], kinds[1]});
    for (int edit = 0; edit < 120; ++edit) {
        if (edit % 30 == 29)
            editor.light(scenes::random_environment(edit % 60 == 29 ? 48 : 32, 5));
        cubemap::LightLayer layer = kinds[random() % kinds.size()];
        layer.gain_ev = 0.1 * edit;
        layer.on = edit % 7 != 6;
        set_layer(editor, static_cast<std::size_t>(edit % 2), layer);
        EXPECT_EQ(environment_of(editor).texels,
                  cubemap::composite(*editor.environment().state().base->map(),
                                     editor.environment().state().layers)
                      .texels);
    }
}

TEST(LightEdits, TenThousandEditsLeaveNoDrift) {
    const cubemap::CubeMap base = scenes::random_environment(16, 5);
    LitScene editor = scenes::relit_clusters();
    editor.light(base);
    std::mt19937 random(3);
    set_layers(editor, {random_layer(random), random_layer(random)});
    for (int edit = 0; edit < 10000; ++edit) {
        cubemap::LightLayer layer = random_layer(random);
        layer.gain_ev += edit % 100 == 0 ? 15.0 : 0.0; // now and then a sun
        set_layer(editor, static_cast<std::size_t>(edit % 2), layer);
    }
    set_layers(editor, {});
    EXPECT_LT(relative_difference(editor.radiance(), lit_afresh(editor, base)), 1e-5);
}

TEST(LightEdits, UndoAndRedoReturnBitwise) {
    LitScene editor = scenes::relit_clusters();
    editor.light(scenes::random_environment(32, 1));
    mark(editor);
    EXPECT_FALSE(editor.environment().history().can_undo(editor.environment().state()));
    std::mt19937 random(11);
    std::vector<std::vector<glm::vec3>> states = {copy(editor.radiance())};
    std::vector<std::vector<glm::vec3>> environments = {environment_of(editor).texels};
    std::vector<cubemap::LightLayer> layers;
    for (int i = 0; i < 6; ++i) {
        layers.push_back(random_layer(random));
        set_layers(editor, layers);
        for (int drag = 0; drag < 5; ++drag) { // what lies between two marks is not in the history
            layers.back() = random_layer(random);
            set_layer(editor, layers.size() - 1, layers.back());
        }
        mark(editor);
        states.push_back(copy(editor.radiance()));
        environments.push_back(environment_of(editor).texels);
    }
    for (std::size_t i = states.size() - 1; i-- > 0;) {
        ASSERT_TRUE(editor.environment().history().can_undo(editor.environment().state()));
        undo(editor);
        EXPECT_EQ(copy(editor.radiance()), states[i]) << "undo to " << i;
        EXPECT_EQ(environment_of(editor).texels, environments[i]);
    }
    EXPECT_FALSE(editor.environment().history().can_undo(editor.environment().state()));
    EXPECT_EQ(undo(editor).num_clusters, 0u);
    for (std::size_t i = 1; i < states.size(); ++i) {
        ASSERT_TRUE(editor.environment().history().can_redo());
        redo(editor);
        EXPECT_EQ(copy(editor.radiance()), states[i]) << "redo to " << i;
    }
    EXPECT_FALSE(editor.environment().history().can_redo());

    // An edit without a mark is undone to the last one.
    set_layers(editor, {});
    undo(editor);
    EXPECT_EQ(copy(editor.radiance()), states.back());

    // A new edit after an undo forgets what was undone.
    undo(editor);
    set_layers(editor, {});
    mark(editor);
    EXPECT_FALSE(editor.environment().history().can_redo());
}

TEST(LightEdits, UndoBringsBackRotationAndBaseBitwise) {
    // With shadow rays, so that the sharp lights of one base do not linger in another.
    LitScene editor(scenes::whole_relit_scene());
    cubemap::CubeMap sunny = scenes::random_environment(32, 1);
    sunny.at(cubemap::Face::PositiveY, 20, 17) = glm::vec3(1e5f, 9e4f, 8e4f);
    editor.light(sunny);
    forget_history(editor);
    std::vector<std::vector<glm::vec3>> states = {copy(editor.radiance())};
    std::vector<std::vector<glm::vec3>> environments = {environment_of(editor).texels};
    const auto keep = [&] {
        mark(editor);
        states.push_back(copy(editor.radiance()));
        environments.push_back(environment_of(editor).texels);
    };
    set_layers(editor, {named_disc("lamp", {0.2, 0.5, 1.0}, 12.0, glm::vec3(3.0f))});
    keep();
    for (const double degrees : {5.0, 20.0, 33.0}) // as a slider moves
        set_rotation(editor, degrees);
    keep();
    set_layers(editor, {named_disc("lamp", {1.0, 0.5, 0.0}, 9.0, glm::vec3(2.0f))});
    keep();
    editor.light(scenes::random_environment(16, 3)); // another resolution, under the rotation
    keep();
    set_rotation(editor, 0.0);
    keep();
    cubemap::CubeMap painted = *editor.environment().state().base->map();
    painted.at(cubemap::Face::NegativeX, 3, 4) = glm::vec3(20.0f);
    update(editor, environment(painted));
    keep();
    ASSERT_EQ(states.size(), 7u);
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = states.size() - 1; i-- > 0;) {
            ASSERT_TRUE(editor.environment().history().can_undo(editor.environment().state()));
            undo(editor);
            EXPECT_EQ(copy(editor.radiance()), states[i]) << "undo to " << i;
            EXPECT_EQ(environment_of(editor).texels, environments[i]);
        }
        EXPECT_FALSE(editor.environment().history().can_undo(editor.environment().state()));
        EXPECT_EQ(editor.environment().state().rotation_degrees, 0.0);
        for (std::size_t i = 1; i < states.size(); ++i) {
            ASSERT_TRUE(editor.environment().history().can_redo());
            redo(editor);
            EXPECT_EQ(copy(editor.radiance()), states[i]) << "redo to " << i;
            EXPECT_EQ(environment_of(editor).texels, environments[i]);
        }
    }
}

TEST(LightEdits, TheHistoryKeepsNoMoreBasesThanItMay) {
    LitScene editor = scenes::relit_clusters();
    constexpr std::uint32_t Resolution = 8;
    constexpr std::size_t BytesOfBase =
        std::size_t{6} * Resolution * Resolution * sizeof(glm::vec3);
    editor.environment().history().limit(2 * BytesOfBase);
    std::vector<std::weak_ptr<const cubemap::CubeMap>> bases;
    for (unsigned i = 0; i < 6; ++i) {
        editor.light(scenes::random_environment(Resolution, i));
        mark(editor);
        bases.emplace_back(editor.environment().state().base->map());
        set_layers(editor, {named_disc("lamp", {0.2, 0.5, 1.0 + i}, 12.0, glm::vec3(3.0f))});
        mark(editor);
    }
    for (std::size_t i = 0; i < bases.size(); ++i)
        EXPECT_EQ(bases[i].expired(), i + 3 < bases.size()) << "two and the present one: " << i;
    int num_steps = 0;
    for (; editor.environment().history().can_undo(editor.environment().state()); ++num_steps)
        undo(editor);
    EXPECT_EQ(num_steps, 5) << "three bases with two marks each";
    EXPECT_EQ(editor.environment().state().base->map(), bases[3].lock());

    // However small the limit, the last step can be undone.
    editor.environment().history().limit(0);
    editor.light(scenes::random_environment(Resolution, 7));
    mark(editor);
    EXPECT_TRUE(editor.environment().history().can_undo(editor.environment().state()));
    undo(editor);
    EXPECT_EQ(editor.environment().state().base->map(), bases[3].lock());
}

TEST(LightEdits, RefusesABadBaseAndStaysAsItWas) {
    LitScene editor = scenes::relit_clusters();
    EXPECT_THROW(editor.light(cubemap::CubeMap()), std::invalid_argument);
    EXPECT_THROW(editor.light(cubemap::CubeMap(8, glm::vec3(-1.0f))), std::invalid_argument);
    EXPECT_FALSE(editor.environment().state().base);
    editor.light(scenes::random_environment(16, 2));
    set_rotation(editor, 30.0);
    set_layers(editor, {named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f))});
    mark(editor);
    const std::vector<glm::vec3> before = copy(editor.radiance());
    const std::vector<glm::vec3> texels = environment_of(editor).texels;
    EXPECT_THROW(editor.light(cubemap::CubeMap(32, glm::vec3(-1.0f))), std::invalid_argument);
    EXPECT_EQ(copy(editor.radiance()), before);
    EXPECT_EQ(environment_of(editor).texels, texels);
    set_layers(editor, {});
    set_layers(editor, {named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f))});
    EXPECT_EQ(environment_of(editor).texels, texels) << "the turned base is the old one";
}

TEST(LightEdits, AMapThatIsTooBrightUnderLayersChangesNothing) {
    LitScene lit = scenes::relit_clusters();
    lit.light(scenes::random_environment(16, 2));
    set_layers(lit,
               {named_disc("lamp", {0.0, 1.0, 0.3}, 20.0, glm::vec3(0.5f * relight::MaxRadiance))});
    const std::vector<glm::vec3> texels = environment_of(lit).texels,
                                 radiance = copy(lit.radiance());
    EXPECT_THROW(lit.light(cubemap::CubeMap(16, glm::vec3(0.75f * relight::MaxRadiance))),
                 std::invalid_argument);
    EXPECT_EQ(environment_of(lit).texels, texels);
    EXPECT_EQ(copy(lit.radiance()), radiance);
    // And edits go on.
    set_layers(lit, {});
    EXPECT_EQ(environment_of(lit).texels, scenes::random_environment(16, 2).texels);
}

TEST(LightEdits, ASharedMapIsNeitherCopiedNorChanged) {
    const auto map = std::make_shared<const cubemap::CubeMap>(scenes::random_environment(16, 2));
    LitScene shared = scenes::relit_clusters(), own = scenes::relit_clusters();
    shared.light(Light(map));
    EXPECT_EQ(&environment_of(shared), map.get());
    own.light(*map);
    EXPECT_EQ(copy(shared.radiance()), copy(own.radiance()));
    const std::vector<glm::vec3> bright(4, glm::vec3(7.0f));
    for (LitScene* lit : {&shared, &own}) {
        lit->environment().update_region({cubemap::Face::PositiveY, 3, 4, 5, 6}, bright);
        set_layers(*lit, {named_disc("lamp", {0.0, 1.0, 0.3}, 20.0, glm::vec3(3.0f))});
    }
    EXPECT_EQ(copy(shared.radiance()), copy(own.radiance()));
    // Under layers.
    shared.light(Light(map));
    own.light(*map);
    EXPECT_EQ(environment_of(shared).texels, environment_of(own).texels);
    EXPECT_EQ(shared.environment().state().base->map(), map);
    EXPECT_EQ(copy(shared.radiance()), copy(own.radiance()));
    EXPECT_EQ(map->texels, scenes::random_environment(16, 2).texels);
}

TEST(LightEdits, AMovingTurnIsNearAndLeavesNoTrace) {
    // Twice as fine as what moves, with a lamp between its texels.
    cubemap::CubeMap base(2 * MovingResolution, glm::vec3(0.2f, 0.3f, 0.4f));
    for (std::uint32_t y = 101; y < 108; ++y)
        for (std::uint32_t x = 203; x < 211; ++x)
            base.at(cubemap::Face::PositiveZ, x, y) = glm::vec3(4000.0f, 3000.0f, 2000.0f);
    const cubemap::LightLayer lamp = named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f));
    LitScene moving = scenes::relit_clusters(), exact = scenes::relit_clusters();
    for (LitScene* lit : {&moving, &exact}) {
        lit->light(base);
        set_layers(*lit, {lamp});
    }
    for (const double degrees : {11.0, 47.5, -20.0}) {
        set_rotation(moving, degrees, Ending::Moving);
        set_rotation(exact, degrees);
        EXPECT_EQ(environment_of(moving).resolution, MovingResolution);
        EXPECT_EQ(moving.environment().state().base->map()->resolution, 2 * MovingResolution);
        EXPECT_LT(relative_difference(moving.radiance(), exact.radiance()), 0.01) << degrees;
    }
    // Whatever comes next, the whole map is back.
    mark(exact);
    LitScene by_layer = scenes::relit_clusters();
    by_layer.light(base);
    set_layers(by_layer, {lamp});
    set_rotation(by_layer, -20.0, Ending::Moving);
    set_layer(by_layer, 0, lamp);
    EXPECT_EQ(environment_of(by_layer).texels, environment_of(exact).texels);
    mark(moving);
    EXPECT_EQ(environment_of(moving).texels, environment_of(exact).texels);
    EXPECT_EQ(copy(moving.radiance()), copy(exact.radiance()));
    set_rotation(moving, 90.0, Ending::Moving);
    undo(moving);
    EXPECT_EQ(copy(moving.radiance()), copy(exact.radiance()));
}

TEST(LightEdits, MapsThatAreQuickToTurnAreTurnedWhole) {
    LitScene moving = scenes::relit_clusters(), exact = scenes::relit_clusters();
    for (LitScene* lit : {&moving, &exact})
        lit->light(scenes::random_environment(16, 2));
    set_rotation(moving, 30.0, Ending::Moving);
    set_rotation(exact, 30.0);
    EXPECT_EQ(copy(moving.radiance()), copy(exact.radiance()));
}

TEST(LightEdits, PaintingOnTouchesOnlyTheNewPieceAndLeavesNoTrace) {
    const cubemap::CubeMap base = scenes::random_environment(64, 4);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int trial = 0; trial < 6; ++trial) {
        LitScene editor = scenes::relit_clusters();
        editor.light(base);
        if (trial % 2 == 1)
            set_rotation(editor, 37.0);
        cubemap::LightLayer layer = named_disc("stroke", {1, 0, 0}, 1.0, glm::vec3(2.0f));
        cubemap::Stroke stroke{.points = {scenes::random_direction(random)},
                               .radius_degrees = 0.5 + 12.0 * unit(random),
                               .softness = trial % 3 == 0 ? 0.0 : unit(random)};
        layer.region = stroke;
        set_layers(editor, {layer});
        std::size_t most_touched = 0;
        const auto set_points = [&](std::size_t count) {
            cubemap::Stroke part = stroke;
            part.points.resize(count);
            layer.region = part;
            most_touched = std::max(most_touched, set_layer(editor, 0, layer).num_clusters);
            // Texels that were not told to have changed are as they were, and all are as made from
            // scratch.
            LitScene afresh = scenes::relit_clusters();
            afresh.light(base);
            set_rotation(afresh, editor.environment().state().rotation_degrees);
            set_layers(afresh, {layer});
            ASSERT_EQ(environment_of(editor).texels, environment_of(afresh).texels)
                << trial << ", " << count;
            EXPECT_LT(relative_difference(editor.radiance(), afresh.radiance()), 1e-6);
        };
        for (int i = 0; i < 10; ++i) { // also back over itself
            stroke.points.push_back(glm::normalize(stroke.points.back()) +
                                    0.15 * glm::dvec3(scenes::random_direction(random)));
            set_points(stroke.points.size());
        }
        set_points(6); // and back, several points at once
        set_points(stroke.points.size());
        if (stroke.radius_degrees < 3.0) {
            EXPECT_LT(most_touched, relit_scene().transfer.num_clusters() / 3);
        }
    }
}

TEST(LightEdits, ToldTexelsHoldEveryChangeOnceOnly) {
    LitScene editor = scenes::relit_clusters();
    editor.light(scenes::random_environment(64, 4));
    std::mt19937 random(9);
    cubemap::CubeMap kept = environment_of(editor);
    std::vector<cubemap::LightLayer> layers = {random_layer(random), random_layer(random)};
    for (int edit = 0; edit < 60; ++edit) {
        std::vector<cubemap::TexelRectangle> texels;
        const auto note = [&](const UpdateReport& report) {
            texels.assign(report.texels.begin(), report.texels.end());
        };
        if (edit % 7 == 3)
            note(undo(editor));
        else if (edit % 20 == 19)
            note(set_rotation(editor, edit));
        else {
            layers[static_cast<std::size_t>(edit) % 2] = random_layer(random);
            note(set_layers(editor, layers));
            if (edit % 3 == 0)
                mark(editor);
        }
        std::vector<int> told(kept.texels.size(), 0);
        for (const cubemap::TexelRectangle& part : texels)
            for (std::uint32_t y = part.y0; y < part.y1; ++y)
                for (std::uint32_t x = part.x0; x < part.x1; ++x) {
                    kept.at(part.face, x, y) = environment_of(editor).at(part.face, x, y);
                    ++told[kept.index(part.face, x, y)];
                }
        EXPECT_EQ(kept.texels, environment_of(editor).texels) << edit;
        EXPECT_LE(*std::max_element(told.begin(), told.end()), 1) << edit;
    }
}

TEST(LightEdits, SmallEditsTouchFewClusters) {
    LitScene editor = scenes::relit_clusters();
    editor.light(cubemap::CubeMap(64, glm::vec3(0.5f)));
    const UpdateReport report =
        set_layers(editor, {named_disc("lamp", {0.3, 1.0, 0.2}, 3.0, glm::vec3(4.0f))});
    EXPECT_GT(report.num_clusters, 0u);
    EXPECT_LT(report.num_clusters, relit_scene().transfer.num_clusters() / 4);
    EXPECT_EQ(set_layers(editor, {named_disc("lamp", {0.3, 1.0, 0.2}, 3.0, glm::vec3(4.0f))})
                  .num_clusters,
              0u)
        << "nothing changed";
}

TEST(LightEdits, RotationTurnsBaseAndLayersTogether) {
    const cubemap::CubeMap base = scenes::random_environment(32, 9);
    const cubemap::LightLayer lamp = named_disc("lamp", {0.2, 0.5, 1.0}, 12.0, glm::vec3(3.0f));
    cubemap::LightLayer above = named_disc("above", {0.0, 1.0, 0.0}, 10.0, glm::vec3(2.0f));
    above.region = cubemap::Rectangle{
        .direction = {0.0, 1.0, 0.0}, .width_degrees = 40.0, .height_degrees = 10.0};
    for (const double degrees : {90.0, 180.0, -90.0}) {
        LitScene editor = scenes::relit_clusters();
        editor.light(base);
        set_layers(editor, {lamp, above});
        const cubemap::CubeMap expected = cubemap::rotated(environment_of(editor), degrees);
        set_rotation(editor, degrees);
        // Quarter turns permute texels; a layer's coverage is integrated anew, to 0.5 % of a texel
        // at its rim.
        for (std::size_t i = 0; i < expected.texels.size(); ++i)
            EXPECT_NEAR(glm::length(expected.texels[i] - environment_of(editor).texels[i]), 0.0,
                        0.03)
                << i;
        set_rotation(editor, 0.0);
        EXPECT_EQ(environment_of(editor).texels,
                  cubemap::composite(base, editor.environment().state().layers).texels);
    }
}

TEST(LightEdits, TurnsWithAndWithoutLayersWriteOverNothingThatIsShown) {
    const cubemap::CubeMap base = scenes::random_environment(32, 9);
    const cubemap::LightLayer lamp = named_disc("lamp", {0.2, 0.5, 1.0}, 12.0, glm::vec3(3.0f));
    cubemap::LightLayer off = lamp;
    off.on = false;
    struct Step {
        double degrees;
        std::vector<cubemap::LightLayer> layers;
    };
    LitScene editor = scenes::relit_clusters();
    editor.light(base);
    for (const Step& step :
         {Step{30.0, {}}, Step{50.0, {}}, Step{50.0, {lamp}}, Step{70.0, {lamp}}, Step{80.0, {}},
          Step{95.0, {off}}, Step{95.0, {lamp}}, Step{20.0, {off}}, Step{0.0, {}}}) {
        set_layers(editor, step.layers);
        set_rotation(editor, step.degrees);
        LitScene afresh = scenes::relit_clusters();
        afresh.light(base);
        set_rotation(afresh, step.degrees);
        EXPECT_EQ(environment_of(afresh).texels, cubemap::rotated(base, step.degrees).texels);
        set_layers(afresh, step.layers);
        EXPECT_EQ(environment_of(editor).texels, environment_of(afresh).texels) << step.degrees;
        mark(editor);
        mark(afresh);
        EXPECT_EQ(copy(editor.radiance()), copy(afresh.radiance())) << step.degrees;
        EXPECT_EQ(editor.environment().state().base->map()->texels, base.texels) << step.degrees;
    }
}

TEST(LightEdits, UpdateBaseTouchesOnlyWhatDiffers) {
    cubemap::CubeMap base = scenes::random_environment(64, 2);
    LitScene editor = scenes::relit_clusters();
    editor.light(base);
    set_layers(editor, {named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f))});
    EXPECT_EQ(update(editor, environment(base)).num_clusters, 0u);
    base.at(cubemap::Face::PositiveY, 33, 20) = glm::vec3(50.0f);
    const UpdateReport report = update(editor, environment(base));
    EXPECT_GT(report.num_clusters, 0u);
    EXPECT_LT(report.num_clusters, relit_scene().transfer.num_clusters() / 4);
    EXPECT_EQ(environment_of(editor).texels,
              cubemap::composite(base, editor.environment().state().layers).texels);
    EXPECT_LT(relative_difference(editor.radiance(), lit_afresh(editor, base)), 1e-6);
}

TEST(LightEdits, RefusesBadLayersAndStaysAsItWas) {
    LitScene editor = scenes::relit_clusters();
    editor.light(scenes::random_environment(16, 2));
    set_layers(editor, {named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f))});
    const std::vector<glm::vec3> before = copy(editor.radiance());
    const cubemap::LightLayer bad = named_disc("bad", {0.0, 0.0, 0.0}, 8.0, glm::vec3(3.0f));
    EXPECT_THROW(set_layers(editor, {bad}), std::invalid_argument);
    EXPECT_THROW(set_layer(editor, 0, bad), std::invalid_argument);
    EXPECT_THROW(set_layer(editor, 1, editor.environment().state().layers[0]), std::out_of_range);
    // Two lights that are too bright only together; a base that is too bright only under them.
    cubemap::LightLayer nearly = named_disc("nearly", {0.0, 1.0, 0.3}, 8.0, glm::vec3(0.9e30f));
    EXPECT_THROW(set_layers(editor, {nearly, nearly}), std::invalid_argument);
    EXPECT_EQ(copy(editor.radiance()), before);
    EXPECT_EQ(editor.environment().state().layers[0].name, "lamp");
    const std::vector<glm::vec3> texels = environment_of(editor).texels;
    set_layers(editor, {nearly});
    EXPECT_THROW(update(editor, environment(cubemap::CubeMap(16, glm::vec3(0.5e30f)))),
                 std::invalid_argument);
    set_layers(editor, {named_disc("lamp", {0.0, 1.0, 0.3}, 8.0, glm::vec3(3.0f))});
    EXPECT_EQ(environment_of(editor).texels, texels);
}

TEST(LightEdits, SnapshotsNeverShowHalfAnUpdate) {
    // Two states, far apart everywhere; a reader may see either, never a mixture.
    LitScene editor = scenes::relit_clusters();
    editor.light(cubemap::CubeMap(8, glm::vec3(0.0f)));
    const cubemap::LightLayer dark = named_disc("all", {0.0, 1.0, 0.0}, 180.0, glm::vec3(0.0f));
    const cubemap::LightLayer bright = named_disc("all", {0.0, 1.0, 0.0}, 180.0, glm::vec3(1.0f));
    set_layers(editor, {bright});
    const std::vector<glm::vec3> lit = copy(editor.radiance());
    set_layers(editor, {dark});
    const std::vector<glm::vec3> unlit = copy(editor.radiance());

    SharedRadiance shared;
    shared.publish(editor.radiance());
    std::atomic<bool> done = false;
    std::atomic<int> num_mixed = 0;
    std::thread reader([&] {
        while (!done) {
            const std::vector<glm::vec3> seen = shared.snapshot();
            num_mixed += static_cast<int>(relative_difference(seen, lit) > 1e-6 &&
                                          relative_difference(seen, unlit) > 1e-6);
        }
    });
    for (int i = 0; i < 100; ++i) {
        set_layer(editor, 0, i % 2 == 0 ? bright : dark);
        shared.publish(editor.radiance());
    }
    done = true;
    reader.join();
    EXPECT_EQ(num_mixed, 0);
}

} // namespace
} // namespace relumine
