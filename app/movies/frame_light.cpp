#include "app/movies/frame_light.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace relumine::app {

FrameLight::FrameLight(const SceneOptions& scene, prt::Team* team) : team_(team) {
    if (team != nullptr) {
        shared_.emplace(shared_light(scene, *team));
    } else {
        lit_.emplace(lit_scene(scene));
        restart();
    }
}

float FrameLight::sharp_tolerance() const {
    const relight::ShadowRays rays = lit().shadow_rays();
    return rays.blockers != nullptr ? rays.tolerance : 0.0f;
}

void FrameLight::set_bounces(const BounceOption& option, const relumine::OutputOptions& output,
                             const std::string& path) {
    if (shared_) {
        option.set(*shared_, output, path);
        return;
    }
    option.set(*relighter_, lit_->scene(), output, path);
    bounces_ = relighter_->bounces();
}

void FrameLight::restart() {
    if (shared_)
        return shared_->restart();
    relighter_.emplace(lit_->scene().transfer, lit_->shadow_rays());
    if (bounces_.matrix != nullptr)
        relighter_->set_bounces(bounces_);
}

UpdateReport FrameLight::set_frame(BinnedEnvironment frame, double bound) {
    return shared_ ? shared_->set_frame(std::move(frame), bound)
                   : relighter_->set_frame(std::move(frame), bound);
}

RelightTimes FrameLight::set_lights(std::span<const lights::DistantLight> lights) {
    return shared_ ? shared_->set_lights(lights) : relighter_->set_lights(lights);
}

void FrameLight::bounce() {
    if (shared_)
        shared_->bounce();
    else if (relighter_->bounces().matrix != nullptr)
        relighter_->bounce();
}

Lighting FrameLight::lighting(bool is_drawn) {
    if (shared_)
        return shared_->lighting();
    return is_drawn ? lighting_of(*relighter_) : Lighting{.radiance = relighter_->radiance()};
}

std::vector<bool> FrameLight::agreed(std::vector<bool> own) const {
    if (team_ == nullptr)
        return own;
    std::vector<std::byte> bytes(own.size());
    std::transform(own.begin(), own.end(), bytes.begin(),
                   [](bool flag) { return static_cast<std::byte>(flag ? 1 : 0); });
    std::vector<bool> result;
    for (const std::byte byte : team_->broadcast(std::move(bytes)))
        result.push_back(byte != std::byte{0});
    return result;
}

} // namespace relumine::app
