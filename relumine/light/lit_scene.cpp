#include "relumine/light/lit_scene.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "relight/harmonics/harmonics.h"
#include "relight/sharp/shadow_rays.h"

namespace relumine {

namespace {

/// Returns the map of a light, or null.
const cubemap::CubeMap* map_of(const Light& light) {
    if (const auto* binned = std::get_if<BinnedEnvironment>(&light.environment))
        return binned->map.get();
    if (const auto* shared =
            std::get_if<std::shared_ptr<const cubemap::CubeMap>>(&light.environment))
        return shared->get();
    return std::get_if<cubemap::CubeMap>(&light.environment);
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
      rays_(std::make_unique<const SceneRays>(*scene_)),
      receivers_(*scene_, std::move(part), options.team, options.path),
      harmonics_(options.harmonics), own_blockers_(options.blockers), lamps_(*scene_, *rays_),
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
                        .positions = receivers_.positions(),
                        .bias = scene_->settings.bias,
                        .tolerance = rms_tolerance(*scene_)};
    if (has_clusters)
        relighter_ = std::make_unique<relight::Relighter>(
            receivers_.transfer(), shadow_rays_,
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

/// Throws where the first process has other light.
void LitScene::require_same(const Light& light) const {
    if (const cubemap::CubeMap* map = map_of(light))
        receivers_.require_same(std::as_bytes(std::span(map->texels)));
    receivers_.require_same(std::as_bytes(std::span(light.lights)));
}

UpdateReport LitScene::light(Light light) {
    const auto start = std::chrono::steady_clock::now();
    const bool has_environment = !std::holds_alternative<std::monostate>(light.environment);
    if (has_environment)
        static_cast<void>(relighter());
    require_same(light);
    UpdateReport report;
    ListedLight listed;
    if (!relighter_) {
        listed = listed_light(light.lights, scene_->receivers.normals, shadow_rays_);
    } else if (!has_environment) {
        report = relighter_->set_lights(light.lights);
    } else if (!light.lights.empty()) {
        if (!std::holds_alternative<BinnedEnvironment>(light.environment))
            relight::require_radiance(map_of(light)->texels);
        listed = listed_light(light.lights, *relighter_, harmonics_ != 0);
    }
    if (has_environment)
        report = environment_.light(std::move(light), *relighter_);
    else
        environment_.clear();
    listed_ = std::move(listed);
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

UpdateReport LitScene::edit(LightState next, Ending ending) {
    require_valid(next);
    static_cast<void>(relighter());
    if (environment_.begin(*relighter_)) {
        if (bounces_.bounced().empty()) {
            bounces_.unset();
            lamps_.forget_bounces();
        } else {
            find_bounces(false);
        }
    }
    const EditedEnvironment::Change change =
        environment_.change(std::move(next), ending, *relighter_);
    if (change.is_whole) {
        bounces_.forget();
        lamps_.forget_bounces();
    } else if (change.is_other) {
        bounces_.unsettle();
    }
    is_lit_ = true;
    if (ending == Ending::Exact) {
        if (!change.is_whole)
            relighter_->resum();
        if (bounces_.is_set())
            find_bounces(false);
    }
    finish();
    return change.report;
}

UpdateReport LitScene::update_region(const cubemap::TexelRectangle& rectangle,
                                     std::span<const glm::vec3> radiance) {
    if (environment_.is_edited())
        return edit(environment_.with_region(rectangle, radiance));
    static_cast<void>(relighter());
    const UpdateReport report = relight::update_region(*relighter_, rectangle, radiance);
    environment_.forget_file();
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
    const relight::SharedRows rows = receivers_.rows();
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
