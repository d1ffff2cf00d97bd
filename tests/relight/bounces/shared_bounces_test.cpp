// Bounces whose rows are in several processes, here threads, against one process.
#include <filesystem>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "prt/clusters/dealt_tiles.h"
#include "prt/parts/parts.h"
#include "prt/parts/scene_part.h"
#include "prt/parts/team_checkpoint.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/scenes.h"
#include "tests/prt/thread_team.h"
#include "tests/relight/bounces/bouncing_scene.h"

namespace relumine::relight {
namespace {

/// A ball over a floor: several tiles of receivers.
const BouncingScene& scene() {
    static const BouncingScene result(
        scenes::joined(scenes::floor_grid(64, 4.0f),
                       scenes::icosphere(3, 0.5f, {0.2f, 0.6f, 0.0f})),
        0.02f, 0.05f);
    return result;
}

/// The counts of a part, with order and normals of all.
prt::Transfer counts_of_part(const prt::Part& part) {
    prt::Transfer result = scene().transfer;
    prt::Transfer plan = scene().transfer;
    prt::Alone alone(part);
    result.counts =
        prt::part_counts(scene().receivers, plan, scene().rays,
                         {.face_resolution = 256, .bias = scene().bias}, {.team = alone});
    return result;
}

/// Samples of a part. `index`: given where it knows nothing of others.
prt::BounceSamples samples(const prt::Work& work, std::span<const std::uint32_t> index = {}) {
    const prt::Part part = work.team.part();
    const std::vector<prt::ProbeRadiance> probes = probe_radiance(scene().transfer);
    std::vector<float> open_parts;
    for (const std::uint32_t place : prt::places_of(part, probes.size()))
        open_parts.push_back(probes[place][0]);
    return prt::sample_bounces(scene().mesh, scene().receivers, counts_of_part(part),
                               {.open_parts = open_parts, .values = probes, .index = index},
                               scene().rays, {.tolerance = 0.02f, .bias = scene().bias}, work);
}

/// The tiles alone say how many rays a receiver needs; who shares them is found when all are there.
TEST(SharedBounces, PartsThatKnowNothingOfEachOtherMakeOneMatrix) {
    std::vector<std::uint32_t> all(scene().transfer.num_receivers());
    std::iota(all.begin(), all.end(), 0u);
    std::optional<prt::BounceMatrix> one;
    for (const std::uint32_t count : {1u, 3u, 7u}) {
        std::vector<prt::BounceSamples> parts;
        for (std::uint32_t index = 0; index < count; ++index) {
            prt::Alone alone({index, count});
            parts.push_back(samples({.team = alone}, all));
        }
        const prt::BounceMatrix matrix =
            prt::join_bounces(scene().receivers, scene().transfer, std::move(parts));
        if (!one)
            one = matrix;
        EXPECT_EQ(matrix, *one) << count << " parts";
    }
    EXPECT_EQ(one->averaged, scene().matrix.averaged);
    EXPECT_GE(one->emitters.places.size(), scene().matrix.emitters.places.size());
    EXPECT_LT(static_cast<double>(one->emitters.places.size()),
              1.1 * static_cast<double>(scene().matrix.emitters.places.size()));
}

TEST(SharedBounces, PartsOfDifferentKindsAreRefused) {
    const prt::BounceSamples all = samples({});
    const auto refuses = [&](std::vector<prt::BounceSamples> parts) {
        EXPECT_THROW((void)prt::join_bounces(scene().receivers, scene().transfer, std::move(parts)),
                     std::invalid_argument);
    };
    refuses({});
    refuses({all, all});
    prt::BounceSamples damaged = all;
    damaged.num_hits.pop_back();
    refuses({damaged});
}

/// Gives each run what an earlier one had saved up to some save; other numbers of processes go on.
TEST(SharedBounces, AnyNumberOfProcessesGoesOnFromTheCheckpointOfAll) {
    prt::CheckpointHistory history;
    const auto run = [&](std::uint32_t count, prt::MemoryCheckpoint& store) {
        std::vector<prt::BounceSamples> parts(count);
        prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t index) {
            prt::TeamCheckpoint checkpoint(team, index == 0 ? &store : nullptr);
            parts[index] = samples({.team = team, .checkpoint = &checkpoint});
        });
        EXPECT_EQ(prt::join_bounces(scene().receivers, scene().transfer, std::move(parts)),
                  scene().matrix);
    };
    run(3, history);
    ASSERT_GT(history.after.size(), 3u);
    std::uint32_t count = 0;
    for (const auto& saved : history.after) {
        prt::MemoryCheckpoint store;
        store.parts = saved;
        run(1 + count++ % 4, store);
    }
}

/// A matrix that has only the rows of a process.
prt::BounceMatrix rows_of(const prt::BounceMatrix& whole, const prt::Part& part,
                          std::size_t first) {
    prt::BounceMatrix result = whole;
    result.emitters = {};
    for (std::size_t row = 0; row < whole.num_rows(); ++row)
        result.emitters.append(prt::has_row(part, row, first) ? whole.emitters[row]
                                                              : std::span<const std::uint32_t>());
    return result;
}

TEST(SharedBounces, LightOfRowsInProcessesIsThatOfOne) {
    const prt::BounceMatrix& matrix = scene().matrix;
    const std::size_t n = matrix.num_rows();
    const std::size_t first = prt::first_emitter(matrix);
    std::vector<std::uint32_t> num_emitters;
    for (std::size_t row = 0; row < n; ++row)
        num_emitters.push_back(static_cast<std::uint32_t>(matrix.emitters[row].size()));
    std::vector<glm::vec3> albedo, direct;
    for (std::size_t i = 0; i < n; ++i) {
        albedo.emplace_back(0.3f + 0.6f * static_cast<float>(i % 7) / 7.0f, 0.8f, 0.5f);
        direct.emplace_back(1.0f, static_cast<float>(i % 11), 0.5f);
    }
    const auto results = [&](BounceLight& light) {
        std::vector<std::vector<glm::vec3>> found;
        const auto keep = [&] {
            found.emplace_back(light.indirect().begin(), light.indirect().end());
        };
        light.set_albedo(albedo);
        light.solve(direct);
        keep();
        light.step(albedo);
        keep();
        light.solve(direct, {.num_bounces = 2});
        keep();
        return found;
    };
    BounceLight whole(matrix, scene().transfer);
    const auto expected = results(whole);
    for (const std::uint32_t count : {1u, 2u, 3u, 8u})
        prt::ThreadTeam::run(count, [&](prt::Team& team, std::uint32_t) {
            const prt::BounceMatrix own = rows_of(matrix, team.part(), first);
            BounceLight shared(own, scene().transfer,
                               {.team = &team, .first = first, .num_emitters = num_emitters});
            EXPECT_EQ(results(shared), expected) << count << " processes";
        });
}

TEST(SharedBounces, ProcessesReadTheirRowsAlone) {
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / "shared_bounces.prt";
    prt::Scene saved;
    saved.mesh = scene().mesh;
    saved.receivers = scene().receivers;
    saved.transfer = scene().transfer;
    saved.bounces = scene().matrix;
    saved.settings = {.tolerance = 0.05f, .face_resolution = 256, .bias = scene().bias};
    prt::save_scene(path, saved);
    const std::size_t first = prt::first_emitter(scene().matrix);
    for (const std::uint32_t count : {1u, 3u, 8u})
        for (std::uint32_t index = 0; index < count; ++index) {
            const prt::ScenePart part = prt::load_scene_part(path, {index, count});
            ASSERT_TRUE(part.bounces && part.scene.bounces);
            EXPECT_EQ(part.bounces->first, first);
            EXPECT_EQ(*part.scene.bounces, rows_of(scene().matrix, {index, count}, first));
            for (std::size_t row = 0; row < scene().matrix.num_rows(); ++row)
                EXPECT_EQ(part.bounces->num_emitters[row], scene().matrix.emitters[row].size());
        }
    std::filesystem::remove(path);
}

} // namespace
} // namespace relumine::relight
