// The light of a scene's own lamps.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/bounces/bounce_light.h"
#include "relumine/in/emission.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_rays.h"
#include "relumine/light/bounces.h"

namespace relumine {

/// Keeps the light of each lamp that has a factor of its own, and of all others together. Light is
/// linear: another factor is another weight of the sum.
class SceneLamps {
public:
    /// Scene and rays must outlive this object.
    SceneLamps(const Scene& scene, const SceneRays& rays);

    /// Sets the factors.
    ///
    /// Throws:  std::invalid_argument as require_lamps(); nothing has changed then.
    /// Cost:    none, but find() must trace new names.
    void set(std::vector<EmissionGain> gains);
    [[nodiscard]] const std::vector<EmissionGain>& gains() const { return gains_; }

    /// Finds what is not there yet of each lamp's light: rays to its surface, and its bounces after
    /// set_bounces(). Sums all.
    ///
    /// Cost:    some 20 rays a receiver and a solution of bounces for each new name; otherwise
    ///          O(receivers) for each name.
    void find();
    /// The bounces that the last find() had to find, of all names: the most products, and all
    /// seconds.
    [[nodiscard]] const BounceReport& report() const { return report_; }
    /// Lets the light of lamps bounce as that of an environment does. The next find() finds it.
    void set_bounces(const relight::SurfaceBounces& surfaces, const relight::SharedRows& rows);
    /// Ends the bounces until the next set_bounces().
    void forget_bounces();
    /// The scene is another: the next find() traces all rays anew. Bounces stay those of before.
    void forget_rays();
    /// The scene is another: the next find() finds all light anew, without bounces.
    void forget_light();

    /// [num_receivers] what lamps give to the receivers' own surfaces without a bounce; empty
    /// without lamps. Good until the next find().
    [[nodiscard]] std::span<const glm::vec3> direct() const { return direct_; }
    /// [num_receivers] what further bounces add; empty without them.
    [[nodiscard]] std::span<const glm::vec3> bounced() const { return bounced_; }

private:
    /// Lamps with the same factor.
    struct Source {
        /// Empty: all that have no name in the factors.
        std::string name = {};
        /// [num_receivers] for albedo 1; empty until it is found.
        std::vector<glm::vec3> light = {};
        /// [num_receivers] of the receivers' own surfaces; empty until it is found.
        std::vector<glm::vec3> bounced = {};
    };
    [[nodiscard]] std::vector<glm::vec3> light_of(const Source& source) const;

    const Scene* scene_;
    const SceneRays* rays_;
    std::vector<EmissionGain> gains_;
    std::vector<Source> sources_;
    SceneBounces bounces_;
    bool bounces_now_ = false;
    BounceReport report_;
    std::vector<glm::vec3> direct_, bounced_;
};

} // namespace relumine
