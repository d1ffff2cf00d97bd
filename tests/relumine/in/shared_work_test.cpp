// Processes that share a precompute and its light, and parts of a plan, against one process. Here
// the processes are threads.
#include <cmath>

#include <glm/geometric.hpp>

#include "prt/parts/scene_part.h"
#include "relumine/ask/questions.h"
#include "relumine/light/lit_part.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/prt/thread_team.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

constexpr std::uint32_t Counts[] = {1, 2, 3, 8};

/// A corner of four tiles of receivers; eight processes are too many.
constexpr std::uint32_t Side = 40;

/// Standard error of a bounce of a light of radiance 1.
constexpr float BounceError = 0.05f;

class SharedWork : public scenes::InFolder {
protected:
    [[nodiscard]] static PrecomputeOptions options(const ReceiverChoice& receivers,
                                                   const std::filesystem::path& output) {
        PrecomputeOptions result{.tolerance = 0.05f,
                                 .receivers = receivers,
                                 .bounce_tolerance = BounceError,
                                 .output = output,
                                 .checkpoint_seconds = 0.0};
        if (std::holds_alternative<Grid>(receivers))
            result.tolerance = ToleranceOfPoints;
        if (std::holds_alternative<Pixels>(receivers))
            result.view = View{
                Camera{.eye = {0.5f, 1.2f, 2.5f}, .target = {0.5f, 0.3f, 0.3f}, .fov_degrees = 30}};
        return result;
    }
    [[nodiscard]] static std::vector<ReceiverChoice> all_receivers() {
        return {Vertices{}, Pixels{.width = 60, .height = 40}, Texels{.width = 48, .height = 48},
                Grid{.nx = 5, .ny = 4, .nz = 6}};
    }
    [[nodiscard]] static Mesh mesh() {
        Mesh mesh(scenes::corner(Side));
        mesh.is_open = false; // as many vertices as that
        return mesh;
    }
    void make_scene() const {
        PrecomputeOptions work = options(Vertices{}, file("scene.prt"));
        work.surface = everywhere({.albedo = glm::vec3(0.7f, 0.5f, 0.3f)});
        (void)precompute(mesh(), work);
    }
    /// Calls work(shared, is_first) in each process.
    template<typename Work>
    void share(std::uint32_t count, const Work& work) const {
        prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t index) {
            LitScene light(prt::load_scene_part(file("scene.prt"), team.part()),
                           {.team = &team, .path = file("scene.prt")});
            work(light, index == 0);
        });
    }
};

cubemap::CubeMap sun_and_sky(float sun) {
    cubemap::CubeMap map(16, glm::vec3(0.2f, 0.3f, 0.5f));
    map.at(cubemap::Face::PositiveZ, 8, 3) = glm::vec3(sun);
    return map;
}

void expect_same_light(const Lighting& a, const Lighting& b) {
    EXPECT_TRUE(
        std::equal(a.radiance.begin(), a.radiance.end(), b.radiance.begin(), b.radiance.end()));
    EXPECT_EQ(a.soft, b.soft);
    EXPECT_EQ(a.lights, b.lights);
    EXPECT_EQ(a.environment == nullptr, b.environment == nullptr);
}

TEST_F(SharedWork, ProcessesFindTheBouncesOfOne) {
    for (const auto& receivers : all_receivers()) {
        (void)precompute(mesh(), options(receivers, file("whole.prt")));
        for (const std::uint32_t count : Counts) {
            prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t index) {
                if (index != 0)
                    return assist({.team = team});
                (void)precompute(mesh(), options(receivers, file("shared.prt")), {.team = team});
            });
            EXPECT_EQ(read("whole.prt"), read("shared.prt")) << count << " processes";
        }
    }
}

/// Relative L2 of the bounced light of two scenes with the same receivers.
double difference_of_bounces(const std::filesystem::path& a, const std::filesystem::path& b) {
    LitScene lit(load_scene(a)), other(load_scene(b));
    for (LitScene* each : {&lit, &other}) {
        each->light(sun_and_sky(60.0f));
        each->bounce({.albedo = bounce_albedo(each->scene())});
    }
    double difference = 0.0, all = 0.0;
    for (std::size_t i = 0; i < lit.bounces().bounced().size(); ++i) {
        const glm::dvec3 d =
            glm::dvec3(lit.bounces().bounced()[i]) - glm::dvec3(other.bounces().bounced()[i]);
        difference += glm::dot(d, d);
        all += glm::dot(glm::dvec3(lit.bounces().bounced()[i]),
                        glm::dvec3(lit.bounces().bounced()[i]));
    }
    return std::sqrt(difference / all);
}

TEST_F(SharedWork, PartsOfAPlanMakeTheSameBouncesInAnyNumber) {
    for (const auto& receivers : all_receivers()) {
        plan(mesh(), options(receivers, file("scene.plan")));
        std::string one;
        for (const std::uint32_t count : {1u, 4u, 7u}) {
            std::vector<std::filesystem::path> parts;
            for (std::uint32_t i = count; i-- > 0;) {
                parts.push_back(file("part." + std::to_string(i)));
                precompute_part(
                    {.plan = file("scene.plan"), .part = {i, count}, .output = parts.back()});
            }
            join(parts, file("planned.prt"));
            if (count == 1)
                one = read("planned.prt");
            EXPECT_EQ(one, read("planned.prt")) << count << " parts";
        }
        (void)precompute(mesh(), options(receivers, file("whole.prt")));
        EXPECT_LT(difference_of_bounces(file("whole.prt"), file("planned.prt")), BounceError);
    }
}

TEST_F(SharedWork, ProcessesFindTheLightOfOne) {
    make_scene();
    LitScene whole(load_scene(file("scene.prt")));
    const std::vector<glm::vec3> albedo = bounce_albedo(whole.scene());
    whole.light(sun_and_sky(60.0f));
    whole.bounce({.albedo = albedo, .limits = {.num_bounces = 2}});
    const Lighting light = whole.lighting();
    ASSERT_FALSE(light.lights.empty());
    for (const std::uint32_t count : Counts)
        share(count, [&](LitScene& shared, bool is_first) {
            shared.light(sun_and_sky(60.0f));
            shared.bounce({.albedo = albedo, .limits = {.num_bounces = 2}});
            const Lighting own = shared.lighting();
            EXPECT_EQ(own.radiance.empty(), !is_first);
            if (is_first)
                expect_same_light(light, own);
        });
}

TEST_F(SharedWork, ProcessesFindTheLightOfPoints) {
    (void)precompute(mesh(), options(Grid{.nx = 5, .ny = 4, .nz = 60}, file("scene.prt")));
    LitScene whole(load_scene(file("scene.prt")), {.harmonics = 2});
    const std::vector<glm::vec3> albedo = bounce_albedo(whole.scene());
    whole.light(sun_and_sky(60.0f));
    whole.bounce({.albedo = albedo});
    const std::vector<glm::vec3> harmonics = whole.harmonics();
    const std::vector<glm::vec3> radiance(whole.radiance().begin(), whole.radiance().end());
    for (const std::uint32_t count : {2u, 5u})
        prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t index) {
            LitScene shared(prt::load_scene_part(file("scene.prt"), team.part()),
                            {.harmonics = 2, .team = &team, .path = file("scene.prt")});
            shared.light(sun_and_sky(60.0f));
            shared.bounce({.albedo = albedo});
            const std::vector<glm::vec3> own = shared.harmonics();
            const Lighting light = shared.lighting();
            if (index != 0)
                return;
            EXPECT_EQ(own, harmonics);
            EXPECT_TRUE(std::equal(radiance.begin(), radiance.end(), light.radiance.begin(),
                                   light.radiance.end()));
        });
}

TEST_F(SharedWork, ProcessesAndPartsFindTheHighlightsOfOne) {
    PrecomputeOptions work = options(Vertices{}, file("scene.prt"));
    work.bounce_tolerance = 0.0f;
    work.view =
        View{Camera{.eye = {0.5f, 1.2f, 2.5f}, .target = {0.5f, 0.3f, 0.3f}, .fov_degrees = 30}};
    work.surface = everywhere({.albedo = glm::vec3(0.4f),
                               .specular = glm::vec3(0.3f),
                               .highlight = prt::Highlight::Ggx,
                               .roughness_or_exponent = 0.4f});
    work.glossy_tolerance = 0.3f;
    (void)precompute(mesh(), work);
    LitScene whole(load_scene(file("scene.prt")));
    ASSERT_TRUE(whole.scene().transfer.glossy);
    whole.light(sun_and_sky(60.0f));
    const Lighting light = whole.lighting();
    std::vector<float> highlights;
    for (std::size_t i = 0; i < light.radiance.size(); ++i)
        highlights.push_back(light.radiance[i].g -
                             0.4f * whole.relighter().diffuse_radiance()[i].g);
    ASSERT_GT(*std::max_element(highlights.begin(), highlights.end()), 0.05f);
    for (const std::uint32_t count : Counts) {
        share(count, [&](LitScene& shared, bool is_first) {
            shared.light(sun_and_sky(60.0f));
            const Lighting own = shared.lighting();
            if (is_first)
                expect_same_light(light, own);
        });
        std::vector<std::filesystem::path> parts;
        for (std::uint32_t i = 0; i < count; ++i) {
            parts.push_back(file("lit." + std::to_string(i)));
            light_part({.scene = file("scene.prt"), .part = {i, count}, .output = parts.back()},
                       sun_and_sky(60.0f));
        }
        join_light(parts, file("joined.npy"));
        save(whole, file("whole.npy"));
        EXPECT_EQ(read("joined.npy"), read("whole.npy")) << count << " parts";
    }
}

TEST_F(SharedWork, LightsOfAListBounceWithTheEnvironment) {
    make_scene();
    LitScene whole(load_scene(file("scene.prt")));
    const std::vector<glm::vec3> albedo = bounce_albedo(whole.scene());
    const std::vector<lights::DistantLight> list = {
        {.direction = glm::dvec3(0.6, 0.8, 0), .irradiance = glm::dvec3(2.0, 1.0, 0.5)}};
    Light light_of_both(sun_and_sky(60.0f));
    light_of_both.lights = list;
    whole.light(light_of_both);
    whole.bounce({.albedo = albedo});
    const Lighting light = whole.lighting();
    for (const std::uint32_t count : {2u, 5u})
        share(count, [&](LitScene& shared, bool is_first) {
            shared.light(light_of_both);
            shared.bounce({.albedo = albedo});
            const Lighting own = shared.lighting();
            if (is_first)
                expect_same_light(light, own);
        });
}

TEST_F(SharedWork, ProcessesFindTheFramesOfOne) {
    make_scene();
    const Scene scene = load_scene(file("scene.prt"));
    LitScene lit{Scene(scene)};
    const std::vector<lights::DistantLight> list = {
        {.direction = glm::dvec3(0, 1, 0), .irradiance = glm::dvec3(2.0)}};
    const std::vector<float> suns = {0.0f, 60.0f, 61.0f, 2.0f};
    for (const std::uint32_t count : {2u, 8u}) {
        LitScene whole{Scene(scene)};
        const std::vector<glm::vec3> albedo = bounce_albedo(scene);
        // All frames, then a list of lights.
        std::vector<std::vector<glm::vec3>> expected;
        const auto keep = [&] {
            whole.bounce({.albedo = albedo});
            expected.emplace_back(whole.radiance().begin(), whole.radiance().end());
        };
        for (const float sun : suns) {
            whole.light(bin(lit, sun_and_sky(sun)));
            keep();
        }
        whole.light(list);
        keep();
        share(count, [&](LitScene& shared, bool is_first) {
            std::size_t frame = 0;
            const auto compare = [&] {
                shared.bounce({.albedo = albedo});
                const Lighting light = shared.lighting(false);
                if (is_first) {
                    EXPECT_TRUE(std::equal(light.radiance.begin(), light.radiance.end(),
                                           expected[frame].begin(), expected[frame].end()));
                }
                ++frame;
            };
            for (const float sun : suns) {
                shared.light(bin(lit, sun_and_sky(sun)));
                compare();
            }
            shared.light(list);
            compare();
        });
    }
}

TEST_F(SharedWork, ProcessesFindTheErrorOfOne) {
    make_scene();
    const auto scene = std::make_shared<const Scene>(load_scene(file("scene.prt")));
    const auto verified = [&](prt::Team& team) {
        LitScene lit(scene);
        lit.light(sun_and_sky(60.0f));
        lit.bounce({.albedo = bounce_albedo(*scene)});
        return verify(lit, {.num_samples = 70, .num_surface_points = 30, .num_paths = 8},
                      {.team = team});
    };
    const Verification whole = verified(prt::alone());
    ASSERT_TRUE(whole.surface);
    for (const std::uint32_t count : Counts)
        prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t) {
            const Verification shared = verified(team);
            EXPECT_EQ(whole.receivers, shared.receivers);
            EXPECT_EQ(whole.error.relative_l2, shared.error.relative_l2);
            EXPECT_EQ(whole.error.worst_receiver, shared.error.worst_receiver);
            EXPECT_EQ(whole.noise, shared.noise);
            ASSERT_TRUE(shared.surface);
            EXPECT_EQ(whole.surface->error.relative_l2, shared.surface->error.relative_l2);
        });
}

} // namespace
} // namespace relumine
