// The light that the surfaces of a scene send to each other.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/transfer/transfer.h"
#include "relight/bounces/bounce_light.h"
#include "relumine/in/scene.h"

namespace relumine {

using relight::BounceLimits;
using relight::BounceReport;

/// Throws:  std::invalid_argument for a scene without bounces.
void require_bounces(const Scene& scene);

/// Returns what the light of a scene needs to bounce. `albedo` is [num_receivers] what pictures
/// multiply the radiance with, as bounce_albedo(). The scene must outlive the result.
///
/// Throws:  as require_bounces().
[[nodiscard]] relight::SurfaceBounces
bounces_of(const Scene& scene, std::span<const glm::vec3> albedo, const BounceLimits& limits = {});

/// Keeps how light bounces in a scene, and what surfaces add to its receivers' direct light.
/// Surfaces are Lambert for it; what mirrors would show of other surfaces is left out.
class SceneBounces {
public:
    /// The scene must outlive this object. `rows` are this process's.
    ///
    /// Throws:  as relight::BounceLight; nothing has changed then.
    void set(const Scene& scene, relight::SurfaceBounces surfaces,
             const relight::SharedRows& rows = {});
    [[nodiscard]] bool is_set() const { return light_.has_value(); }
    [[nodiscard]] const relight::SurfaceBounces& surfaces() const { return surfaces_; }

    /// Finds the bounces of direct light from nothing, so that equal light gives equal bits. For
    /// the light of the call before, they are there already.
    ///
    /// Shape:   `direct` is [num_receivers], for albedo 1.
    BounceReport find(std::span<const glm::vec3> direct);
    /// Goes one bounce on from those of the light before: for light that changes while it is looked
    /// at. Limits with a number of bounces have no light to go on from; they are found from
    /// nothing.
    BounceReport step(std::span<const glm::vec3> direct);
    /// The direct light is another. Its bounces stay those of the light before.
    void unsettle() { is_settled_ = false; }
    /// Ends the bounces until the next call.
    void forget();
    void unset() { *this = SceneBounces(); }

    /// [num_receivers] in the receivers' order; empty without bounces.
    [[nodiscard]] std::span<const glm::vec3> bounced() const { return bounced_; }
    /// Returns the light that points in space get from surfaces (relight::BounceLight). Only where
    /// bounced() is not empty.
    [[nodiscard]] std::vector<glm::vec3> point_harmonics(std::uint32_t order) const {
        return light_->point_harmonics(order);
    }
    /// Whether more steps would change nothing that can be seen.
    [[nodiscard]] bool is_settled() const { return !is_set() || is_settled_; }

private:
    BounceReport take(const BounceReport& report);

    const Scene* scene_ = nullptr;
    relight::SurfaceBounces surfaces_;
    std::optional<relight::BounceLight> light_;
    bool is_settled_ = false;
    std::vector<glm::vec3> bounced_;
    /// The direct light whose bounces are in light_; empty where they are not.
    std::vector<glm::vec3> found_of_;
    BounceReport found_;
};

} // namespace relumine
