#include "relumine/light/lamps.h"

#include <algorithm>
#include <utility>

#include "prt/glossy/brdf.h"
#include "relight/lamps/lamp_light.h"

namespace relumine {

SceneLamps::SceneLamps(const Scene& scene, const SceneRays& rays) : scene_(&scene), rays_(&rays) {
    if (!scene.lamps.empty())
        sources_.emplace_back();
}

void SceneLamps::set(std::vector<EmissionGain> gains) {
    require_lamps(*scene_, gains);
    load_profiles(gains);
    const std::vector<EmissionGain> before = std::exchange(gains_, std::move(gains));
    if (sources_.empty())
        return;
    std::vector<std::string> names = {""};
    for (const EmissionGain& gain : gains_)
        if (std::find(names.begin(), names.end(), gain.name) == names.end())
            names.push_back(gain.name);
    const auto source_of = [&](const std::string& name) {
        return std::find_if(sources_.begin(), sources_.end(),
                            [&](const Source& source) { return source.name == name; });
    };
    // The lamps without a name in the factors are others where the names are.
    const bool has_same_names =
        names.size() == sources_.size() &&
        std::all_of(names.begin(), names.end(),
                    [&](const std::string& name) { return source_of(name) != sources_.end(); });
    std::vector<Source> sources;
    for (const std::string& name : names)
        if (const auto found = source_of(name);
            found != sources_.end() && (!name.empty() || has_same_names) &&
            profile_of(gains_, name) == profile_of(before, name))
            sources.push_back(std::move(*found));
        else
            sources.push_back({.name = name});
    sources_ = std::move(sources);
}

std::vector<glm::vec3> SceneLamps::light_of(const Source& source) const {
    const auto is_of_source = [&](const std::string& name) {
        if (!source.name.empty())
            return name == source.name;
        return std::none_of(sources_.begin(), sources_.end(), [&](const Source& other) {
            return !other.name.empty() && other.name == name;
        });
    };
    std::vector<prt::Emitter> emitters;
    std::vector<mesh::PunctualLight> lights;
    for (const prt::Emitter& emitter : scene_->lamps.emitters)
        if (is_of_source(scene_->lamps.groups[emitter.group]))
            emitters.push_back(emitter);
    for (const mesh::PunctualLight& light : scene_->lamps.lights)
        if (is_of_source(light.name))
            shape(lights.emplace_back(light), gains_);
    return relight::lamp_light(scene_->mesh, emitters, lights,
                               {.positions = scene_->receivers.positions,
                                .normals = scene_->receivers.normals,
                                .rays = rays_->blockers(),
                                .bias = scene_->settings.bias,
                                .two_sided = scene_->settings.two_sided_bounces});
}

void SceneLamps::find() {
    report_ = {};
    if (sources_.empty())
        return;
    for (Source& source : sources_) {
        if (source.light.empty())
            source.light = light_of(source);
        if (bounces_now_ && source.bounced.empty()) {
            const BounceReport found = bounces_.find(source.light);
            report_.num_bounces = std::max(report_.num_bounces, found.num_bounces);
            report_.error = std::max(report_.error, found.error);
            report_.seconds += found.seconds;
            source.bounced.assign(bounces_.bounced().begin(), bounces_.bounced().end());
        }
    }
    const std::size_t n = scene_->receivers.size();
    direct_.assign(n, glm::vec3(0.0f));
    bounced_.assign(bounces_now_ ? n : 0, glm::vec3(0.0f));
    for (const Source& source : sources_) {
        const glm::vec3 gain = gain_of(gains_, source.name);
        for (std::size_t i = 0; i < n; ++i)
            direct_[i] += gain * source.light[i];
        for (std::size_t i = 0; i < bounced_.size(); ++i)
            bounced_[i] += gain * source.bounced[i];
    }
    const std::vector<prt::Surface>& surfaces = scene_->receivers.surfaces;
    const std::vector<prt::EyeCosines> cosines = prt::eye_cosines(scene_->receivers);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        direct_[i] *= prt::diffuse_albedo(surfaces[i], cosines[i]);
}

void SceneLamps::set_bounces(const relight::SurfaceBounces& surfaces,
                             const relight::SharedRows& rows) {
    if (sources_.empty())
        return;
    const bool is_same = bounces_.is_set() && bounces_.surfaces().albedo == surfaces.albedo &&
                         bounces_.surfaces().limits == surfaces.limits;
    bounces_now_ = true;
    if (is_same)
        return;
    bounces_.set(*scene_, surfaces, rows);
    for (Source& source : sources_)
        source.bounced.clear();
}

void SceneLamps::forget_rays() {
    for (Source& source : sources_)
        source.light.clear();
}

void SceneLamps::forget_light() {
    forget_rays();
    bounces_.unset();
    forget_bounces();
}

void SceneLamps::forget_bounces() {
    bounces_now_ = false;
}

} // namespace relumine
