#include "relumine/light/edited_environment.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

namespace relumine {

namespace {

using SharedMap = std::shared_ptr<const cubemap::CubeMap>;

/// Returns the map of a light with an environment.
SharedMap shared_map_of(Light& light) {
    if (auto* map = std::get_if<cubemap::CubeMap>(&light.environment))
        return std::make_shared<const cubemap::CubeMap>(std::move(*map));
    if (const auto* shared = std::get_if<SharedMap>(&light.environment))
        return *shared;
    return std::get<BinnedEnvironment>(light.environment).map;
}

UpdateReport set_environment(Light& light, relight::Relighter& relighter) {
    if (auto* map = std::get_if<cubemap::CubeMap>(&light.environment))
        return relighter.set_environment(std::move(*map));
    if (const auto* shared = std::get_if<SharedMap>(&light.environment))
        return relighter.set_environment(*shared);
    return relighter.set_frame(std::move(std::get<BinnedEnvironment>(light.environment)));
}

} // namespace

void require_valid(const LightState& state) {
    if (!std::isfinite(state.rotation_degrees))
        throw std::invalid_argument("expected a finite rotation");
    for (const cubemap::LightLayer& layer : state.layers)
        cubemap::validate(layer);
}

relight::Relighter& require_clusters(relight::Relighter* relighter) {
    if (relighter == nullptr)
        throw std::invalid_argument("expected a precomputed scene, got a mesh without clusters");
    return *relighter;
}

UpdateReport EditedEnvironment::light(Light light) {
    if (is_edited()) {
        LightState next = state_;
        next.base = std::make_shared<const LightBase>(shared_map_of(light), std::move(light.file),
                                                      std::move(light.path));
        const UpdateReport report = relight_all(next);
        state_ = std::move(next);
        return report;
    }
    const UpdateReport report = set_environment(light, *relighter_);
    state_ = {.base = std::make_shared<const LightBase>(nullptr, std::move(light.file),
                                                        std::move(light.path))};
    return report;
}

void EditedEnvironment::clear() {
    state_ = {};
    history_.restart({});
}

UpdateReport EditedEnvironment::edit(LightState next, Ending ending) {
    require_valid(next);
    static_cast<void>(require_clusters(relighter_));
    begin();
    EnvironmentChange change = this->change(std::move(next), ending);
    follower_.follow(change, ending);
    return change.report;
}

UpdateReport EditedEnvironment::update_region(const cubemap::TexelRectangle& rectangle,
                                              std::span<const glm::vec3> radiance) {
    if (is_edited())
        return edit(with_region(rectangle, radiance));
    EnvironmentChange change{
        .report = relight::update_region(require_clusters(relighter_), rectangle, radiance),
        .is_other = true};
    state_ = {}; // no longer that of its file
    follower_.follow(change, Ending::Quick);
    return change.report;
}

glm::dvec3 EditedEnvironment::open_floor_of_base() const {
    constexpr glm::vec3 Up(0.0f, 1.0f, 0.0f);
    if (!is_edited() || state_.layers.empty())
        return relighter_->open_radiance(Up);
    if (std::exchange(open_of_, state_.base) != state_.base)
        open_of_base_ = cubemap::irradiance(*state_.base->map(), Up) / std::numbers::pi;
    return open_of_base_;
}

/// Makes the present environment the base of edits to come, and the first mark, unless that was
/// done or there is none.
void EditedEnvironment::begin() {
    if (is_edited() || !is_lit())
        return;
    const LightState first{.base = std::make_shared<const LightBase>(
                               std::make_shared<const cubemap::CubeMap>(relighter_->environment()),
                               state_.base ? state_.base->file() : cubemap::EnvironmentFile(),
                               state_.base ? state_.base->path() : std::filesystem::path())};
    compositor_ = LayerCompositor(first);
    state_ = first;
    history_.restart(first);
    relighter_->resum();
    follower_.follow_first_edit();
}

/// Goes to another state, after begin(). A state whose base has no map keeps the present one.
EnvironmentChange EditedEnvironment::change(LightState next, Ending ending) {
    const bool is_dark = relighter_->environment().resolution == 0;
    if (!next.base || !next.base->map())
        next.base = state_.base;
    if (is_dark && (!next.base || !next.base->map()))
        throw std::invalid_argument("expected an environment before its layers");
    const bool is_moving = ending == Ending::Moving && !is_dark && next.rotation_degrees != 0.0 &&
                           next.base->map()->resolution > MovingResolution;
    const bool is_whole = is_dark || coarse_.is_shown ||
                          next.rotation_degrees != state_.rotation_degrees ||
                          (next.base != state_.base &&
                           (next.rotation_degrees != 0.0 ||
                            next.base->map()->resolution != state_.base->map()->resolution));
    EnvironmentChange change;
    if (is_whole)
        change = {.report = is_moving ? relight_coarse(next) : relight_all(next),
                  .is_whole = true,
                  .is_other = true};
    else if (ending != Ending::Exact || next != state_)
        change = update(next);
    if (is_dark)
        history_.restart({.base = next.base});
    state_ = std::move(next);
    return change;
}

/// Returns the state with a rectangle of the base's texels replaced. Only where is_edited().
LightState EditedEnvironment::with_region(const cubemap::TexelRectangle& rectangle,
                                          std::span<const glm::vec3> radiance) const {
    relight::require_texels(rectangle, radiance, *state_.base->map());
    auto map = std::make_shared<cubemap::CubeMap>(*state_.base->map());
    relight::put_texels(rectangle, radiance, *map);
    LightState next = state_;
    next.base = std::make_shared<const LightBase>(std::move(map));
    return next;
}

UpdateReport EditedEnvironment::relight_all(const LightState& next) {
    if (!next.base->map() || next.base->map()->resolution == 0)
        throw std::invalid_argument("expected a base with texels");
    return relight_all(LayerCompositor(next, std::exchange(turning_memory_, {})));
}

UpdateReport EditedEnvironment::relight_all(LayerCompositor compositor) {
    UpdateReport report;
    if (SharedMap base = compositor.base_alone()) {
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
UpdateReport EditedEnvironment::relight_coarse(const LightState& next) {
    if (coarse_.of != next.base) {
        coarse_.of = next.base;
        coarse_.map = std::make_shared<const cubemap::CubeMap>(
            cubemap::halved_to(*next.base->map(), MovingResolution));
    }
    const UpdateReport report =
        relight_all(LayerCompositor(next, std::make_shared<const cubemap::CubeMap>(cubemap::rotated(
                                              *coarse_.map, next.rotation_degrees))));
    coarse_.is_shown = true;
    return report;
}

EnvironmentChange EditedEnvironment::update(const LightState& next) {
    compositor_.find_changes(next);
    EnvironmentChange change;
    if (!compositor_.changed().empty()) {
        change.report = relighter_->update_regions(
            compositor_.changed(),
            [this](cubemap::CubeMap& environment) { compositor_.composite(environment); });
        change.is_other = true;
    }
    compositor_.accept();
    change.report.texels = compositor_.changed();
    return change;
}

} // namespace relumine
