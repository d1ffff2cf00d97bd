#include "relumine/part_work.h"

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "prt/clusters/dealt_tiles.h"
#include "prt/parts/shared_work.h"
#include "prt/parts/team_checkpoint.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/probe_lights.h"

namespace relumine {

prt::BounceSamples bounce_samples(const mesh::TriangleMesh& mesh, const prt::Receivers& receivers,
                                  prt::Transfer& transfer, const prt::RayScene& rays,
                                  const prt::BounceOptions& options,
                                  const prt::PlannedBounces* plan) {
    // The part's receivers by themselves.
    const std::vector<std::uint32_t> places =
        prt::places_of(options.reduction->part(), transfer.num_receivers());
    prt::Transfer own{.quadtree = transfer.quadtree, .order = {}, .normals = {}, .counts = {}};
    own.counts = std::move(transfer.counts);
    for (const std::uint32_t place : places) {
        own.order.push_back(static_cast<std::uint32_t>(own.order.size()));
        own.normals.push_back(transfer.normals[place]);
    }
    std::vector<prt::ProbeRadiance> own_probes;
    if (!places.empty())
        own_probes = relight::probe_radiance(own);
    transfer.counts = std::move(own.counts);

    std::vector<float> open_parts;
    open_parts.reserve(own_probes.size());
    for (const prt::ProbeRadiance& probe : own_probes)
        open_parts.push_back(probe[0]);
    if (plan != nullptr) {
        const std::vector<std::uint32_t> index = prt::sampled_receivers(transfer);
        return prt::sample_bounces(
            mesh, receivers, transfer,
            {.open_parts = open_parts, .values = plan->probes, .index = index}, rays, options);
    }
    std::vector<prt::ProbeRadiance> probes(transfer.num_receivers());
    for (std::size_t i = 0; i < places.size(); ++i)
        probes[places[i]] = own_probes[i];
    prt::share_by_place(*options.reduction, std::span(probes));
    return prt::sample_bounces(mesh, receivers, transfer,
                               {.open_parts = open_parts, .values = probes, .index = {}}, rays,
                               options);
}

void assist(prt::Team& team, const std::stop_token& stop) {
    prt::SharedWork shared = prt::unpacked_work(team.broadcast({}));
    const ProcessWork work(&team);
    const mesh::TriangleMesh& blocking = shared.blockers ? *shared.blockers : shared.mesh;
    const prt::RayScene rays(blocking);
    std::optional<prt::BeamScene> beams;
    if (shared.has_beams)
        beams.emplace(blocking, rays);
    prt::TeamCheckpoint checkpoint(team, nullptr);
    shared.clusters.checkpoint = shared.has_checkpoint ? &checkpoint : nullptr;
    shared.clusters.reduction = &team;
    shared.clusters.stop = stop;
    prt::PrecomputeStatistics statistics;
    prt::Transfer transfer =
        prt::precompute(shared.receivers, beams ? static_cast<const prt::Blockers&>(*beams) : rays,
                        shared.clusters, &statistics);
    beams.reset();
    prt::PartLight light;
    if (shared.highlights) {
        shared.highlights->checkpoint = shared.clusters.checkpoint;
        shared.highlights->reduction = &team;
        shared.highlights->stop = stop;
        light.glossy =
            prt::part_highlights(shared.receivers, transfer, rays, *shared.highlights, team.part());
    }
    if (shared.bounces) {
        std::optional<prt::RayScene> of_mesh;
        if (shared.blockers)
            of_mesh.emplace(shared.mesh);
        shared.bounces->checkpoint = shared.clusters.checkpoint;
        shared.bounces->reduction = &team;
        shared.bounces->stop = stop;
        light.bounces = bounce_samples(shared.mesh, shared.receivers, transfer,
                                       of_mesh ? *of_mesh : rays, *shared.bounces);
    }
    light.counts = std::move(transfer.counts);
    const ProcessFigures figures = work.figures(statistics);
    static_cast<void>(prt::gather_light(team, std::move(light)));
    static_cast<void>(team.gather(prt::to_send(std::span(&figures, 1))));
}

void precompute_part(const PartOptions& options, prt::PrecomputeStatistics* statistics) {
    prt::Plan plan = prt::load_plan(options.plan);
    const prt::Scene& scene = plan.scene;
    const mesh::TriangleMesh& triangles = scene.blockers ? *scene.blockers : scene.mesh;
    const prt::RayScene rays(triangles);
    std::optional<prt::BeamScene> beams;
    if (options.engine == Engine::Beams)
        beams.emplace(triangles, rays);
    const prt::Blockers& blockers = beams ? static_cast<const prt::Blockers&>(*beams) : rays;
    prt::VisibleCounts counts = prt::part_counts(scene.receivers, scene.transfer, blockers,
                                                 {.min_level = scene.settings.min_level,
                                                  .face_resolution = scene.settings.face_resolution,
                                                  .bias = scene.settings.bias,
                                                  .stop = options.stop,
                                                  .on_progress = options.on_progress},
                                                 options.part, statistics);
    beams.reset();
    prt::PartLight light;
    if (scene.settings.glossy_tolerance) {
        plan.scene.transfer.counts = std::move(counts);
        light.glossy = prt::part_highlights(scene.receivers, plan.scene.transfer, rays,
                                            {.tolerance = *scene.settings.glossy_tolerance,
                                             .face_resolution = scene.settings.face_resolution,
                                             .bias = scene.settings.bias,
                                             .stop = options.stop},
                                            options.part);
        counts = std::exchange(plan.scene.transfer.counts, {});
    }
    if (plan.bounces) {
        std::optional<prt::RayScene> of_mesh;
        if (scene.blockers)
            of_mesh.emplace(scene.mesh);
        prt::Alone alone(options.part);
        plan.scene.transfer.counts = std::move(counts);
        light.bounces = bounce_samples(scene.mesh, scene.receivers, plan.scene.transfer,
                                       of_mesh ? *of_mesh : rays,
                                       {.tolerance = plan.bounces->tolerance,
                                        .two_sided = scene.settings.two_sided_bounces,
                                        .bias = scene.settings.bias,
                                        .reduction = &alone,
                                        .is_planned = true,
                                        .stop = options.stop},
                                       &*plan.bounces);
        counts = std::exchange(plan.scene.transfer.counts, {});
    }
    light.counts = std::move(counts);
    prt::save_part(options.output, plan, options.part, light);
}

std::uint64_t join(std::span<const std::filesystem::path> parts,
                   const std::filesystem::path& output) {
    return prt::save_scene(output, prt::join_parts(parts));
}

} // namespace relumine
