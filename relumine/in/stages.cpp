#include "relumine/in/stages.h"

#include <chrono>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "prt/clusters/dealt_tiles.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute_context.h"
#include "prt/visibility/beam_scene.h"
#include "relight/probe_lights.h"

namespace relumine {

namespace {

/// Light under the probe lights, of the process's receivers by themselves.
std::vector<prt::ProbeRadiance> own_probes(prt::Transfer& transfer,
                                           std::span<const std::uint32_t> places) {
    if (places.empty())
        return {};
    prt::Transfer own{.quadtree = transfer.quadtree,
                      .order = {},
                      .normals = {},
                      .counts = std::exchange(transfer.counts, {})};
    for (const std::uint32_t place : places) {
        own.order.push_back(static_cast<std::uint32_t>(own.order.size()));
        own.normals.push_back(transfer.normals[place]);
    }
    std::vector<prt::ProbeRadiance> probes = relight::probe_radiance(own);
    transfer.counts = std::move(own.counts);
    return probes;
}

} // namespace

std::string megabytes(std::uint64_t bytes) {
    constexpr std::uint64_t Megabyte = 1u << 20u;
    return bytes < Megabyte ? fmt::format("{} bytes", bytes)
                            : fmt::format("{} MB", (bytes + Megabyte - 1) / Megabyte);
}

void warn(const PrecomputeWork& work, Warning kind, const std::string& message) {
    if (work.on_warning)
        work.on_warning(kind, message);
}

void note(const PrecomputeWork& work, const std::string& message) {
    if (work.on_note)
        work.on_note(message);
}

prt::RayScene ray_scene(const mesh::TriangleMesh& mesh, const std::string& prefix) {
    try {
        return prt::RayScene(mesh);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(prefix + error.what());
    }
}

prt::SceneSizes Stages::sizes() const {
    return {.num_vertices = scene_.mesh.num_vertices(),
            .num_triangles = scene_.mesh.num_triangles(),
            .num_receivers = scene_.receivers.size()};
}

MemoryLimitExceeded Stages::exceeded(MemoryLimitExceeded::Part part, const std::string& expected,
                                     const std::string& got) const {
    return {part, fmt::format("{}expected {}, got {}", options_.prefix, expected, got)};
}

std::string Stages::within_limit() const {
    return fmt::format("work within {}", megabytes(options_.max_memory.value_or(0)));
}

void Stages::check_scene() const {
    if (options_.max_memory && prt::scene_bytes(sizes()) > *options_.max_memory)
        throw exceeded(MemoryLimitExceeded::Part::Scene, within_limit(),
                       fmt::format("a scene that takes {} of memory alone",
                                   megabytes(prt::scene_bytes(sizes()))));
}

/// Bounds what the clusters may take and estimates what they will.
void Stages::limit_clusters(const prt::Blockers& blockers, prt::PrecomputeOptions& clusters) {
    if (!options_.max_memory)
        return;
    const std::uint64_t most = *options_.max_memory;
    check_scene(); // now with the receivers
    clusters.plane_bytes = prt::plane_bytes_within(sizes(), most);
    const prt::MemoryEstimate estimate =
        prt::estimate_memory(sizes(), scene_.receivers, blockers, clusters, most, work_.stop);
    if (estimate.is_at_least || estimate.peak_bytes > most)
        throw exceeded(MemoryLimitExceeded::Part::Clusters, within_limit(),
                       fmt::format("an estimate of {} {} of memory for {}{} clusters",
                                   estimate.is_at_least ? "more than" : "about",
                                   megabytes(estimate.peak_bytes),
                                   estimate.is_at_least ? "more than " : "",
                                   estimate.num_clusters));
    clusters.max_column_bytes = prt::max_column_bytes(sizes(), clusters.plane_bytes, most);
    report_.memory = estimate;
    note(work_, fmt::format("memory: about {} for about {} clusters",
                            megabytes(estimate.peak_bytes), estimate.num_clusters));
}

prt::PrecomputeOptions cluster_options(const prt::SceneSettings& settings) {
    return {.tolerance = settings.tolerance,
            .epsilon = settings.epsilon,
            .most_clusters = settings.most_clusters,
            .min_level = settings.min_level,
            .face_resolution = settings.face_resolution,
            .bias = settings.bias};
}

prt::Work Stages::work_for(Stage stage, bool more_follows) const {
    return {.team = work_.team,
            .checkpoint = options_.checkpoint,
            .more_follows = more_follows,
            .stop = work_.stop,
            .on_progress = work_.of(stage).on_progress};
}

/// Calls find(blockers, options, work).
template<typename Find>
void Stages::find_clusters(const prt::RayScene& rays, const Find& find) {
    std::optional<prt::BeamScene> beams;
    if (options_.blockers == nullptr)
        beams.emplace(scene_.blocking_mesh(), rays);
    const prt::Blockers& of_mesh = beams ? static_cast<const prt::Blockers&>(*beams) : rays;
    const prt::Blockers& blockers = options_.blockers != nullptr ? *options_.blockers : of_mesh;
    const bool more_follows = scene_.settings.glossy_tolerance || plan_.bounces;
    try {
        prt::PrecomputeOptions clusters = cluster_options(scene_.settings);
        limit_clusters(blockers, clusters);
        find(blockers, clusters, work_for(Stage::Clusters, more_follows));
        if (report_.clusters.grown_tolerance > 0.0f)
            scene_.settings.tolerance = report_.clusters.grown_tolerance;
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(options_.prefix + error.what());
    } catch (const prt::TooLarge& error) {
        throw exceeded(MemoryLimitExceeded::Part::ClustersFound, within_limit(),
                       fmt::format("at least {} clusters, which take more; stopped", error.count));
    }
}

void Stages::choose_clusters(const prt::RayScene& rays) {
    prt::Transfer sampled;
    find_clusters(rays, [&](const prt::Blockers& blockers, const prt::PrecomputeOptions& options,
                            const prt::Work& work) {
        scene_.transfer = prt::plan_clusters(scene_.receivers, blockers, options, work,
                                             &report_.clusters, &sampled);
    });
    plan_.has_clusters = true;
    if (!plan_.bounces)
        return;
    plan_.bounces->probes.resize(sampled.num_receivers());
    const std::vector<prt::ProbeRadiance> probes = relight::probe_radiance(sampled);
    for (std::size_t place = 0; place < probes.size(); ++place)
        plan_.bounces->probes[sampled.order[place]] = probes[place];
}

prt::PartLight Stages::run(const prt::RayScene& rays) {
    prt::Transfer& transfer = scene_.transfer;
    find_clusters(rays, [&](const prt::Blockers& blockers, const prt::PrecomputeOptions& options,
                            const prt::Work& work) {
        if (plan_.has_clusters)
            transfer.counts = prt::part_counts(scene_.receivers, transfer, blockers, options, work,
                                               &report_.clusters);
        else
            transfer = prt::precompute(scene_.receivers, blockers, options, work,
                                       {.given = transfer.order.empty() ? nullptr : &transfer},
                                       &report_.clusters);
    });
    if (scene_.settings.glossy_tolerance)
        add_highlights(rays);
    prt::PartLight light;
    if (plan_.bounces) {
        try {
            light.bounces = bounces(rays);
        } catch (const MemoryLimitExceeded& error) {
            if (!plan_.bounces->is_automatic)
                throw;
            note(work_, fmt::format("bounces are left out: {}", error.what()));
        }
    }
    light.counts = std::exchange(transfer.counts, {});
    light.glossy = std::exchange(transfer.glossy, {});
    return light;
}

void Stages::add_highlights(const prt::RayScene& rays) {
    prt::GlossyOptions glossy{.tolerance = *scene_.settings.glossy_tolerance,
                              .face_resolution = scene_.settings.face_resolution,
                              .bias = scene_.settings.bias};
    const prt::Work work = work_for(Stage::Highlights, plan_.bounces.has_value());
    const auto refuse = [&](const char* kind, std::uint64_t bytes) {
        return exceeded(MemoryLimitExceeded::Part::Highlights,
                        fmt::format("highlights within {} of memory", megabytes(glossy.max_bytes)),
                        fmt::format("{} {}", kind, megabytes(bytes)));
    };
    if (options_.max_memory) {
        glossy.max_bytes =
            prt::max_glossy_bytes(sizes(), report_.clusters.column_bytes, *options_.max_memory);
        report_.highlights_estimate =
            prt::estimate_glossy_entries(scene_.receivers, rays, scene_.transfer, glossy, work);
        const std::uint64_t bytes = *report_.highlights_estimate * prt::BytesPerEntry;
        if (bytes > glossy.max_bytes)
            throw refuse("an estimate of", bytes);
    }
    prt::GlossyStatistics statistics;
    try {
        scene_.transfer.glossy = prt::precompute_glossy(scene_.receivers, rays, scene_.transfer,
                                                        glossy, work, &statistics);
    } catch (const prt::TooLarge& error) {
        throw refuse("at least", error.bytes);
    }
    report_.highlights = statistics;
}

prt::BounceSamples Stages::bounces(const prt::RayScene& rays) {
    const auto start = std::chrono::steady_clock::now();
    std::optional<prt::RayScene> of_mesh;
    if (scene_.blockers)
        of_mesh.emplace(ray_scene(scene_.mesh, options_.prefix));
    prt::BounceOptions options{.tolerance = plan_.bounces->tolerance,
                               .is_kept = scene_.settings.is_movable,
                               .two_sided = scene_.settings.two_sided_bounces,
                               .bias = scene_.settings.bias};
    if (options_.max_memory)
        options.max_bytes =
            prt::max_bounce_bytes(sizes(), report_.clusters.column_bytes, *options_.max_memory);
    prt::Transfer& transfer = scene_.transfer;
    const std::vector<std::uint32_t> places =
        prt::places_of(work_.team.part(), transfer.num_receivers());
    const std::vector<prt::ProbeRadiance> own = own_probes(transfer, places);
    std::vector<float> open_parts;
    open_parts.reserve(own.size());
    for (const prt::ProbeRadiance& probe : own)
        open_parts.push_back(probe[0]);
    std::vector<prt::ProbeRadiance> of_all;
    std::vector<std::uint32_t> index;
    if (plan_.has_clusters) {
        index = prt::sampled_receivers(transfer);
    } else {
        of_all.resize(transfer.num_receivers());
        for (std::size_t i = 0; i < places.size(); ++i)
            of_all[places[i]] = own[i];
        prt::share_by_place(work_.team, std::span(of_all));
    }
    try {
        prt::BounceSamples samples = prt::sample_bounces(
            scene_.mesh, scene_.receivers, transfer,
            {.open_parts = open_parts,
             .values = plan_.has_clusters ? plan_.bounces->probes : of_all,
             .index = index},
            of_mesh ? *of_mesh : rays, options, work_for(Stage::Bounces, false));
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        report_.bounces.emplace().seconds = seconds.count();
        return samples;
    } catch (const prt::TooLarge& error) {
        throw exceeded(MemoryLimitExceeded::Part::Bounces,
                       fmt::format("bounces within {} of memory", megabytes(options.max_bytes)),
                       megabytes(error.bytes));
    }
}

} // namespace relumine
