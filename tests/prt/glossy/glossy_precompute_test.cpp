#include "prt/glossy/glossy_precompute.h"

#include <cmath>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/precompute.h"
#include "prt/transfer/cell_index.h"
#include "tests/prt/analytic_blockers.h"
#include "tests/prt/memory_checkpoint.h"
#include "tests/prt/scenes.h"
#include "tests/relight/glossy_scene.h"

namespace relumine::prt {
namespace {

constexpr std::uint32_t FaceResolution = 128;

/// Sixteen receivers in one place that look up, each with another eye.
Receivers fan(const Surface& surface) {
    Receivers receivers;
    for (int i = 0; i < 16; ++i) {
        const double angle = 0.09 * i; // up to 77 degrees from the normal
        receivers.positions.emplace_back(0.001f * static_cast<float>(i), 0.0f, 0.0f);
        receivers.normals.emplace_back(0.0f, 1.0f, 0.0f);
        receivers.to_eye.emplace_back(std::sin(angle), std::cos(angle), 0.0);
        receivers.surfaces.push_back(surface);
    }
    return receivers;
}

Transfer with_glossy(const Receivers& receivers, const Blockers& blockers, float tolerance,
                     GlossyStatistics* statistics = nullptr) {
    Transfer transfer =
        precompute(receivers, blockers, {.tolerance = 0.01f, .face_resolution = FaceResolution});
    transfer.glossy = precompute_glossy(receivers, blockers, transfer,
                                        {.tolerance = tolerance, .face_resolution = FaceResolution},
                                        {}, statistics);
    return transfer;
}

/// Visits the cells of a block's cut: index of the cell and the transfer of each receiver.
template<typename Visit>
void for_cells(const LobeCuts& cuts, std::size_t block, const Visit& visit) {
    for (std::size_t entry = cuts.begin[block]; entry < cuts.begin[block + 1]; ++entry) {
        std::array<double, BlockSize> transfer{};
        for (std::size_t i = 0; i < BlockSize; ++i) {
            const double root = cuts.values[entry * BlockSize + i];
            transfer[i] = root * root * static_cast<double>(cuts.scales[entry]);
        }
        visit(cuts.cells[entry], transfer);
    }
}

float value_of(const Lobes<float>& lobes, GlossyLobe lobe) {
    return lobe == GlossyLobe::Specular          ? lobes.specular
           : lobe == GlossyLobe::SpecularGrazing ? lobes.specular_grazing
                                                 : lobes.diffuse_grazing;
}

/// What a cut is held to: relative L2 distance of its transfer from the lobe times visibility, over
/// the texels of a cube map, and the difference of their integrals, worst of the receivers.
struct CutErrors {
    double l2 = 0.0;
    double integral = 0.0;
    double mean_integral = 0.0;
};

CutErrors errors_of(const Receivers& receivers, const Transfer& transfer, const Blockers& blockers,
                    GlossyLobe lobe) {
    const std::size_t num_places = transfer.num_receivers();
    // Transfer of each texel: that of the cell of the cut that holds it.
    std::map<std::uint32_t, std::array<double, BlockSize>> cut;
    for_cells(transfer.glossy->lobes[static_cast<std::size_t>(lobe)], 0,
              [&](std::uint32_t cell, const std::array<double, BlockSize>& t) { cut[cell] = t; });
    std::vector<double> squares(num_places), differences(num_places), sums(num_places),
        cut_sums(num_places);
    double reference = 0.0;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < FaceResolution; ++y)
            for (std::uint32_t x = 0; x < FaceResolution; ++x) {
                const double r = FaceResolution;
                const glm::vec3 w = cubemap::direction(face, (x + 0.5) / r, (y + 0.5) / r);
                const double dw = cubemap::solid_angle(x / r, y / r, (x + 1) / r, (y + 1) / r);
                const std::array<double, BlockSize>* found = nullptr;
                for (std::uint8_t level = 0; level <= 7 && found == nullptr; ++level) {
                    const auto it =
                        cut.find(cell_index({face, level, x >> (7u - level), y >> (7u - level)}));
                    found = it == cut.end() ? nullptr : &it->second;
                }
                DirectionPacket packet;
                packet.num_directions = 1;
                packet.set(0, w);
                for (std::size_t place = 0; place < num_places; ++place) {
                    const std::uint32_t i = transfer.order[place];
                    const double nothing_blocked =
                        value_of(evaluate_lobes(receivers.surfaces[i], receivers.normals[i],
                                                receivers.to_eye[i], w),
                                 lobe);
                    const double t = blockers.occluded(receivers.positions[i], packet, 1) != 0
                                         ? 0.0
                                         : nothing_blocked;
                    const double of_cut = found == nullptr ? 0.0 : (*found)[place];
                    reference += dw * nothing_blocked * nothing_blocked;
                    differences[place] += dw * (t - of_cut) * (t - of_cut);
                    sums[place] += dw * t;
                    cut_sums[place] += dw * of_cut;
                }
            }
    CutErrors errors;
    errors.l2 = std::sqrt(std::accumulate(differences.begin(), differences.end(), 0.0) / reference);
    errors.mean_integral =
        std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(num_places);
    for (std::size_t place = 0; place < num_places; ++place)
        errors.integral = std::max(errors.integral, std::abs(cut_sums[place] - sums[place]));
    return errors;
}

TEST(GlossyPrecompute, CutsKeepTheToleranceWithNothingInTheWay) {
    const scenes::AnalyticBlockers nothing = scenes::no_blockers();
    for (const Surface& surface :
         {Surface{.highlight = Highlight::Ggx, .roughness_or_exponent = 0.2f},
          Surface{.highlight = Highlight::Ggx, .roughness_or_exponent = 0.5f},
          Surface{.highlight = Highlight::Ggx, .roughness_or_exponent = 1.0f},
          Surface{.highlight = Highlight::BlinnPhong, .roughness_or_exponent = 60.0f}})
        for (const float tolerance : {0.1f, 0.03f}) {
            SCOPED_TRACE(testing::Message() << "shape " << surface.roughness_or_exponent
                                            << " tolerance " << tolerance);
            const Receivers receivers = fan(surface);
            const Transfer transfer = with_glossy(receivers, nothing, tolerance);
            const CutErrors errors = errors_of(receivers, transfer, nothing, GlossyLobe::Specular);
            // The error is estimated from nine samples of each cell.
            EXPECT_LT(errors.l2, 1.3 * tolerance);
            EXPECT_LT(errors.integral, 0.5 * tolerance * errors.mean_integral);
            if (surface.highlight != Highlight::Ggx)
                continue;
            // What counts is their part of the whole lobe, whose integral is 1 for D.
            EXPECT_LT(errors_of(receivers, transfer, nothing, GlossyLobe::SpecularGrazing).integral,
                      0.5 * tolerance * errors.mean_integral);
            EXPECT_LT(errors_of(receivers, transfer, nothing, GlossyLobe::DiffuseGrazing).integral,
                      0.5 * tolerance);
        }
}

TEST(GlossyPrecompute, CutsFollowShadows) {
    const Receivers receivers = fan({.highlight = Highlight::Ggx, .roughness_or_exponent = 0.4f});
    for (const scenes::AnalyticBlockers& blockers :
         {scenes::half_plane_blocker(1.0, -0.4), scenes::sphere_blocker({-0.8, 1.2, 0.1}, 0.4)}) {
        const Transfer transfer = with_glossy(receivers, blockers, 0.05f);
        const CutErrors errors = errors_of(receivers, transfer, blockers, GlossyLobe::Specular);
        EXPECT_LT(errors.l2, 0.1);
        EXPECT_LT(errors.integral, 0.05 * errors.mean_integral);
    }
}

TEST(GlossyPrecompute, SharperHighlightsTakeFinerCellsNotMore) {
    const scenes::AnalyticBlockers nothing = scenes::no_blockers();
    GlossyStatistics sharp;
    GlossyStatistics broad;
    const Transfer a = with_glossy(
        fan({.highlight = Highlight::Ggx, .roughness_or_exponent = 0.25f}), nothing, 0.05f, &sharp);
    const Transfer b = with_glossy(
        fan({.highlight = Highlight::Ggx, .roughness_or_exponent = 0.8f}), nothing, 0.05f, &broad);
    EXPECT_GT(a.glossy->deepest_level(), b.glossy->deepest_level());
    EXPECT_LT(sharp.num_entries, 6 * broad.num_entries);
}

TEST(GlossyPrecompute, LambertHasNoCells) {
    GlossyStatistics statistics;
    const Transfer transfer = with_glossy(fan({}), scenes::no_blockers(), 0.05f, &statistics);
    EXPECT_EQ(statistics.num_entries, 0u);
    EXPECT_EQ(statistics.num_rays, 0u);
    EXPECT_EQ(transfer.glossy->deepest_level(), 0u);
}

TEST(GlossyPrecompute, TheSameBitsForAnyNumberOfThreads) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    for (const std::size_t threads : {1u, 3u}) {
        const files::ThreadLimit control(threads);
        const GlossyTransfer again =
            precompute_glossy(scene.receivers, scene.diffuse.rays, scene.transfer, scene.options);
        for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
            EXPECT_EQ(again.lobes[lobe].begin, scene.transfer.glossy->lobes[lobe].begin);
            EXPECT_EQ(again.lobes[lobe].cells, scene.transfer.glossy->lobes[lobe].cells);
            EXPECT_EQ(again.lobes[lobe].scales, scene.transfer.glossy->lobes[lobe].scales);
            EXPECT_EQ(again.lobes[lobe].values, scene.transfer.glossy->lobes[lobe].values);
        }
    }
}

TEST(GlossyPrecompute, GoesOnFromEveryCheckpoint) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    GlossyStatistics plain;
    static_cast<void>(precompute_glossy(scene.receivers, scene.diffuse.rays, scene.transfer,
                                        scene.options, {}, &plain));
    for (const std::size_t saves : {0u, 1u, 2u, 3u}) {
        MemoryCheckpoint checkpoint;
        checkpoint.saves_to_live = saves;
        EXPECT_THROW(static_cast<void>(precompute_glossy(
                         scene.receivers, scene.diffuse.rays, scene.transfer, scene.options,
                         {.checkpoint = &checkpoint, .step_size = 5})),
                     Killed);
        checkpoint.saves_to_live = static_cast<std::size_t>(-1);
        GlossyStatistics statistics;
        const GlossyTransfer again =
            precompute_glossy(scene.receivers, scene.diffuse.rays, scene.transfer, scene.options,
                              {.checkpoint = &checkpoint}, &statistics);
        EXPECT_EQ(statistics.num_rays, plain.num_rays);
        for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
            EXPECT_EQ(again.lobes[lobe].begin, scene.transfer.glossy->lobes[lobe].begin);
            EXPECT_EQ(again.lobes[lobe].cells, scene.transfer.glossy->lobes[lobe].cells);
            EXPECT_EQ(again.lobes[lobe].scales, scene.transfer.glossy->lobes[lobe].scales);
            EXPECT_EQ(again.lobes[lobe].values, scene.transfer.glossy->lobes[lobe].values);
        }
    }
}

TEST(GlossyPrecompute, CellsOfABlockNeverOverlap) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    for (const LobeCuts& cuts : scene.transfer.glossy->lobes)
        for (std::size_t block = 0; block + 1 < cuts.begin.size(); ++block) {
            std::uint64_t end = 0;
            for (std::size_t entry = cuts.begin[block]; entry < cuts.begin[block + 1]; ++entry) {
                const std::uint32_t level = level_of_index(cuts.cells[entry]);
                const std::uint64_t first =
                    std::uint64_t{cuts.cells[entry] - num_cells_above(level)}
                    << 2 * (MaxLevel - level);
                EXPECT_GE(first, end);
                end = first + (std::uint64_t{1} << 2 * (MaxLevel - level));
            }
        }
}

TEST(GlossyPrecompute, StopsWhenAsked) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    std::stop_source stop;
    const Work work{.stop = stop.get_token(), .on_progress = [&](double) {
                        stop.request_stop();
                    }};
    EXPECT_THROW(static_cast<void>(precompute_glossy(scene.receivers, scene.diffuse.rays,
                                                     scene.transfer, scene.options, work)),
                 Cancelled);
}

TEST(GlossyPrecompute, StopsAtItsLimitAndLeavesACheckpoint) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    std::uint64_t num_entries = 0;
    for (const LobeCuts& cuts : scene.transfer.glossy->lobes)
        num_entries += cuts.num_entries();
    GlossyOptions options = scene.options;
    options.max_bytes = num_entries * BytesPerEntry;
    Work work{.step_size = 5};
    const auto run = [&] {
        return precompute_glossy(scene.receivers, scene.diffuse.rays, scene.transfer, options,
                                 work);
    };
    EXPECT_NO_THROW(static_cast<void>(run()));
    MemoryCheckpoint checkpoint;
    work.checkpoint = &checkpoint;
    options.max_bytes = num_entries * BytesPerEntry / 2;
    EXPECT_THROW(static_cast<void>(run()), TooLarge);
    EXPECT_THROW(static_cast<void>(run()), TooLarge); // and does not forget
    options.max_bytes *= 3;
    EXPECT_EQ(run().lobes[0].values, scene.transfer.glossy->lobes[0].values);
}

TEST(GlossyPrecompute, ATrialForetellsTheEntries) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    std::uint64_t num_entries = 0;
    for (const LobeCuts& cuts : scene.transfer.glossy->lobes)
        num_entries += cuts.num_entries();
    const std::uint64_t estimate =
        estimate_glossy_entries(scene.receivers, scene.diffuse.rays, scene.transfer, scene.options);
    EXPECT_GT(10 * estimate, 9 * num_entries);
    EXPECT_LT(10 * estimate, 11 * num_entries);
}

TEST(GlossyPrecompute, WhatDoesNotFitIsRefused) {
    const scenes::GlossyScene& scene = scenes::glossy_scene();
    const auto refused = [&](const Receivers& receivers, const GlossyOptions& options) {
        EXPECT_THROW(static_cast<void>(
                         precompute_glossy(receivers, scene.diffuse.rays, scene.transfer, options)),
                     std::invalid_argument);
    };
    Receivers no_eye = scene.receivers;
    no_eye.to_eye.clear();
    refused(no_eye, scene.options);
    Receivers no_surfaces = scene.receivers;
    no_surfaces.surfaces.clear();
    refused(no_surfaces, scene.options);
    refused(scene.receivers, {.tolerance = 0.0f});
    refused(scene.receivers, {.tolerance = std::nanf("")});
    refused(scene.receivers, {.face_resolution = 0});
}

} // namespace
} // namespace relumine::prt
