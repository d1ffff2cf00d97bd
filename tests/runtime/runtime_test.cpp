// The runtime gives what the libraries give from the same file.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>
#include <vector>

#include <glm/gtc/packing.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cubemap/resample/resample.h"
#include "prt/scene/relighting_file.h"
#include "prt/scene/scene_file.h"
#include "relight/bounces/bounce_light.h"
#include "relight/relighter.h"
#include "relight/visible_parts.h"
#include "relumine_runtime.h"
#include "tests/prt/scenes.h"
#include "tests/relight/bounces/bouncing_scene.h"
#include "tests/relight/environments.h"

namespace relumine::runtime {
namespace {

using ::testing::HasSubstr;
using Path = std::filesystem::path;
constexpr std::uint32_t Resolution = 32;

/// A file with bounces, and what the libraries read of it.
struct Stored {
    Stored() {
        const relight::BouncingScene made(scenes::sphere_and_box_on_floor(), 0.05f, 0.03f);
        prt::save_scene(
            path, {.mesh = made.mesh,
                   .transfer = made.transfer,
                   .settings = {.tolerance = 0.03f, .face_resolution = 256, .bias = made.bias},
                   .bounces = made.matrix});
        scene = prt::load_scene(path);
    }
    ~Stored() { std::filesystem::remove(path); }

    Path path = Path(::testing::TempDir()) / "runtime_test.prt";
    prt::Scene scene;
};

const Stored& stored() {
    static const Stored Scene;
    return Scene;
}

class Opened {
public:
    explicit Opened(const RelumineOpenOptions* options = nullptr,
                    const Path& path = stored().path) {
        EXPECT_EQ(relumine_open(path.c_str(), options, &scene), RELUMINE_OK)
            << relumine_last_error();
        info.size = sizeof info;
        EXPECT_EQ(relumine_info(scene, &info), RELUMINE_OK);
    }
    ~Opened() { relumine_close(scene); }
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;

    void light(const cubemap::CubeMap& map) const {
        EXPECT_EQ(relumine_light_cube_map(scene, map.resolution, &map.texels[0].x), RELUMINE_OK)
            << relumine_last_error();
    }
    [[nodiscard]] std::vector<glm::vec3> radiance() const {
        std::vector<glm::vec3> result(info.num_receivers);
        EXPECT_EQ(relumine_radiance(scene, &result[0].x, 3 * result.size()), RELUMINE_OK)
            << relumine_last_error();
        return result;
    }

    RelumineScene* scene = nullptr;
    RelumineInfo info{};
};

void expect_equal(std::span<const glm::vec3> got, std::span<const glm::vec3> expected) {
    ASSERT_EQ(got.size(), expected.size());
    float brightest = 0.0f;
    for (const glm::vec3& value : expected)
        brightest = std::max({brightest, value.r, value.g, value.b});
    ASSERT_GT(brightest, 0.0f);
    for (std::size_t i = 0; i < got.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(got[i][channel], expected[i][channel], 1e-6f * brightest) << i;
}

TEST(Runtime, InfoAndGeometryAreTheFiles) {
    const Opened opened;
    const prt::Scene& scene = stored().scene;
    EXPECT_EQ(opened.info.kind, RELUMINE_VERTICES);
    EXPECT_EQ(opened.info.num_receivers, scene.mesh.num_vertices());
    EXPECT_EQ(opened.info.num_clusters, scene.transfer.num_clusters());
    EXPECT_EQ(opened.info.has_bounces, 1u);
    EXPECT_EQ(opened.info.num_harmonics, 0u);
    std::vector<glm::vec3> positions(opened.info.num_receivers), normals(positions);
    std::vector<std::uint32_t> triangles(3 * std::size_t{opened.info.num_triangles});
    EXPECT_EQ(relumine_positions(opened.scene, &positions[0].x, 3 * positions.size()), RELUMINE_OK);
    EXPECT_EQ(relumine_normals(opened.scene, &normals[0].x, 3 * normals.size()), RELUMINE_OK);
    EXPECT_EQ(relumine_triangles(opened.scene, triangles.data(), triangles.size()), RELUMINE_OK);
    EXPECT_EQ(positions, scene.mesh.positions);
    EXPECT_EQ(normals, scene.mesh.normals);
    EXPECT_EQ(triangles[3], scene.mesh.triangles[1][0]);
    EXPECT_EQ(relumine_places(opened.scene, triangles.data(), 1), RELUMINE_NOT_THERE);
}

TEST(Runtime, RadianceIsTheLibrarys) {
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 1);
    relight::Relighter relighter(stored().scene.transfer);
    relighter.set_environment(map);
    const Opened opened;
    opened.light(map);
    expect_equal(opened.radiance(), relighter.radiance());

    std::vector<std::uint16_t> half(3 * std::size_t{opened.info.num_receivers});
    ASSERT_EQ(relumine_radiance_half(opened.scene, half.data(), half.size()), RELUMINE_OK);
    for (std::size_t i = 0; i < half.size(); ++i) {
        const float whole = relighter.radiance()[i / 3][static_cast<int>(i % 3)];
        EXPECT_NEAR(glm::unpackHalf1x16(half[i]), whole, 5e-4f * whole + 1e-6f);
    }
}

TEST(Runtime, PicturesListsAndTurnsAreTheLibrarys) {
    relight::Relighter relighter(stored().scene.transfer);
    const Opened opened;
    cubemap::EnvironmentImage image;
    image.width = 64;
    image.height = 32;
    for (std::uint32_t i = 0; i < image.width * image.height; ++i)
        image.pixels.emplace_back(i % 7, 1.0f, i % 64 < 5 ? 20.0f : 0.5f);
    const cubemap::CubeMap map = cubemap::resample(image, 16);
    relighter.set_environment(map);
    ASSERT_EQ(relumine_light_lat_long(opened.scene, 64, 32, 16, &image.pixels[0].x), RELUMINE_OK);
    expect_equal(opened.radiance(), relighter.radiance());
    ASSERT_EQ(relumine_light_lat_long(opened.scene, 64, 32, 0, &image.pixels[0].x), RELUMINE_OK);
    expect_equal(opened.radiance(), relighter.radiance());

    relighter.set_environment(cubemap::rotated(map, 33.0));
    ASSERT_EQ(relumine_turn(opened.scene, 10.0), RELUMINE_OK);
    ASSERT_EQ(relumine_turn(opened.scene, 33.0), RELUMINE_OK) << "of what was given";
    expect_equal(opened.radiance(), relighter.radiance());

    const RelumineLight light = {.direction = {0.0f, 0.6f, 0.8f}, .irradiance = {3.0f, 2.0f, 1.0f}};
    relighter.set_lights(std::vector{
        lights::DistantLight{.direction = {0.0f, 0.6f, 0.8f}, .irradiance = {3.0, 2.0, 1.0}}});
    ASSERT_EQ(relumine_light_list(opened.scene, &light, 1), RELUMINE_OK) << relumine_last_error();
    expect_equal(opened.radiance(), relighter.radiance());
    EXPECT_EQ(relumine_turn(opened.scene, 1.0), RELUMINE_NOT_LIT) << "a list does not turn";
    EXPECT_STREQ(relumine_last_error(),
                 "expected light of an environment, got a list of lights, which has no texels");
}

TEST(Runtime, AnUpdateIsANewLightOfTheSameMap) {
    cubemap::CubeMap map = scenes::random_environment(Resolution, 2);
    const Opened opened;
    opened.light(map);
    const std::vector<glm::vec3> patch(6 * 4, glm::vec3(30.0f, 1.0f, 0.0f));
    ASSERT_EQ(relumine_update(opened.scene, 2, 5, 9, 6, 4, &patch[0].x), RELUMINE_OK)
        << relumine_last_error();
    for (std::uint32_t y = 9; y < 13; ++y)
        for (std::uint32_t x = 5; x < 11; ++x)
            map.at(cubemap::Face::PositiveY, x, y) = patch[0];
    relight::Relighter relighter(stored().scene.transfer);
    relighter.set_environment(map);
    const std::vector<glm::vec3> updated = opened.radiance();
    const std::span<const glm::vec3> expected = relighter.radiance();
    for (std::size_t i = 0; i < updated.size(); ++i)
        EXPECT_NEAR(updated[i].r, expected[i].r, 1e-4f * expected[i].r + 1e-5f);
}

TEST(Runtime, ThreadsOfTheCallerChangeNothing) {
    struct Counted {
        std::atomic<std::size_t> num_pieces = 0;
    } counted;
    const RelumineJobs jobs = {
        .size = sizeof(RelumineJobs),
        .run =
            [](void* user, std::size_t num_pieces, void (*piece)(void*, std::size_t), void* of) {
                std::atomic<std::size_t> next = 0;
                const auto work = [&] {
                    for (std::size_t i = next++; i < num_pieces; i = next++)
                        piece(of, i);
                };
                std::thread other(work), third(work);
                work();
                other.join();
                third.join();
                static_cast<Counted*>(user)->num_pieces += num_pieces;
            },
        .user = &counted,
        .num_threads = 3};
    const RelumineOpenOptions options = {.size = sizeof options, .jobs = &jobs, .harmonics = 3};
    const RelumineOpenOptions alone = {.size = sizeof options, .jobs = nullptr, .harmonics = 3};
    const Opened many(&options), one(&alone);
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 3);
    const std::vector<glm::vec3> albedo(many.info.num_receivers, glm::vec3(0.5f));
    for (const Opened* opened : {&many, &one}) {
        opened->light(map);
        ASSERT_EQ(relumine_set_albedo(opened->scene, &albedo[0].x, 3 * albedo.size()), RELUMINE_OK);
        ASSERT_EQ(relumine_bounce(opened->scene, nullptr), RELUMINE_OK) << relumine_last_error();
    }
    EXPECT_EQ(many.radiance(), one.radiance());
    EXPECT_GT(counted.num_pieces, 10u);
}

TEST(Runtime, BouncesAndHarmonicsAreTheLibrarys) {
    const prt::Scene& scene = stored().scene;
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 4);
    const std::vector<glm::vec3> albedo(scene.receivers.size(), glm::vec3(0.7f, 0.5f, 0.3f));
    relight::Relighter relighter(scene.transfer, {}, 3);
    relighter.set_environment(map);
    relight::BounceLight bounces(*scene.bounces, scene.transfer);
    bounces.set_albedo(albedo);
    bounces.solve(relighter.diffuse_radiance(), {.num_bounces = 2});
    std::vector<glm::vec3> expected(relighter.diffuse_radiance().begin(),
                                    relighter.diffuse_radiance().end());
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] += bounces.indirect()[i];

    // The albedo comes with the file that is made for this.
    const Path lean = Path(::testing::TempDir()) / "runtime_test.relight";
    prt::save_relighting_scene(lean, {.scene = scene, .albedo = albedo});
    const RelumineOpenOptions options = {.size = sizeof options, .jobs = nullptr, .harmonics = 3};
    const Opened opened(&options, lean);
    std::filesystem::remove(lean);
    opened.light(map);
    const RelumineBounces two = {
        .size = sizeof two, .num_bounces = 2, .tolerance = 0.0f, .is_step = 0};
    ASSERT_EQ(relumine_bounce(opened.scene, &two), RELUMINE_OK) << relumine_last_error();
    expect_equal(opened.radiance(), expected);

    EXPECT_EQ(opened.info.num_harmonics, 9u);
    std::vector<glm::vec3> light(9 * scene.receivers.size());
    ASSERT_EQ(relumine_harmonics(opened.scene, &light[0].x, 3 * light.size()), RELUMINE_OK);
    expect_equal(light, relighter.harmonics());
    opened.light(map);
    expect_equal(opened.radiance(), relighter.diffuse_radiance());
}

TEST(Runtime, WrongCallsChangeNothing) {
    const Opened opened;
    std::vector<glm::vec3> radiance(opened.info.num_receivers);
    const std::size_t count = 3 * radiance.size();
    EXPECT_EQ(relumine_radiance(opened.scene, &radiance[0].x, count), RELUMINE_NOT_LIT);
    EXPECT_EQ(relumine_bounce(opened.scene, nullptr), RELUMINE_NOT_LIT);
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 5);
    opened.light(map);
    const std::vector<glm::vec3> before = opened.radiance();

    cubemap::CubeMap bad = map;
    bad.texels[7].g = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(relumine_light_cube_map(opened.scene, Resolution, &bad.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_THAT(relumine_last_error(), HasSubstr("expected"));
    EXPECT_EQ(relumine_light_cube_map(opened.scene, 0, &bad.texels[0].x), RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_light_lat_long(opened.scene, 4, 4, 1, &bad.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_light_lat_long(opened.scene, 0, 4, 1, &bad.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_update(opened.scene, 6, 0, 0, 1, 1, &map.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_update(opened.scene, 0, Resolution, 0, 1, 1, &map.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_update(opened.scene, 0, ~0u, 0, 2, 1, &map.texels[0].x),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_turn(opened.scene, std::numeric_limits<double>::infinity()),
              RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_harmonics(opened.scene, &radiance[0].x, count), RELUMINE_NOT_THERE);
    EXPECT_EQ(relumine_bounce(opened.scene, nullptr), RELUMINE_NOT_THERE) << "no albedo";
    EXPECT_THAT(relumine_last_error(), HasSubstr("albedo"));
    EXPECT_EQ(relumine_radiance(opened.scene, &radiance[0].x, count - 1), RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_radiance(opened.scene, nullptr, count), RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(opened.radiance(), before);
}

TEST(Runtime, NoLightsAreDarkness) {
    const Opened opened;
    const RelumineLight light{.direction = {0.0f, 1.0f, 0.0f}, .irradiance = {1.0f, 1.0f, 1.0f}};
    ASSERT_EQ(relumine_light_list(opened.scene, &light, 1), RELUMINE_OK);
    EXPECT_GT(opened.radiance().at(0).g, 0.0f);
    for (const RelumineLight* none : {&light, static_cast<const RelumineLight*>(nullptr)}) {
        ASSERT_EQ(relumine_light_list(opened.scene, none, 0), RELUMINE_OK);
        for (const glm::vec3& radiance : opened.radiance())
            ASSERT_EQ(radiance, glm::vec3(0.0f));
    }
}

TEST(Runtime, BrokenFilesAreRefusedFromMemoryToo) {
    std::ifstream in(stored().path, std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    RelumineScene* scene = nullptr;
    ASSERT_EQ(relumine_open_bytes(bytes.data(), bytes.size(), nullptr, &scene), RELUMINE_OK)
        << relumine_last_error();
    relumine_close(scene);
    EXPECT_EQ(relumine_open("", nullptr, &scene), RELUMINE_WRONG_FILE);
    EXPECT_STREQ(relumine_last_error(), "path: expected a name, got an empty one");
    // A call that fails leaves the caller's scene alone.
    RelumineScene* const own = reinterpret_cast<RelumineScene*>(&bytes);
    scene = own;
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
        EXPECT_EQ(relumine_open_bytes(bytes.data(), size, nullptr, &scene), RELUMINE_WRONG_FILE)
            << size;
        EXPECT_EQ(scene, own);
    }
    for (std::size_t at = 5; at < bytes.size(); at += bytes.size() / 50) {
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
        EXPECT_EQ(relumine_open_bytes(bytes.data(), bytes.size(), nullptr, &scene),
                  RELUMINE_WRONG_FILE)
            << at;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    }
}

TEST(Runtime, CoarseTurnsTurnTheHalvedMap) {
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 6);
    relight::Relighter relighter(stored().scene.transfer);
    const Opened opened;
    EXPECT_EQ(relumine_turn_coarse(opened.scene, 1.0, 8), RELUMINE_NOT_LIT);
    opened.light(map);
    const cubemap::CubeMap half = cubemap::halved(map), quarter = cubemap::halved(half);
    struct Step {
        std::uint32_t resolution;
        const cubemap::CubeMap& map;
    };
    // Coarser, finer and as fine as it was; each turn begins with the map that was given.
    for (const Step& step : {Step{16, half}, Step{15, quarter}, Step{31, half}, Step{16, half},
                             Step{8, quarter}, Step{32, map}, Step{100, map}}) {
        EXPECT_EQ(relumine_turn_coarse(opened.scene, 30.0, step.resolution), RELUMINE_OK);
        relighter.set_environment(cubemap::rotated(step.map, 30.0));
        expect_equal(opened.radiance(), relighter.radiance());
    }
    EXPECT_EQ(relumine_turn(opened.scene, 30.0), RELUMINE_OK);
    expect_equal(opened.radiance(), relighter.radiance());
    EXPECT_EQ(relumine_turn_coarse(opened.scene, 30.0, 0), RELUMINE_WRONG_ARGUMENT);
    // A map that cannot be halved any further.
    opened.light(scenes::random_environment(6, 7));
    EXPECT_EQ(relumine_turn_coarse(opened.scene, 30.0, 2), RELUMINE_OK);
    EXPECT_EQ(relumine_contribution(opened.scene, 0, nullptr, 54), RELUMINE_WRONG_ARGUMENT);
}

glm::dvec3 total(const std::vector<glm::vec3>& texels, std::uint32_t resolution) {
    const std::vector<double> solid_angles = cubemap::texel_solid_angles(resolution);
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < texels.size(); ++i)
        sum += glm::dvec3(texels[i]) * solid_angles[i % solid_angles.size()];
    return sum;
}

TEST(Runtime, WhatLightsAReceiverAddsUpToItsRadiance) {
    const cubemap::CubeMap map = scenes::random_environment(Resolution, 5);
    const Opened opened;
    const std::size_t size = map.texels.size();
    std::vector<glm::vec3> texels(size);
    EXPECT_EQ(relumine_contribution(opened.scene, 0, &texels[0].x, 3 * size), RELUMINE_NOT_LIT);
    EXPECT_EQ(relumine_environment(opened.scene, &texels[0].x, 3 * size), RELUMINE_NOT_LIT);
    opened.light(map);
    EXPECT_EQ(relumine_environment(opened.scene, &texels[0].x, 3 * size), RELUMINE_OK);
    EXPECT_EQ(texels, map.texels);
    const std::vector<glm::vec3> albedo(opened.info.num_receivers, glm::vec3(0.5f));
    ASSERT_EQ(relumine_set_albedo(opened.scene, &albedo[0].x, 3 * albedo.size()), RELUMINE_OK);
    for (const bool with_bounces : {false, true}) {
        if (with_bounces) {
            const RelumineBounces how{
                .size = sizeof how, .num_bounces = 0, .tolerance = 1e-5f, .is_step = 0};
            ASSERT_EQ(relumine_bounce(opened.scene, &how), RELUMINE_OK);
        }
        const std::vector<glm::vec3> radiance = opened.radiance();
        for (std::uint32_t receiver = 0; receiver < radiance.size(); receiver += 37) {
            ASSERT_EQ(relumine_contribution(opened.scene, receiver, &texels[0].x, 3 * size),
                      RELUMINE_OK);
            const glm::dvec3 sum = total(texels, Resolution);
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_NEAR(sum[channel], radiance[receiver][channel], 1e-3) << receiver;
        }
    }
    EXPECT_EQ(
        relumine_contribution(opened.scene, opened.info.num_receivers, &texels[0].x, 3 * size),
        RELUMINE_WRONG_ARGUMENT);
    EXPECT_EQ(relumine_contribution(opened.scene, 0, &texels[0].x, 3 * size - 3),
              RELUMINE_WRONG_ARGUMENT);
}

TEST(Runtime, VisiblePartsAreThoseOfTheLibrary) {
    const Opened opened;
    const std::vector<glm::vec3> directions = {{0.0f, 1.0f, 0.0f}, {1.0f, 0.4f, 0.0f}};
    const std::size_t size = 2 * opened.info.num_receivers;
    std::vector<std::uint8_t> parts(size), expected(size);
    relight::VisibleParts(stored().scene.transfer, directions, 0.2f).find(expected);
    const float* const xyz = &directions[0].x;
    EXPECT_EQ(relumine_visible_parts(opened.scene, xyz, 2, 0.2f, parts.data(), size), RELUMINE_OK);
    EXPECT_EQ(parts, expected);
    EXPECT_NE(std::count(parts.begin(), parts.end(), 255), std::ptrdiff_t(size));
    std::vector<std::uint8_t> first(20);
    EXPECT_EQ(relumine_visible_parts(opened.scene, xyz, 2, 0.2f, first.data(), 20), RELUMINE_OK);
    expected.resize(20);
    EXPECT_EQ(first, expected);
    for (const RelumineResult result :
         {relumine_visible_parts(opened.scene, xyz, 2, 0.2f, parts.data(), size + 2),
          relumine_visible_parts(opened.scene, nullptr, 2, 0.2f, parts.data(), size),
          relumine_visible_parts(opened.scene, xyz, 2, 0.2f, nullptr, size),
          relumine_visible_parts(opened.scene, xyz, 0, 0.2f, parts.data(), 0),
          relumine_visible_parts(opened.scene, xyz, 2, 0.2f, parts.data(), size - 1),
          relumine_visible_parts(opened.scene, xyz, 2, 9.0f, parts.data(), size)})
        EXPECT_EQ(result, RELUMINE_WRONG_ARGUMENT);
}

TEST(Runtime, InfoOfAnOlderProgramEndsEarlier) {
    const Opened opened;
    opened.light(scenes::random_environment(Resolution, 5));
    RelumineInfo info{};
    info.resolution = 7;
    info.size = offsetof(RelumineInfo, resolution);
    EXPECT_EQ(relumine_info(opened.scene, &info), RELUMINE_OK);
    EXPECT_EQ(info.num_receivers, opened.info.num_receivers);
    EXPECT_EQ(info.resolution, 7u);
    info.size = sizeof info;
    EXPECT_EQ(relumine_info(opened.scene, &info), RELUMINE_OK);
    EXPECT_EQ(info.resolution, Resolution);
}

} // namespace
} // namespace relumine::runtime
