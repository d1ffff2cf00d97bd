#include "relumine/precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "prt/parts/part_file.h"
#include "prt/parts/shared_work.h"
#include "prt/parts/team_checkpoint.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/scene/checkpoint_file.h"
#include "prt/scene/fingerprint.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/framing.h"
#include "relight/probe_lights.h"
#include "relumine/memory_limit.h"
#include "relumine/part_work.h"

namespace relumine {

namespace {

/// One precompute, step by step.
class Precompute {
public:
    Precompute(Mesh mesh, const PrecomputeOptions& options, PrecomputeReport& report)
        : options_(options), report_(report),
          prefix_(mesh.source.empty() ? "" : mesh.source + ": "),
          limit_(options.max_memory, prefix_) {
        scene_.settings.floor_vertices = mesh.floor_vertices;
        scene_.settings.floor_added = mesh.floor_added;
        scene_.blockers = std::move(mesh.blockers);
        scene_.settings.source = std::filesystem::path(mesh.source).filename().string();
        scene_.settings.source_hash = mesh.source_hash;
        scene_.mesh = std::move(mesh.geometry);
        clustering_ = {.tolerance = options.tolerance,
                       .epsilon = options.epsilon,
                       .min_level = options.min_level,
                       .face_resolution = options.face_resolution,
                       .bias = options.bias.value_or(prt::automatic_bias(scene_.mesh)),
                       .stop = options.stop,
                       .on_progress = progress(Stage::Clusters)};
    }

    /// Chooses the clusters and leaves the counts to the parts.
    void run_plan() {
        is_plan_ = true;
        check_options();
        compute();
        report_.file_bytes = prt::save_plan(options_.output, scene_, planned_bounces_);
    }

    Scene run() {
        check_options();
        try {
            compute();
            if (!options_.output.empty())
                report_.file_bytes = prt::save_scene(options_.output, scene_);
        } catch (...) {
            if (checkpoint_ && checkpoint_->exists())
                report_.checkpoint = prt::CheckpointFile::folder_for(options_.output);
            throw;
        }
        if (checkpoint_)
            checkpoint_->remove();
        return std::move(scene_);
    }

private:
    void check_options() const {
        if (options_.bounce_tolerance && !(*options_.bounce_tolerance > 0.0f))
            throw std::invalid_argument(fmt::format("expected a tolerance of bounces > 0, got {}",
                                                    *options_.bounce_tolerance));
        const char* const extension = is_plan_ ? ".plan" : ".prt";
        if (!options_.output.empty() && options_.output.extension() != extension)
            throw std::invalid_argument(fmt::format("{}: expected a name that ends in {}",
                                                    options_.output.string(), extension));
        if (options_.output.empty() && options_.resume)
            throw std::invalid_argument("expected an output to resume the work of, got none");
        if (options_.team != nullptr && options_.max_memory)
            throw std::invalid_argument(
                "expected no limit of memory where processes share the work");
        if (!(options_.checkpoint_seconds >= 0.0))
            throw std::invalid_argument(fmt::format("expected checkpoint seconds >= 0, got {}",
                                                    options_.checkpoint_seconds));
    }

    /// Both parts of the transfer. The rays and all they are made of go before the scene is
    /// written, which needs memory of its own.
    void compute() {
        report_.num_vertices = scene_.mesh.num_vertices();
        report_.num_triangles = scene_.mesh.num_triangles();
        report_.bias = clustering_.bias;
        prt::SceneSizes sizes{.num_vertices = report_.num_vertices,
                              .num_triangles = report_.num_triangles,
                              .has_beams = options_.engine == Engine::Beams};
        limit_.check_scene(sizes);
        const prt::RayScene rays = ray_scene(blocking_mesh());
        place_receivers(rays);
        require_few_clusters();
        sizes.num_receivers = report_.num_receivers = scene_.receivers.size();
        set_surfaces();
        poll();
        const bool has_highlights = prt::has_highlights(scene_.receivers);
        open_checkpoint(has_highlights);
        keep_settings();
        if (has_highlights)
            scene_.settings.glossy_tolerance = options_.glossy_tolerance;
        hand_out(has_highlights);
        const ProcessWork work(options_.team);
        try {
            cluster(rays, sizes);
        } catch (const std::invalid_argument& error) {
            throw std::invalid_argument(prefix_ + error.what());
        }
        if (has_highlights && !is_plan_)
            add_highlights(rays, sizes);
        if (options_.bounce_tolerance && !is_plan_)
            add_bounces(rays, sizes);
        if (options_.team != nullptr)
            take_in(work.figures(report_.clusters));
        prt::set_surfaces(scene_.transfer, scene_.receivers);
    }

    [[nodiscard]] const mesh::TriangleMesh& blocking_mesh() const {
        return scene_.blockers ? *scene_.blockers : scene_.mesh;
    }

    [[nodiscard]] prt::RayScene ray_scene(const mesh::TriangleMesh& mesh) const {
        try {
            return prt::RayScene(mesh);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(prefix_ + error.what());
        }
    }

    /// Refuses what would take hours. A limit of memory has an estimate of its own.
    void require_few_clusters() const {
        // An RMS below this allows no cluster that a few receivers see differently: cells stop at
        // single texels. The work that is let through takes minutes.
        constexpr double FinestTolerance = 1e-4; // 1/sr
        // A plan is made from a sample, and processes share the receivers.
        const double most_pairs = 0x1p32 * (is_plan_                   ? 16.0
                                            : options_.team != nullptr ? options_.team->part().count
                                                                       : 1.0);
        if (options_.max_memory)
            return;
        const auto num_receivers = static_cast<double>(scene_.receivers.size());
        const double tolerance = clustering_.epsilon
                                     ? double{*clustering_.epsilon} * std::sqrt(num_receivers)
                                     : double{clustering_.tolerance};
        const double all = 6.0 * clustering_.face_resolution * clustering_.face_resolution;
        const double least = std::min(all, 6.0 * std::exp2(2.0 * clustering_.min_level));
        const bool is_fine = tolerance < FinestTolerance;
        const double clusters = is_fine ? all : least;
        const double pairs = clusters * num_receivers;
        if (pairs <= most_pairs)
            return;
        // A block of 16 receivers that see a cluster differently takes ten bytes.
        throw TooMuchWork(
            is_fine && least * num_receivers <= most_pairs ? TooMuchWork::Cause::Tolerance
                                                           : TooMuchWork::Cause::MinLevel,
            fmt::format("expected {} for {} receivers and a face resolution of {}: up to {:.3g} "
                        "clusters, {:.2g} rays and {:.2g} GB; fewer receivers, a lower face "
                        "resolution or a limit of memory let it through",
                        is_fine && least * num_receivers <= most_pairs
                            ? fmt::format("{} or more", FinestTolerance)
                            : "a smaller depth",
                        scene_.receivers.size(), clustering_.face_resolution, clusters, 4.0 * pairs,
                        pairs * 10.0 / prt::BlockSize * 1e-9));
    }

    void place_receivers(const prt::RayScene& rays) {
        try {
            if (const auto* pixels = std::get_if<Pixels>(&options_.receivers)) {
                if (scene_.blockers)
                    place_pixels(*pixels, ray_scene(scene_.mesh));
                else
                    place_pixels(*pixels, rays);
            } else if (const auto* texels = std::get_if<Texels>(&options_.receivers)) {
                place_texels(*texels);
            } else {
                scene_.receivers = prt::vertex_receivers(scene_.mesh);
            }
            // Receivers that are no pixels of the view but seen from it.
            if (options_.view && !std::holds_alternative<Pixels>(options_.receivers)) {
                const std::optional<prt::Camera>& own = options_.view->camera;
                scene_.settings.view = own ? *own : relight::framed(scene_.mesh);
                prt::look_from(scene_.receivers, scene_.settings.view->eye);
            }
            if (options_.bounce_tolerance && !scene_.receivers.points.empty()) {
                prt::add_vertices(scene_.receivers, scene_.mesh);
                note(fmt::format("and {} vertices, from which light bounces",
                                 scene_.receivers.num_added));
            }
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(prefix_ + error.what());
        }
    }

    void place_pixels(const Pixels& size, const prt::RayScene& rays) {
        const bool has_camera = options_.view && options_.view->camera;
        const prt::Camera camera =
            has_camera ? *options_.view->camera
                       : relight::framed(scene_.mesh, {.aspect = static_cast<float>(size.width) /
                                                                 static_cast<float>(size.height)});
        prt::PixelReceivers pixels =
            prt::pixel_receivers(scene_.mesh, rays,
                                 {.camera = camera,
                                  .width = size.width,
                                  .height = size.height,
                                  .samples_per_axis = size.samples_per_axis});
        scene_.receivers = std::move(pixels.receivers);
        scene_.layout = std::move(pixels.layout);
        note(fmt::format("{}: {} samples hit the mesh", prt::description(scene_.layout),
                         scene_.receivers.size()));
    }

    void place_texels(const Texels& size) {
        prt::TexelReceivers texels =
            prt::texel_receivers(scene_.mesh, {.width = size.width, .height = size.height});
        const prt::AtlasReport& atlas = texels.report;
        if (atlas.num_overlapping > 0)
            warn(Warning::ChartsOverlap,
                 fmt::format("{} texels lie in several triangles, the first at column {}, row {}: "
                             "charts overlap, the first triangle of the mesh wins",
                             atlas.num_overlapping, atlas.first_overlap % size.width,
                             atlas.first_overlap / size.width));
        if (atlas.num_outside > 0)
            warn(Warning::UvsOutside,
                 fmt::format("{} triangles have uvs outside of 0 to 1: cut off there",
                             atlas.num_outside));
        if (atlas.num_flat > 0)
            note(fmt::format("{} triangles have no area in uv and get no texels", atlas.num_flat));
        report_.atlas = atlas;
        scene_.receivers = std::move(texels.receivers);
        scene_.layout = std::move(texels.layout);
    }

    /// The mesh's materials, changed by the option; none where there are neither. The floor keeps
    /// its own.
    void set_surfaces() {
        const mesh::TriangleMesh& mesh = scene_.mesh;
        if (mesh.materials.empty() && !options_.surface && options_.floor_surface == prt::Surface())
            return;
        const std::size_t n = scene_.settings.floor_vertices;
        const std::size_t first_of_floor =
            mesh.num_vertices() - n * n - scene_.settings.floor_added;
        const prt::SurfaceOverride surface_of =
            [&](const mesh::TriangleMesh& of, std::uint32_t triangle, const prt::Surface& own) {
                if (n != 0 && of.triangles[triangle][0] >= first_of_floor)
                    return options_.floor_surface;
                return options_.surface ? options_.surface(of, triangle, own) : own;
            };
        prt::Receivers& receivers = scene_.receivers;
        if (receivers.points.empty()) {
            receivers.surfaces = prt::vertex_surfaces(mesh, surface_of);
            prepare_textures();
        } else {
            receivers.surfaces.clear();
            for (const prt::MeshPoint& point : receivers.points)
                receivers.surfaces.push_back(
                    surface_of(mesh, point.triangle,
                               prt::surface_at(mesh, point.triangle, point.barycentric)));
        }
        if (receivers.to_eye.empty())
            leave_highlights_out();
        // Vertices that only send light on are seen by nobody.
        for (std::size_t i = receivers.num_own(); i < receivers.size(); ++i)
            receivers.surfaces[i].highlight = prt::Highlight::None;
    }

    /// Pictures take the light of the vertices and the colours of the textures. So the option's
    /// surfaces lose their textures, and black vertices keep a trace by which their light is known:
    /// the lowest value that an image of 8 bits has.
    void prepare_textures() {
        mesh::TriangleMesh& mesh = scene_.mesh;
        if (mesh.textures.empty() || mesh.triangle_materials.empty())
            return;
        if (options_.surface) {
            const auto plain = static_cast<std::uint32_t>(mesh.materials.size());
            mesh.materials.push_back({.name = "option"});
            for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i) {
                const prt::Surface own = prt::surface_at(mesh, i, glm::vec2(1.0f / 3.0f));
                if (options_.surface(mesh, i, own) != own)
                    mesh.triangle_materials[i] = plain;
            }
        }
        constexpr float LeastAlbedo = 1.0f / 255.0f / 12.92f;
        for (prt::Surface& surface : scene_.receivers.surfaces)
            surface.albedo = glm::max(surface.albedo, LeastAlbedo);
    }

    void leave_highlights_out() {
        for (prt::Surface& surface : scene_.receivers.surfaces) {
            report_.num_highlights_left_out += surface.highlight != prt::Highlight::None ? 1 : 0;
            surface = prt::without_highlight(surface);
        }
        if (report_.num_highlights_left_out != 0)
            warn(Warning::HighlightsWithoutView,
                 fmt::format("{} receivers have highlights, which need a view: left out, the scene "
                             "is diffuse",
                             report_.num_highlights_left_out));
    }

    void open_checkpoint(bool has_highlights) {
        const bool is_wanted = !is_plan_ && (options_.checkpoint_seconds > 0.0 || options_.resume);
        if (options_.output.empty() || !is_wanted)
            return;
        constexpr double Never = 1e9;
        // A disk that stays full need not be told of every twenty seconds.
        const auto warn_once = [this, last = std::string()](const std::string& message) mutable {
            if (std::exchange(last, message) != message)
                warn(Warning::Checkpoint, message);
        };
        prt::Fingerprint fingerprint = prt::fingerprint(
            blocking_mesh(), scene_.receivers, clustering_,
            {.glossy_tolerance =
                 has_highlights ? std::optional(options_.glossy_tolerance) : std::nullopt,
             .bounce_tolerance = options_.bounce_tolerance,
             .two_sided_bounces = options_.two_sided_bounces});
        fingerprint.emplace_back(
            "number of processes",
            fmt::format("{}", options_.team != nullptr ? options_.team->part().count : 1));
        checkpoint_ = std::make_unique<prt::CheckpointFile>(
            options_.output, std::move(fingerprint),
            prt::CheckpointFile::Options{
                .resume = options_.resume,
                .interval = std::chrono::duration<double>(
                    options_.checkpoint_seconds > 0.0 ? options_.checkpoint_seconds : Never),
                .on_problem = warn_once});
        clustering_.checkpoint = checkpoint_.get();
        if (options_.team != nullptr)
            clustering_.checkpoint = &team_checkpoint_.emplace(*options_.team, checkpoint_.get());
        if (checkpoint_->exists())
            note(fmt::format("going on from {}",
                             prt::CheckpointFile::folder_for(options_.output).string()));
    }

    /// Tells the other processes what there is to do.
    void hand_out(bool has_highlights) {
        if (options_.team == nullptr)
            return;
        clustering_.reduction = options_.team;
        prt::SharedWork work{.receivers = scene_.receivers,
                             .clusters = clustering_,
                             .has_beams = options_.engine == Engine::Beams,
                             .has_checkpoint = clustering_.checkpoint != nullptr};
        const auto shape_of = [](const mesh::TriangleMesh& mesh) {
            mesh::TriangleMesh shape;
            shape.positions = mesh.positions;
            shape.triangles = mesh.triangles;
            return shape;
        };
        if (options_.bounce_tolerance) {
            work.bounces = {.tolerance = *options_.bounce_tolerance,
                            .two_sided = options_.two_sided_bounces};
            work.mesh = shape_of(scene_.mesh);
            work.mesh.normals = scene_.mesh.normals;
            if (scene_.blockers)
                work.blockers = shape_of(*scene_.blockers);
        } else {
            work.mesh = shape_of(blocking_mesh());
            work.receivers.points.clear();
        }
        if (has_highlights)
            work.highlights = {.tolerance = options_.glossy_tolerance};
        static_cast<void>(options_.team->broadcast(prt::packed_work(work)));
    }

    /// Joins the light of all processes.
    void take_in(const ProcessFigures& own_figures) {
        prt::Transfer& transfer = scene_.transfer;
        report_.processes = {own_figures};
        std::vector<prt::PartLight> light =
            prt::gather_light(*options_.team, {.counts = std::exchange(transfer.counts, {}),
                                               .glossy = std::exchange(transfer.glossy, {}),
                                               .bounces = std::exchange(own_bounces_, {})});
        for (const std::vector<std::byte>& bytes : options_.team->gather({}))
            if (!bytes.empty())
                std::memcpy(&report_.processes.emplace_back(), bytes.data(),
                            sizeof(ProcessFigures));
        prt::join_light(transfer, light);
        if (!options_.bounce_tolerance)
            return;
        scene_.bounces =
            prt::join_bounces_of(scene_.receivers, transfer, light, &report_.bounces.emplace());
        report_.bounces->seconds = seconds_bounces_;
    }

    /// What the scene remembers of how it was made.
    void keep_settings() {
        prt::SceneSettings& settings = scene_.settings;
        settings.tolerance = clustering_.tolerance;
        settings.epsilon = clustering_.epsilon;
        settings.min_level = clustering_.min_level;
        settings.face_resolution = clustering_.face_resolution;
        settings.bias = clustering_.bias;
    }

    void cluster(const prt::RayScene& rays, const prt::SceneSizes& sizes) {
        std::optional<prt::BeamScene> beams;
        if (options_.engine == Engine::Beams)
            beams.emplace(blocking_mesh(), rays);
        const prt::Blockers& blockers = beams ? static_cast<const prt::Blockers&>(*beams) : rays;
        report_.memory = limit_.check_estimate(sizes, scene_.receivers, blockers, clustering_);
        if (report_.memory)
            note(fmt::format("memory: about {} for about {} clusters",
                             megabytes(report_.memory->peak_bytes), report_.memory->num_clusters));
        try {
            if (is_plan_)
                plan(blockers);
            else
                scene_.transfer =
                    prt::precompute(scene_.receivers, blockers, clustering_, &report_.clusters);
        } catch (const prt::TooManyClusters& error) {
            throw limit_.stopped(error);
        }
    }

    void plan(const prt::Blockers& blockers) {
        prt::Transfer sampled;
        scene_.transfer = prt::plan_clusters(scene_.receivers, blockers, clustering_,
                                             &report_.clusters, &sampled);
        if (!options_.bounce_tolerance)
            return;
        scene_.settings.two_sided_bounces = options_.two_sided_bounces;
        prt::PlannedBounces& bounces = planned_bounces_.emplace();
        bounces.tolerance = *options_.bounce_tolerance;
        bounces.probes.resize(sampled.num_receivers());
        const std::vector<prt::ProbeRadiance> probes = relight::probe_radiance(sampled);
        for (std::size_t place = 0; place < probes.size(); ++place)
            bounces.probes[sampled.order[place]] = probes[place];
    }

    void add_highlights(const prt::RayScene& rays, const prt::SceneSizes& sizes) {
        const float narrowest = prt::narrowest_roughness(options_.face_resolution);
        const std::vector<prt::Surface>& surfaces = scene_.receivers.surfaces;
        report_.num_too_smooth = static_cast<std::size_t>(
            std::count_if(surfaces.begin(), surfaces.end(), [&](const prt::Surface& surface) {
                return prt::facts_of(surface.highlight).is_roughness &&
                       surface.roughness_or_exponent < narrowest;
            }));
        if (report_.num_too_smooth != 0)
            warn(Warning::TooSmooth,
                 fmt::format("{} receivers are smoother than roughness {:.3f}: cells of the "
                             "quadtree cannot hold so sharp a highlight, it comes out wider",
                             report_.num_too_smooth, narrowest));
        prt::GlossyOptions glossy{.tolerance = options_.glossy_tolerance,
                                  .face_resolution = options_.face_resolution,
                                  .bias = clustering_.bias,
                                  .reduction = options_.team,
                                  .checkpoint = clustering_.checkpoint,
                                  .stop = options_.stop,
                                  .on_progress = progress(Stage::Highlights)};
        const std::optional<std::uint64_t> max_bytes =
            limit_.max_glossy_bytes(sizes, report_.clusters.column_bytes);
        if (max_bytes) {
            const std::uint64_t estimate =
                prt::estimate_glossy_entries(scene_.receivers, rays, scene_.transfer, glossy);
            if (estimate * prt::BytesPerEntry > *max_bytes)
                throw limit_.too_many_highlights(*max_bytes, "an estimate of", estimate);
            report_.highlights_estimate = estimate;
            glossy.max_bytes = *max_bytes;
        }
        prt::GlossyStatistics statistics;
        try {
            scene_.transfer.glossy =
                options_.team != nullptr
                    ? prt::part_highlights(scene_.receivers, scene_.transfer, rays, glossy,
                                           options_.team->part(), &statistics)
                    : prt::precompute_glossy(scene_.receivers, rays, scene_.transfer, glossy,
                                             &statistics);
        } catch (const prt::TooManyEntries& error) {
            throw limit_.too_many_highlights(glossy.max_bytes, "at least", error.num_entries);
        }
        report_.highlights = statistics;
    }

    void add_bounces(const prt::RayScene& rays, const prt::SceneSizes& sizes) {
        std::optional<prt::RayScene> of_mesh;
        if (scene_.blockers)
            of_mesh.emplace(ray_scene(scene_.mesh));
        prt::BounceOptions bounces{.tolerance = *options_.bounce_tolerance,
                                   .two_sided = options_.two_sided_bounces,
                                   .bias = clustering_.bias,
                                   .reduction = options_.team,
                                   .checkpoint = clustering_.checkpoint,
                                   .stop = options_.stop,
                                   .on_progress = progress(Stage::Bounces)};
        if (const auto bytes = limit_.max_bounce_bytes(sizes, report_.clusters.column_bytes))
            bounces.max_bytes = *bytes;
        scene_.settings.two_sided_bounces = options_.two_sided_bounces;
        if (options_.team != nullptr) {
            const auto start = std::chrono::steady_clock::now();
            own_bounces_ = bounce_samples(scene_.mesh, scene_.receivers, scene_.transfer,
                                          of_mesh ? *of_mesh : rays, bounces);
            seconds_bounces_ =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            return;
        }
        prt::set_surfaces(scene_.transfer, scene_.receivers);
        prt::BounceStatistics statistics;
        try {
            scene_.bounces =
                prt::precompute_bounces(scene_.mesh, scene_.receivers, scene_.transfer,
                                        relight::probe_radiance(scene_.transfer),
                                        of_mesh ? *of_mesh : rays, bounces, &statistics);
        } catch (const prt::TooManyHits& error) {
            throw limit_.too_many_hits(bounces.max_bytes, error.num_hits);
        }
        report_.bounces = statistics;
    }

    [[nodiscard]] std::function<void(double)> progress(Stage stage) const {
        if (!options_.on_progress)
            return {};
        return [this, stage](double fraction) {
            options_.on_progress(stage, fraction);
        };
    }
    void poll() const {
        if (options_.stop.stop_requested())
            throw Cancelled();
    }
    void warn(Warning kind, const std::string& message) const {
        if (options_.on_warning)
            options_.on_warning(kind, message);
    }
    void note(const std::string& message) const {
        if (options_.on_note)
            options_.on_note(message);
    }

    const PrecomputeOptions& options_;
    bool is_plan_ = false;
    PrecomputeReport& report_;
    std::string prefix_;
    MemoryLimit limit_;
    Scene scene_;
    prt::PrecomputeOptions clustering_;
    std::unique_ptr<prt::CheckpointFile> checkpoint_;
    std::optional<prt::TeamCheckpoint> team_checkpoint_;
    /// Of this process, where others have theirs.
    std::optional<prt::BounceSamples> own_bounces_;
    double seconds_bounces_ = 0.0;
    std::optional<prt::PlannedBounces> planned_bounces_;
};

} // namespace

Scene precompute(Mesh mesh, const PrecomputeOptions& options, PrecomputeReport* report) {
    PrecomputeReport local;
    PrecomputeReport& facts = report != nullptr ? *report : local;
    facts = {};
    return Precompute(std::move(mesh), options, facts).run();
}

void plan(Mesh mesh, const PrecomputeOptions& options, PrecomputeReport* report) {
    PrecomputeReport local;
    PrecomputeReport& facts = report != nullptr ? *report : local;
    facts = {};
    if (options.output.empty())
        throw std::invalid_argument("expected a file for the plan, got none");
    Precompute(std::move(mesh), options, facts).run_plan();
}

prt::SurfaceOverride everywhere(const prt::Surface& surface) {
    return [surface](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface&) {
        return surface;
    };
}

} // namespace relumine
