#include "relumine/light/bounces.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "prt/glossy/brdf.h"
#include "relumine/light/passed_on.h"

namespace relumine {

void require_bounces(const Scene& scene) {
    if (!scene.bounces)
        throw std::invalid_argument(
            "expected a scene with bounces, got one without: no surface sees another, or none "
            "were asked for");
}

relight::SurfaceBounces bounces_of(const Scene& scene, std::span<const glm::vec3> albedo,
                                   const BounceLimits& limits) {
    require_bounces(scene);
    relight::SurfaceBounces bounces{
        .matrix = &*scene.bounces, .albedo = {albedo.begin(), albedo.end()}, .limits = limits};
    const std::vector<prt::Surface>& surfaces = scene.receivers.surfaces;
    if (surfaces.size() == bounces.albedo.size())
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            bounces.albedo[i] *= surfaces[i].albedo;
    bounces.passed_on = passed_on(scene);
    for (relight::PassedOn& own : bounces.passed_on)
        own.part *= albedo[own.receiver];
    return bounces;
}

void SceneBounces::set(const Scene& scene, relight::SurfaceBounces surfaces,
                       const relight::SharedRows& rows) {
    const bool has_albedo = light_ && surfaces.albedo == surfaces_.albedo;
    if (!light_) {
        relight::BounceLight made(*surfaces.matrix, scene.transfer, rows);
        made.set_albedo(surfaces.albedo, surfaces.passed_on);
        light_ = std::move(made);
    } else if (!has_albedo) {
        light_->set_albedo(surfaces.albedo, surfaces.passed_on);
    }
    if (!has_albedo || surfaces.limits != surfaces_.limits)
        found_of_.clear();
    scene_ = &scene;
    surfaces_ = std::move(surfaces);
    forget();
}

BounceReport SceneBounces::find(std::span<const glm::vec3> direct) {
    is_settled_ = true;
    if (!found_of_.empty() &&
        std::equal(direct.begin(), direct.end(), found_of_.begin(), found_of_.end())) {
        found_.seconds = 0.0;
        return take(found_);
    }
    found_ = light_->solve(direct, surfaces_.limits);
    found_of_.assign(direct.begin(), direct.end());
    return take(found_);
}

BounceReport SceneBounces::step(std::span<const glm::vec3> direct) {
    if (surfaces_.limits.num_bounces)
        return find(direct);
    const BounceReport report = light_->step(direct);
    found_of_.clear();
    constexpr double Visible = 1e-4;
    is_settled_ = report.error < Visible;
    return take(report);
}

BounceReport SceneBounces::take(const BounceReport& report) {
    const std::span<const glm::vec3> indirect = light_->indirect();
    bounced_.assign(indirect.begin(), indirect.end());
    const std::vector<prt::Surface>& surfaces = scene_->receivers.surfaces;
    const std::vector<prt::EyeCosines> cosines = prt::eye_cosines(scene_->receivers);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        bounced_[i] *= prt::diffuse_albedo(surfaces[i], cosines[i]);
    return report;
}

void SceneBounces::forget() {
    bounced_.clear();
    is_settled_ = false;
}

} // namespace relumine
