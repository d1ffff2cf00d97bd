// Highlights of a lit scene for an eye that moves.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/moving_eye/moving_eye.h"
#include "relumine/light/lit_scene.h"

namespace relumine {

using relight::EyeOptions;
using relight::EyeReport;

/// Whether a scene's highlights follow the eye: vertices of a mesh with glossy materials, and no
/// highlights for a fixed view.
[[nodiscard]] bool has_live_highlights(const Scene& scene);

/// What a scene with live highlights sends to an eye. For one thread.
///
///     relumine::LiveEye live(lit);
///     const auto radiance = live.look({3, 2, 5});
class LiveEye {
public:
    /// The scene must be lit, and outlive this object.
    ///
    /// Throws:  std::invalid_argument for a scene without live highlights, and for one whose
    ///          receivers are in several processes.
    explicit LiveEye(const LitScene& lit);

    /// Must be called when the light of the scene has changed.
    void take_light();

    /// Must be called when the scene's roughness has changed.
    ///
    /// Cost:    O(receivers), and that of take_light() where cells become finer or coarser.
    void take_surfaces();

    /// Returns outgoing radiance towards an eye, as LitScene::radiance(); good until the next call.
    /// `sides` of a picture are as for relight::MovingEye::look().
    [[nodiscard]] std::span<const glm::vec3> look(const glm::vec3& eye,
                                                  const EyeOptions& options = {},
                                                  std::span<const glm::vec4> sides = {}) {
        return eye_.look(eye, lit_.radiance(), options, sides);
    }

    [[nodiscard]] const EyeReport& report() const { return eye_.report(); }
    /// [num_receivers] the receivers' surfaces with their highlights.
    [[nodiscard]] std::span<const prt::Surface> surfaces() const { return surfaces_; }
    /// The mean roughness of the receivers with highlights.
    [[nodiscard]] float mean_roughness() const;
    /// How many receivers are smoother than relight::NarrowestLiveRoughness: their highlights come
    /// out wider.
    [[nodiscard]] std::size_t num_too_smooth() const;

private:
    const LitScene& lit_;
    std::vector<prt::Surface> surfaces_;
    relight::MovingEye eye_;
};

} // namespace relumine
