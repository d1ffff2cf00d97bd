#include "relumine/in/precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/extension.h"
#include "files/joined.h"
#include "prt/glossy/lobe_list.h"
#include "prt/glossy/sheen_lobe.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/parts/part_file.h"
#include "prt/parts/team_checkpoint.h"
#include "prt/receivers/point_receivers.h"
#include "prt/receivers/receiver_order.h"
#include "prt/receivers/texture_view.h"
#include "prt/scene/checkpoint_file.h"
#include "prt/scene/fingerprint.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/framing.h"
#include "relumine/in/precompute_table.h"
#include "relumine/in/receiver_placement.h"
#include "relumine/in/scene_materials.h"
#include "relumine/in/stages.h"

namespace relumine {

namespace {

/// What a process takes for its share, while it lasts.
class ProcessClock {
public:
    explicit ProcessClock(const prt::Team& team)
        : team_(team), waiting_before_(team.seconds_waiting()) {}

    [[nodiscard]] ProcessFigures figures(const prt::PrecomputeStatistics& clusters) const {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
        return {.num_rays = clusters.num_own_rays,
                .seconds = seconds.count(),
                .seconds_waiting = team_.seconds_waiting() - waiting_before_,
                .seconds_of_processors =
                    static_cast<double>(std::clock() - processors_before_) / CLOCKS_PER_SEC,
                .plane_bytes = clusters.plane_bytes,
                .column_bytes = clusters.column_bytes};
    }

private:
    const prt::Team& team_;
    double waiting_before_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::clock_t processors_before_ = std::clock();
};

/// Computes the light of a plan with all processes of a team. The first one's scene gets it.
void compute(prt::Plan& plan, const prt::RayScene& rays, const Stages::Options& options,
             const PrecomputeWork& work, PrecomputeReport& report) {
    const ProcessClock clock(work.team);
    prt::PartLight own = Stages(plan, work, report, options).run(rays);
    const ProcessFigures figures = clock.figures(report.clusters);
    std::vector<prt::PartLight> light = prt::gather_light(work.team, plan.scene, std::move(own));
    for (const std::vector<std::byte>& bytes :
         work.team.gather(prt::to_send(std::span(&figures, 1))))
        std::memcpy(&report.processes.emplace_back(), bytes.data(), sizeof figures);
    if (!work.team.is_first())
        return;
    const auto start = std::chrono::steady_clock::now();
    prt::BounceStatistics bounces;
    prt::join_light(plan.scene, light, &bounces);
    if (report.bounces) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        bounces.seconds = report.bounces->seconds + seconds.count();
        report.bounces = bounces;
    }
}

bool are_in_space(const PrecomputeOptions& options) {
    return std::holds_alternative<Points>(options.receivers) ||
           std::holds_alternative<Grid>(options.receivers);
}

bool are_pixels(const PrecomputeOptions& options) {
    return std::holds_alternative<Pixels>(options.receivers);
}

/// One precompute, step by step.
class Precompute {
public:
    Precompute(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work,
               PrecomputeReport& report)
        : options_(options), work_(work), report_(report),
          prefix_(mesh.source.empty() ? "" : mesh.source + ": ") {
        report_ = {};
        mesh = with_vertices(sound(std::move(mesh)));
        scene_.blockers = std::move(mesh.blockers);
        scene_.mesh = std::move(mesh.geometry);
        lightmap_uvs_ = mesh.lightmap_uvs;
        scene_.settings = {
            .tolerance = options.tolerance.value_or(are_in_space(options) ? ToleranceOfPoints
                                                    : report_.refined || are_pixels(options)
                                                        ? ToleranceOfRefined
                                                        : prt::PrecomputeOptions{}.tolerance),
            .epsilon = options.epsilon,
            .min_level = are_in_space(options) ? std::max(options.min_level, prt::MinLevelOfPoints)
                                               : options.min_level,
            .face_resolution = options.face_resolution,
            .bias = options.bias.value_or(prt::automatic_bias(scene_.mesh)),
            .floor_vertices = mesh.floor_vertices,
            .source = std::filesystem::path(mesh.source).filename().string(),
            .floor_added = mesh.floor_added,
            .source_hash = mesh.source_hash,
            .is_movable = options.movable,
            .camera = mesh.camera,
            .left_out = mesh::left_out(scene_.mesh)};
    }

    /// Chooses the clusters and leaves the counts to the parts.
    void run_plan() {
        is_plan_ = true;
        check_options();
        const prt::RayScene rays = prepare();
        stages().choose_clusters(rays);
        report_.file_bytes = prt::save_plan(options_.output, plan_);
    }

    Scene run() {
        check_options();
        try {
            light_up();
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
    /// The mesh with the vertices that are lit: its own, and more where it is coarse.
    Mesh with_vertices(Mesh mesh) {
        if (!std::holds_alternative<Vertices>(options_.receivers) &&
            !(options_.bounce_tolerance.value_or(0.0f) > 0.0f))
            return mesh;
        mesh.is_open = mesh.is_open && !options_.no_refine && options_.blockers == nullptr;
        prt::RefineReport found;
        // The surfaces of the options may light what the file leaves unlit.
        std::vector<mesh::Material> of_file;
        if (options_.surface) {
            of_file = mesh.geometry.materials;
            for (mesh::Material& material : mesh.geometry.materials)
                material.model = mesh::MaterialModel::MetallicRoughness;
        }
        mesh =
            refined_by_itself(std::move(mesh), options_.bias, work_.of(Stage::Refinement), &found);
        if (options_.surface)
            mesh.geometry.materials = std::move(of_file);
        if (found.num_added != 0)
            report_.refined = found;
        return options_.surface ? std::move(mesh) : with_backs_of_sheets(std::move(mesh));
    }

    void check_options() const {
        check_points(options_);
        if (options_.blockers != nullptr)
            check_own_blockers();
        if (options_.movable && scene_.mesh.groups.empty())
            throw std::invalid_argument(
                prefix_ +
                "expected a mesh with groups (nodes of glTF, groups of OBJ) to move, got none");
        if (!(scene_.settings.tolerance >= 0.0f && std::isfinite(scene_.settings.tolerance)))
            throw std::invalid_argument(
                fmt::format("expected a tolerance >= 0, got {}", scene_.settings.tolerance));
        if (options_.bounce_tolerance && !(*options_.bounce_tolerance >= 0.0f))
            throw std::invalid_argument(fmt::format("expected a tolerance of bounces >= 0, got {}",
                                                    *options_.bounce_tolerance));
        const char* const extension = is_plan_ ? ".plan" : ".prt";
        if (!options_.output.empty() && options_.output.extension() != extension)
            throw std::invalid_argument(fmt::format("{}: expected a name that ends in {}",
                                                    options_.output.string(), extension));
        if (options_.output.empty() && options_.resume)
            throw std::invalid_argument("expected an output to resume the work of, got none");
        if (work_.team.has_others() && options_.max_memory)
            throw std::invalid_argument(
                "expected no limit of memory where processes share the work");
        if (!(options_.checkpoint_seconds >= 0.0))
            throw std::invalid_argument(fmt::format("expected checkpoint seconds >= 0, got {}",
                                                    options_.checkpoint_seconds));
    }

    /// Parts, processes and checkpoints know the mesh alone, and so do bounces.
    void check_own_blockers() const {
        if (is_plan_ || work_.team.has_others())
            throw std::invalid_argument(
                "expected triangles as blockers where the work is shared, got others");
        if (options_.resume)
            throw std::invalid_argument(
                "expected triangles as blockers of work that is resumed, got others");
        if (options_.bounce_tolerance.value_or(0.0f) > 0.0f)
            throw std::invalid_argument(
                "expected triangles as blockers of light that bounces, got others");
    }

    /// Makes the plan: mesh, receivers and what is asked for. Returns what answers ray queries.
    prt::RayScene prepare() {
        report_.num_vertices = scene_.mesh.num_vertices();
        report_.num_triangles = scene_.mesh.num_triangles();
        report_.bias = scene_.settings.bias;
        stages().check_scene();
        prt::RayScene rays = ray_scene(scene_.blocking_mesh(), prefix_);
        place_receivers(scene_, options_, work_, rays, prefix_, lightmap_uvs_, report_);
        require_few_clusters();
        report_.num_receivers = scene_.receivers.size();
        if (!options_.tolerance && !options_.epsilon)
            limit_clusters(rays);
        set_surfaces();
        if (prt::on_vertices(scene_.layout))
            prt::leave_unlit_out(scene_.receivers);
        poll();
        if (prt::has_highlights(scene_.receivers) && !are_traced()) {
            if (options_.blockers != nullptr)
                throw std::invalid_argument(
                    "expected triangles as blockers of stored highlights, got others");
            scene_.settings.glossy_tolerance = options_.glossy_tolerance;
            warn_of_smooth_surfaces();
        }
        if ((!prt::on_vertices(scene_.layout) || scene_.settings.glossy_tolerance) &&
            prt::kind_of(scene_.layout).have_surface && prt::passes_light_on(scene_.mesh))
            warn(work_, Warning::PassedOnLight,
                 "light that comes through surfaces (KHR_materials_diffuse_transmission) is left "
                 "out: vertices without a view have it");
        if (const float tolerance = bounce_tolerance(rays); tolerance > 0.0f) {
            scene_.settings.two_sided_bounces = options_.two_sided_bounces;
            scene_.settings.bounce_tolerance = tolerance;
            plan_.bounces = {.tolerance = tolerance,
                             .is_automatic = !options_.bounce_tolerance.has_value()};
        }
        return rays;
    }

    void limit_clusters(const prt::RayScene& rays) {
        const bool is_thin = options_.blockers == nullptr && rays.settled() != nullptr;
        if (are_pixels(options_))
            scene_.settings.most_clusters =
                is_thin ? MostClustersOfThinPixels : MostClustersOfPixels;
        else if (is_thin)
            scene_.settings.most_clusters = MostClustersOfThin;
    }

    /// Whether rays find the highlights when the scene is lit.
    [[nodiscard]] bool are_traced() const {
        if (options_.highlights)
            return *options_.highlights == Highlights::Traced;
        return std::holds_alternative<prt::PixelLayout>(scene_.layout);
    }

    /// What was asked for. Where nothing was, vertices bounce light if surfaces are before them.
    [[nodiscard]] float bounce_tolerance(const prt::RayScene& rays) const {
        constexpr double LeastClosure = 0.01;
        if (options_.blockers != nullptr)
            return 0.0f;
        if (options_.bounce_tolerance)
            return *options_.bounce_tolerance;
        if (!prt::on_vertices(scene_.layout) ||
            prt::estimated_closure(scene_.receivers, rays, scene_.settings.bias) <= LeastClosure)
            return 0.0f;
        return prt::automatic_tolerance(scene_.receivers.size(),
                                        relight::inside_room(scene_.mesh).has_value());
    }

    /// The rays and all they are made of go before the scene is written, which needs memory of its
    /// own.
    void light_up() {
        const prt::RayScene rays = prepare();
        open_checkpoint();
        if (work_.team.has_others()) {
            // The cells to begin with.
            const std::uint32_t level =
                std::min(scene_.settings.min_level, prt::texel_level(options_.face_resolution));
            scene_.transfer.quadtree =
                prt::Quadtree::of([=](const prt::Cell& cell) { return cell.level < level; });
            scene_.transfer.order = prt::spatial_order(scene_.receivers);
            prt::share_plan(work_.team, plan_);
        }
        compute(plan_, rays, stage_options(), work_, report_);
    }

    [[nodiscard]] Stages::Options stage_options() {
        Stages::Options options{.blockers = options_.blockers,
                                .max_memory = options_.max_memory,
                                .prefix = prefix_,
                                .checkpoint = checkpoint_.get()};
        if (team_checkpoint_)
            options.checkpoint = &*team_checkpoint_;
        return options;
    }
    [[nodiscard]] Stages stages() { return {plan_, work_, report_, stage_options()}; }

    /// Refuses what would take hours. A limit of memory has an estimate of its own.
    void require_few_clusters() const {
        // An RMS below this allows no cluster that a few receivers see differently: cells stop at
        // single texels. The work that is let through takes minutes.
        constexpr double FinestTolerance = 1e-4; // 1/sr
        // A plan is made from a sample, and processes share the receivers.
        const double most_pairs = 0x1p32 * (is_plan_ ? 16.0 : work_.team.part().count);
        if (options_.max_memory)
            return;
        const auto num_receivers = static_cast<double>(scene_.receivers.size());
        const double tolerance = options_.epsilon
                                     ? double{*options_.epsilon} * std::sqrt(num_receivers)
                                     : double{scene_.settings.tolerance};
        const double all = 6.0 * options_.face_resolution * options_.face_resolution;
        const double least = std::min(all, 6.0 * std::exp2(2.0 * scene_.settings.min_level));
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
                        scene_.receivers.size(), options_.face_resolution, clusters, 4.0 * pairs,
                        pairs * 10.0 / prt::BlockSize * 1e-9));
    }

    /// The mesh's materials, changed by the option; none where there are neither. The floor keeps
    /// its own.
    void set_surfaces() {
        const mesh::TriangleMesh& mesh = scene_.mesh;
        const std::size_t num_points = scene_.receivers.num_points();
        if (num_points != 0 && !prt::lamps_of(mesh).empty())
            note(work_, "points in space get no light from the scene's own lamps");
        if (num_points == scene_.receivers.size())
            return;
        if (num_points == 0)
            scene_.lamps.lights = mesh.lights;
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
        if (num_points == 0)
            scene_.lamps = prt::lamps_of(mesh, surface_of);
        if (const std::vector<std::string> names = scene_.lamps.names(); !names.empty())
            note(work_, fmt::format("lamps that --emission dims: {}",
                                    files::joined(std::span(names).first(
                                                      std::min<std::size_t>(names.size(), 8)),
                                                  ", ") +
                                        (names.size() > 8 ? ", ..." : "")));
        const bool are_replaced = options_.surface || options_.floor_surface != prt::Surface();
        prt::Receivers& receivers = scene_.receivers;
        const prt::GgxForm form = receivers.to_eye.empty() ? prt::GgxForm::Published : options_.ggx;
        if (receivers.points.empty()) {
            receivers.surfaces = prt::vertex_surfaces(mesh, surface_of, form);
            keep_materials(scene_.mesh, receivers, surface_of, are_replaced);
        } else {
            const mesh::MipMaps maps(mesh.textures);
            const std::optional<prt::TextureView> view = texture_view(maps);
            receivers.surfaces.assign(num_points, prt::Surface());
            for (std::size_t i = num_points; i < receivers.size(); ++i) {
                const prt::MeshPoint& point = receivers.points[i];
                const bool is_own = i < receivers.num_own();
                receivers.surfaces.push_back(
                    surface_of(mesh, point.triangle,
                               prt::surface_at(mesh, point.triangle, point.barycentric, form,
                                               is_own && view ? &*view : nullptr)));
            }
        }
        for (std::size_t i = 0; i < receivers.normal_spread.size(); ++i)
            prt::widen(receivers.surfaces[i], receivers.normal_spread[i],
                       receivers.normal_spread[i]);
        set_coat_normals();
        if (receivers.to_eye.empty())
            leave_highlights_out();
        else if (options_.ggx == prt::GgxForm::Published)
            for (prt::Surface& surface : receivers.surfaces)
                if (surface.highlight == prt::Highlight::GgxWhole) // of the options
                    surface.highlight = prt::Highlight::Ggx;
        // Vertices that only send light on are seen in mirrors alone.
        for (std::size_t i = receivers.num_own(); i < receivers.size(); ++i)
            receivers.surfaces[i] = prt::without_highlight(receivers.surfaces[i]);
        if (!receivers.points.empty() && prt::has_highlights(receivers) && are_traced())
            keep_materials(scene_.mesh, receivers, surface_of, are_replaced);
    }

    /// How pixels see the textures.
    [[nodiscard]] std::optional<prt::TextureView> texture_view(const mesh::MipMaps& maps) const {
        const auto* pixels = std::get_if<prt::PixelLayout>(&scene_.layout);
        if (pixels == nullptr)
            return std::nullopt;
        return prt::TextureView(
            maps, pixels->camera.eye,
            {pixels->camera, pixels->width, pixels->height, pixels->receivers_per_axis()});
    }

    /// Coats are as smooth as the mesh, or have normal maps of their own.
    void set_coat_normals() {
        prt::Receivers& receivers = scene_.receivers;
        if (receivers.points.empty() || scene_.mesh.corner_tangents.empty())
            return;
        for (std::size_t i = 0; i < receivers.num_own(); ++i) {
            if (!prt::has_coat(receivers.surfaces[i]))
                continue;
            const glm::vec3 normal =
                prt::seen_coat_normal(scene_.mesh, receivers.points[i], nullptr).direction;
            receivers.surfaces[i].coat_normal =
                glm::dot(normal, receivers.normals[i]) < 0.0f ? -normal : normal;
        }
    }

    void leave_highlights_out() {
        for (prt::Surface& surface : scene_.receivers.surfaces) {
            report_.num_highlights_left_out += surface.highlight != prt::Highlight::None ? 1 : 0;
            surface = prt::without_highlight(surface);
        }
        if (report_.num_highlights_left_out != 0)
            warn(work_, Warning::HighlightsWithoutView,
                 fmt::format("{} receivers have highlights, and there is no view: pictures trace "
                             "them, all else is diffuse",
                             report_.num_highlights_left_out));
    }

    void warn_of_smooth_surfaces() {
        const float narrowest = prt::narrowest_roughness(options_.face_resolution);
        const std::vector<prt::Surface>& surfaces = scene_.receivers.surfaces;
        report_.num_too_smooth = static_cast<std::size_t>(
            std::count_if(surfaces.begin(), surfaces.end(), [&](const prt::Surface& surface) {
                return prt::facts_of(surface.highlight).is_roughness &&
                       surface.roughness_or_exponent < narrowest;
            }));
        if (report_.num_too_smooth != 0)
            warn(work_, Warning::TooSmooth,
                 fmt::format("{} receivers are smoother than roughness {:.3f}: cells of the "
                             "quadtree cannot hold so sharp a highlight, it comes out wider",
                             report_.num_too_smooth, narrowest));
    }

    void open_checkpoint() {
        if (work_.team.has_others())
            team_checkpoint_.emplace(work_.team, nullptr);
        if (options_.blockers != nullptr)
            return;
        if (options_.output.empty() || !(options_.checkpoint_seconds > 0.0 || options_.resume))
            return;
        constexpr double Never = 1e9;
        // A disk that stays full need not be told of every twenty seconds.
        const auto warn_once = [this, last = std::string()](const std::string& message) mutable {
            if (std::exchange(last, message) != message)
                warn(work_, Warning::Checkpoint, message);
        };
        checkpoint_ = std::make_unique<prt::CheckpointFile>(
            options_.output,
            prt::fingerprint(scene_, plan_.bounces ? std::optional(plan_.bounces->tolerance)
                                                   : std::nullopt),
            prt::CheckpointFile::Options{
                .resume = options_.resume,
                .interval = std::chrono::duration<double>(
                    options_.checkpoint_seconds > 0.0 ? options_.checkpoint_seconds : Never),
                .on_problem = warn_once});
        if (work_.team.has_others())
            team_checkpoint_.emplace(work_.team, checkpoint_.get());
        if (checkpoint_->exists())
            note(work_, fmt::format("going on from {}",
                                    prt::CheckpointFile::folder_for(options_.output).string()));
    }

    void poll() const {
        if (work_.stop.stop_requested())
            throw Cancelled();
    }
    const PrecomputeOptions& options_;
    const PrecomputeWork& work_;
    bool is_plan_ = false;
    std::optional<std::uint32_t> lightmap_uvs_;
    PrecomputeReport& report_;
    std::string prefix_;
    prt::Plan plan_;
    Scene& scene_ = plan_.scene;
    std::unique_ptr<prt::CheckpointFile> checkpoint_;
    std::optional<prt::TeamCheckpoint> team_checkpoint_;
};

} // namespace

Scene precompute(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work,
                 PrecomputeReport* report) {
    PrecomputeReport local;
    return Precompute(std::move(mesh), options, work, report != nullptr ? *report : local).run();
}

void assist(const PrecomputeWork& work) {
    prt::Plan plan;
    prt::share_plan(work.team, plan);
    prt::TeamCheckpoint checkpoint(work.team, nullptr);
    PrecomputeReport report;
    compute(plan, ray_scene(plan.scene.blocking_mesh(), ""), {.checkpoint = &checkpoint}, work,
            report);
}

void plan(Mesh mesh, const PrecomputeOptions& options, const PrecomputeWork& work,
          PrecomputeReport* report) {
    PrecomputeReport local;
    if (options.output.empty())
        throw std::invalid_argument("expected a file for the plan, got none");
    Precompute(std::move(mesh), options, work, report != nullptr ? *report : local).run_plan();
}

void precompute_part(const PartOptions& options, const PrecomputeWork& work,
                     prt::PrecomputeStatistics* statistics) {
    prt::Plan plan = prt::load_plan(options.plan);
    prt::Alone part(options.part);
    const PrecomputeWork of_part{.team = part, .stop = work.stop, .on_progress = work.on_progress};
    PrecomputeReport report;
    const prt::PartLight light =
        Stages(plan, of_part, report, {}).run(ray_scene(plan.scene.blocking_mesh(), ""));
    prt::save_part(options.output, plan, options.part, light);
    if (statistics != nullptr)
        *statistics = report.clusters;
}

std::uint64_t join(std::span<const std::filesystem::path> parts,
                   const std::filesystem::path& output) {
    return prt::join_parts(parts, output);
}

prt::SurfaceOverride everywhere(const prt::Surface& surface) {
    return [surface](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface&) {
        return surface;
    };
}

} // namespace relumine
