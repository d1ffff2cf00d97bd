// What lights the frames of an animation: this process, or all of a team, each its own receivers.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "app/options/bounce_option.h"
#include "app/options/lit_scene.h"
#include "app/options/output_options.h"
#include "app/session.h"
#include "relight/relighter.h"
#include "relumine/shared_light.h"

namespace relumine::app {

/// The scene and its light. All processes of a team call the same functions in the same order.
class FrameLight {
public:
    FrameLight(const SceneOptions& scene, prt::Team* team);

    /// The scene, to be drawn.
    [[nodiscard]] const LitScene& lit() const { return shared_ ? shared_->lit() : *lit_; }
    /// The tolerance of sharp lights; 0 where they are not traced.
    [[nodiscard]] float sharp_tolerance() const;

    void set_bounces(const BounceOption& option, const relumine::OutputOptions& output,
                     const std::string& path);
    /// Forgets the light: the next frame is as the first.
    void restart();
    UpdateReport set_frame(BinnedEnvironment frame, double bound = 0.0);
    RelightTimes set_lights(std::span<const lights::DistantLight> lights);
    /// Adds the bounces, where there are any.
    void bounce();
    /// In the first process alone; it is good until the light changes. Where it is not drawn it has
    /// the radiance alone.
    [[nodiscard]] Lighting lighting(bool is_drawn);

    [[nodiscard]] bool is_first() const { return team_ == nullptr || team_->part().index == 0; }
    /// What the first process says.
    [[nodiscard]] std::vector<bool> agreed(std::vector<bool> own) const;

private:
    prt::Team* team_;
    std::optional<SharedLight> shared_;
    std::optional<LitScene> lit_;
    std::optional<relight::Relighter> relighter_;
    relight::SurfaceBounces bounces_;
};

} // namespace relumine::app
