#include "relumine/light/lit_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/hash.h"
#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/shadow_rays.h"

namespace relumine {

namespace {

/// Returns the map of a light that is not binned yet, or null.
const cubemap::CubeMap* map_of(const Light& light) {
    if (const auto* shared =
            std::get_if<std::shared_ptr<const cubemap::CubeMap>>(&light.environment))
        return shared->get();
    return std::get_if<cubemap::CubeMap>(&light.environment);
}

void require_same_hash(prt::Team& team, const std::filesystem::path& path, std::uint64_t own) {
    const std::vector<std::byte> bytes = prt::to_send(std::span(&own, 1));
    if (team.broadcast(bytes) != bytes)
        throw std::runtime_error(
            fmt::format("{}: expected the scene and the light of the first process, got others",
                        path.string()));
}

} // namespace

LitScene::LitScene(Scene scene, const LightOptions& options)
    : LitScene(std::make_shared<Scene>(std::move(scene)), options) {}

LitScene::LitScene(const std::shared_ptr<Scene>& own, const LightOptions& options)
    : LitScene(std::shared_ptr<const Scene>(own), nullptr, options) {
    own_scene_ = own.get();
}

void LitScene::set_roughness(float roughness) {
    if (own_scene_ == nullptr)
        throw std::logic_error("expected a scene that is not shared, to set its roughness");
    relumine::set_roughness(*own_scene_, roughness);
}

LitScene::LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options)
    : LitScene(std::move(scene), nullptr, options) {}

LitScene::LitScene(prt::ScenePart part, const LightOptions& options)
    : LitScene(nullptr, std::make_unique<prt::ScenePart>(std::move(part)), options) {}

LitScene::LitScene(std::shared_ptr<const Scene> scene, std::unique_ptr<prt::ScenePart> part,
                   const LightOptions& options)
    : scene_(part ? std::make_shared<const Scene>(std::move(part->scene)) : std::move(scene)),
      rays_(std::make_unique<const SceneRays>(*scene_)), own_blockers_(options.blockers),
      team_(part && options.team != nullptr ? options.team : &prt::alone()), path_(options.path),
      harmonics_(options.harmonics), lamps_(*scene_, *rays_),
      mirrors_(*scene_, *rays_, options.highlight_rays) {
    if (harmonics_ != 0)
        relight::require_order(harmonics_);
    const bool has_clusters = relumine::has_clusters(*scene_);
    if (has_clusters && scene_->receivers.size() != scene_->transfer.num_receivers())
        throw std::invalid_argument(fmt::format("expected the transfer of {} receivers, got {}",
                                                scene_->receivers.size(),
                                                scene_->transfer.num_receivers()));
    if (!options.clusters_only)
        shadow_rays_ = {.blockers =
                            own_blockers_ ? own_blockers_.get() : &rays_->for_moving_lights(),
                        .positions = part ? part->positions : scene_->receivers.positions,
                        .bias = scene_->settings.bias,
                        .tolerance = rms_tolerance(*scene_)};
    if (part) {
        require_same(*team_, path_);
        // The scene's surfaces may have got other colours.
        part->transfer.surfaces.clear();
        if (!scene_->receivers.surfaces.empty())
            for (const std::uint32_t receiver : part->receivers)
                part->transfer.surfaces.push_back(scene_->receivers.surfaces[receiver]);
    }
    part_ = std::move(part);
    if (has_clusters)
        relighter_ = std::make_unique<relight::Relighter>(
            part_ ? part_->transfer : scene_->transfer, shadow_rays_,
            harmonics_ == 0 && has_mapped_vertices(*scene_) ? relight::MaxHarmonicOrder
                                                            : harmonics_);
    else if (options.clusters_only)
        static_cast<void>(relighter());
}

const relight::Relighter& LitScene::relighter() const {
    if (!relighter_)
        throw std::invalid_argument("expected a precomputed scene, got a mesh without clusters");
    return *relighter_;
}

std::span<const glm::vec3> LitScene::radiance() const {
    if (!is_lit_ || !total_.empty() || !relighter_)
        return total_;
    return relighter_->radiance();
}

// Light

void LitScene::require_same_light(const Light& light) const {
    if (!team_->has_others())
        return;
    if (const cubemap::CubeMap* map = map_of(light))
        require_same(*team_, path_, map);
    else if (const auto* binned = std::get_if<BinnedEnvironment>(&light.environment))
        require_same(*team_, path_, binned->map.get());
    require_same_hash(*team_, path_, files::hash_of(std::as_bytes(std::span(light.lights))));
}

UpdateReport LitScene::light(Light light) {
    const auto start = std::chrono::steady_clock::now();
    const bool has_environment = !std::holds_alternative<std::monostate>(light.environment);
    if (has_environment)
        static_cast<void>(relighter());
    require_same_light(light);
    UpdateReport report;
    Added added;
    if (!has_environment && relighter_) {
        report = relighter_->set_lights(light.lights);
    } else if (!has_environment || !light.lights.empty()) {
        if (const cubemap::CubeMap* map = map_of(light))
            relight::require_radiance(map->texels);
        added = light_of_list(light.lights);
    }
    if (has_environment) {
        report = light_by_environment(light);
    } else {
        state_ = {};
        history_.restart({});
    }
    added_ = std::move(added);
    bounces_.forget();
    lamps_.forget_bounces();
    is_lit_ = true;
    const FinishTimes times = finish();
    report.seconds_lamps = times.seconds_lamps;
    report.seconds_highlights = times.seconds_highlights;
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

/// Lights the scene with a list to get its light.
LitScene::Added LitScene::light_of_list(std::span<const lights::DistantLight> lights) {
    Added added;
    for (const lights::DistantLight& light : lights)
        added.open_floor +=
            relight::vector_irradiance(light).on({0.0f, 1.0f, 0.0f}) / std::numbers::pi;
    if (relighter_) {
        relighter_->set_lights(lights);
        const auto copy = [](std::span<const glm::vec3> from, std::vector<glm::vec3>& to) {
            to.assign(from.begin(), from.end());
        };
        copy(relighter_->radiance(), added.radiance);
        copy(relighter_->diffuse_radiance(), added.diffuse);
        if (harmonics_ != 0)
            added.harmonics = relighter_->harmonics();
        added.lights = relight::picture_lights(*relighter_);
        if (!added.lights.empty())
            added.soft = relighter_->receiver_light().soft_radiance();
        return added;
    }
    added.radiance = relight::radiance_under(lights, scene_->receivers.normals, shadow_rays_);
    for (const lights::DistantLight& light : lights)
        added.lights.push_back({.cluster = 0,
                                .cell = {},
                                .direction = light.direction,
                                .irradiance = {.red = light.irradiance.r * light.direction,
                                               .green = light.irradiance.g * light.direction,
                                               .blue = light.irradiance.b * light.direction},
                                .is_of_list = true});
    added.soft.resize(added.radiance.size());
    return added;
}

UpdateReport LitScene::light_by_environment(Light& light) {
    auto* map = std::get_if<cubemap::CubeMap>(&light.environment);
    auto* shared = std::get_if<std::shared_ptr<const cubemap::CubeMap>>(&light.environment);
    const auto binned = [&]() -> BinnedEnvironment& {
        return std::get<BinnedEnvironment>(light.environment);
    };
    if (is_edited()) {
        LightState next = state_;
        next.base = std::make_shared<const LightBase>(
            map != nullptr      ? std::make_shared<const cubemap::CubeMap>(std::move(*map))
            : shared != nullptr ? *shared
                                : binned().map,
            std::move(light.file), std::move(light.path));
        const UpdateReport report = relight_all(next);
        state_ = std::move(next);
        return report;
    }
    const UpdateReport report = map != nullptr ? relighter_->set_environment(std::move(*map))
                                : shared != nullptr
                                    ? relighter_->set_environment(*shared)
                                    : relighter_->set_frame(std::move(binned()), light.bound);
    state_ = {.base = std::make_shared<const LightBase>(nullptr, std::move(light.file),
                                                        std::move(light.path))};
    return report;
}

// Edits

UpdateReport LitScene::relight_all(const LightState& next) {
    if (!next.base->map() || next.base->map()->resolution == 0)
        throw std::invalid_argument("expected a base with texels");
    return relight_all(LayerCompositor(next, std::exchange(turning_memory_, {})));
}

UpdateReport LitScene::relight_all(LayerCompositor compositor) {
    UpdateReport report;
    if (std::shared_ptr<const cubemap::CubeMap> base = compositor.base_alone()) {
        report = relighter_->set_environment(std::move(base));
    } else {
        // The map that the layers were composited in is composited anew.
        const bool has_memory = is_edited() && compositor_.is_set();
        try {
            report = relighter_->set_environment(
                compositor.whole(has_memory ? relighter_->lend_environment() : cubemap::CubeMap()));
        } catch (...) {
            if (has_memory)
                relighter_->return_environment(compositor_.whole());
            throw;
        }
    }
    turning_memory_ = compositor_.take_turned();
    compositor_ = std::move(compositor);
    coarse_.is_shown = false;
    report.texels = compositor_.changed();
    return report;
}

/// Relights by a map that is quick to turn.
UpdateReport LitScene::relight_coarse(const LightState& next) {
    if (coarse_.of != next.base || !coarse_.turns) {
        const std::shared_ptr<const cubemap::CubeMap>& map = next.base->map();
        coarse_.of = next.base;
        coarse_.turns.emplace(map->resolution <= MovingResolution
                                  ? map
                                  : std::make_shared<const cubemap::CubeMap>(
                                        cubemap::halved_to(*map, MovingResolution)));
    }
    const UpdateReport report = relight_all(
        LayerCompositor(next, std::make_shared<const cubemap::CubeMap>(coarse_.turns->turned(
                                  cubemap::turn_about_y(next.rotation_degrees)))));
    coarse_.is_shown = true;
    return report;
}

UpdateReport LitScene::update(const LightState& next) {
    compositor_.find_changes(next);
    UpdateReport report;
    if (!compositor_.changed().empty()) {
        report = relighter_->update_regions(
            compositor_.changed(),
            [this](cubemap::CubeMap& environment) { compositor_.composite(environment); });
        bounces_.unsettle();
    }
    compositor_.accept();
    report.texels = compositor_.changed();
    return report;
}

/// Makes the present environment the base of edits to come, and the first mark.
void LitScene::begin_edits() {
    const LightState first{.base = std::make_shared<const LightBase>(
                               std::make_shared<const cubemap::CubeMap>(relighter_->environment()),
                               state_.base ? state_.base->file() : cubemap::EnvironmentFile(),
                               state_.base ? state_.base->path() : std::filesystem::path())};
    compositor_ = LayerCompositor(first);
    state_ = first;
    history_.restart(first);
    // As if the environment had just been set.
    relighter_->resum();
    if (bounces_.bounced().empty()) {
        bounces_.unset();
        lamps_.forget_bounces();
    } else {
        find_bounces(false);
    }
}

UpdateReport LitScene::edit(LightState next, Ending ending) {
    if (!std::isfinite(next.rotation_degrees))
        throw std::invalid_argument("expected a finite rotation");
    for (const cubemap::LightLayer& layer : next.layers)
        cubemap::validate(layer);
    const bool has_base = next.base && next.base->map();
    const bool is_dark = relighter().environment().resolution == 0;
    if (is_dark && !has_base)
        throw std::invalid_argument("expected an environment before its layers");
    if (!is_dark && !is_edited())
        begin_edits();
    if (!has_base)
        next.base = state_.base;
    const bool is_moving = ending == Ending::Moving && !is_dark && next.rotation_degrees != 0.0 &&
                           next.base->map()->resolution >= cubemap::QuickTurns::MinResolution;
    const bool is_whole = is_dark || coarse_.is_shown ||
                          next.rotation_degrees != state_.rotation_degrees ||
                          (next.base != state_.base &&
                           (next.rotation_degrees != 0.0 ||
                            next.base->map()->resolution != state_.base->map()->resolution));
    UpdateReport report;
    if (is_whole) {
        report = is_moving ? relight_coarse(next) : relight_all(next);
        bounces_.forget();
        lamps_.forget_bounces();
    } else if (ending != Ending::Exact || next != state_) {
        report = update(next);
    }
    if (is_dark)
        history_.restart({.base = next.base});
    is_lit_ = true;
    state_ = std::move(next);
    if (ending == Ending::Exact) {
        if (!is_whole)
            relighter_->resum();
        if (bounces_.is_set())
            find_bounces(false);
    }
    finish();
    return report;
}

UpdateReport LitScene::update_region(const cubemap::TexelRectangle& rectangle,
                                     std::span<const glm::vec3> radiance) {
    if (is_edited()) {
        relight::require_texels(rectangle, radiance, *state_.base->map());
        auto map = std::make_shared<cubemap::CubeMap>(*state_.base->map());
        relight::put_texels(rectangle, radiance, *map);
        LightState next = state_;
        next.base = std::make_shared<const LightBase>(std::move(map));
        return edit(std::move(next));
    }
    static_cast<void>(relighter());
    const UpdateReport report = relight::update_region(*relighter_, rectangle, radiance);
    state_ = {};
    bounces_.unsettle();
    finish();
    return report;
}

// Bounces

BounceReport LitScene::bounce(const Bouncing& how) {
    std::optional<relight::SurfaceBounces> surfaces;
    if (!scene_->bounces)
        throw std::invalid_argument("expected a scene with bounces, got one without");
    if (!how.albedo.empty())
        surfaces = bounces_of(*scene_, how.albedo, how.limits);
    if (!is_lit_)
        throw std::logic_error("expected a scene that is lit");
    if (!surfaces && !bounces_.is_set())
        throw std::logic_error("expected an albedo, as bounce_albedo() returns it");
    relight::SharedRows rows;
    if (part_ && part_->bounces)
        rows = {.team = team_,
                .first = part_->bounces->first,
                .num_emitters = part_->bounces->num_emitters};
    if (surfaces)
        bounces_.set(*scene_, std::move(*surfaces), rows);
    lamps_.set_bounces(bounces_.surfaces(), rows);
    BounceReport report = find_bounces(how.is_step);
    finish();
    report.num_bounces = std::max(report.num_bounces, lamps_.report().num_bounces);
    report.error = std::max(report.error, lamps_.report().error);
    report.seconds += lamps_.report().seconds;
    return report;
}

void LitScene::dim(std::vector<EmissionGain> gains) {
    if (gains == lamps_.gains())
        return;
    lamps_.set(std::move(gains));
    if (is_lit_)
        finish();
}

void require_same(prt::Team& team, const std::filesystem::path& path,
                  const cubemap::CubeMap* environment) {
    if (team.has_others())
        require_same_hash(team, path,
                          environment == nullptr
                              ? files::file_hash(path)
                              : files::hash_of(std::as_bytes(std::span(environment->texels))));
}

bool has_environment(const LitScene& lit) {
    return has_clusters(lit.scene()) && lit.relighter().environment().resolution != 0;
}

const cubemap::CubeMap& environment_of(const LitScene& lit) {
    static const cubemap::CubeMap Black(1), Nothing;
    if (has_environment(lit))
        return lit.relighter().environment();
    return lit.radiance().empty() ? Nothing : Black;
}

BinnedEnvironment bin(const LitScene& lit, cubemap::CubeMap environment) {
    return relight::binner_of(lit.relighter()).bin(std::move(environment));
}

} // namespace relumine
