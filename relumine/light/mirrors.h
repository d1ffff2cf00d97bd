// Highlights that a precompute left out: rays find them whenever the light changes.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "relight/relighter.h"
#include "relumine/in/emission.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_rays.h"

namespace relumine {

/// Rays of a pixel that find what its highlight mirrors.
inline constexpr std::uint32_t DefaultHighlightRays = 16;

/// What highlights of receivers mirror: the environment without its sharp lights, whose highlights
/// are exact, and other surfaces where vertices know their light.
class SceneMirrors {
public:
    /// `num_rays` are those of a pixel, or of a receiver that is none. Scene and rays must outlive
    /// this object.
    SceneMirrors(const Scene& scene, const SceneRays& rays, std::uint32_t num_rays);

    [[nodiscard]] bool is_needed() const { return rays_per_pixel_ != 0; }
    /// Whether surfaces() counts.
    [[nodiscard]] bool shows_surfaces() const { return scene_->receivers.num_added != 0; }

    /// What lights the surfaces in the mirror.
    struct Surfaces {
        /// [num_receivers] radiance, the vertices behind pixels included. Empty: they are black.
        std::span<const glm::vec3> radiance = {};
        /// [num_receivers] what vertices send on of what they receive; empty: their surfaces say.
        std::span<const glm::vec3> albedo = {};
        std::span<const EmissionGain> emission = {};
    };

    /// Adds what the highlights mirror to the radiance of some receivers.
    ///
    /// Shape:   radiance is [receivers.size()].
    /// Cost:    num_rays rays a pixel, fewer where its highlight is narrow.
    void add(const relight::Relighter& light, const Surfaces& surfaces,
             std::span<const std::uint32_t> receivers, std::span<glm::vec3> radiance) const;

private:
    /// Returns how many rays of a pixel a receiver gets.
    [[nodiscard]] std::uint32_t rays_of(std::size_t receiver) const;

    const Scene* scene_;
    const SceneRays* rays_;
    std::uint32_t rays_per_pixel_ = 0;
};

} // namespace relumine
