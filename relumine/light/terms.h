// Light is a sum: what each term of it adds to the receivers of a scene. A further kind of light is
// a further term, and a line of LitScene's list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/relighter.h"
#include "relight/sharp/sharp_lights.h"
#include "relumine/light/bounces.h"
#include "relumine/light/lamps.h"
#include "relumine/light/listed_light.h"
#include "relumine/light/mirrors.h"
#include "relumine/light/shared_receivers.h"

namespace relumine {

/// What arrives at the receivers of this process.
struct ArrivingLight {
    std::uint32_t order = 0;
    /// [receivers][order^2] as spherical harmonics
    std::vector<glm::vec3> harmonics = {};
    /// [receivers] radiance that surfaces send of it, where directions are not known. Empty: none.
    std::vector<glm::vec3> sent = {};
};

/// A term of a scene's light: a view of what has the light.
class LightTerm {
public:
    LightTerm() = default;
    LightTerm(const LightTerm&) = delete;
    LightTerm& operator=(const LightTerm&) = delete;
    virtual ~LightTerm() = default;

    /// Whether there is any of it.
    [[nodiscard]] virtual bool is_lit() const = 0;
    /// Adds its radiance to that of this process's receivers, which has the terms before it.
    virtual void add_radiance(std::span<glm::vec3> own) const = 0;
    /// Adds the radiance without that of lights().
    virtual void add_soft(std::span<glm::vec3> own) const { add_radiance(own); }
    /// Adds what arrives.
    virtual void add_harmonics(ArrivingLight& own) const = 0;
    /// Returns the lights that pictures trace one by one.
    [[nodiscard]] virtual std::vector<relight::SharpLight> lights() const { return {}; }
    /// Returns the radiance, for albedo 1, of a level floor that nothing shades.
    [[nodiscard]] virtual glm::dvec3 open_floor() const { return glm::dvec3(0.0); }
};

/// The clusters' light, of an environment or of a list alone, with its sharp lights.
class ClusterTerm final : public LightTerm {
public:
    explicit ClusterTerm(const relight::Relighter& relighter) : relighter_(relighter) {}
    [[nodiscard]] bool is_lit() const override { return true; }
    void add_radiance(std::span<glm::vec3> own) const override;
    void add_soft(std::span<glm::vec3> own) const override;
    void add_harmonics(ArrivingLight& own) const override;
    [[nodiscard]] std::vector<relight::SharpLight> lights() const override;
    [[nodiscard]] glm::dvec3 open_floor() const override;

private:
    const relight::Relighter& relighter_;
};

/// What surfaces send on of the environment's light and of a list's.
class BounceTerm final : public LightTerm {
public:
    BounceTerm(const SceneBounces& bounces, const SharedReceivers& receivers)
        : bounces_(bounces), receivers_(receivers) {}
    [[nodiscard]] bool is_lit() const override { return !bounces_.bounced().empty(); }
    void add_radiance(std::span<glm::vec3> own) const override;
    void add_harmonics(ArrivingLight& own) const override;

private:
    const SceneBounces& bounces_;
    const SharedReceivers& receivers_;
};

/// The light of the scene's own lamps, and what surfaces send on of it.
class LampTerm final : public LightTerm {
public:
    LampTerm(const SceneLamps& lamps, const SharedReceivers& receivers)
        : lamps_(lamps), receivers_(receivers) {}
    [[nodiscard]] bool is_lit() const override { return !lamps_.direct().empty(); }
    void add_radiance(std::span<glm::vec3> own) const override;
    void add_harmonics(ArrivingLight& own) const override;

private:
    const SceneLamps& lamps_;
    const SharedReceivers& receivers_;
};

/// A list of distant lights beside an environment, or in a scene without clusters.
class ListTerm final : public LightTerm {
public:
    explicit ListTerm(const ListedLight& listed) : listed_(listed) {}
    [[nodiscard]] bool is_lit() const override { return !listed_.radiance.empty(); }
    void add_radiance(std::span<glm::vec3> own) const override;
    void add_soft(std::span<glm::vec3> own) const override;
    void add_harmonics(ArrivingLight& own) const override;
    [[nodiscard]] std::vector<relight::SharpLight> lights() const override;
    [[nodiscard]] glm::dvec3 open_floor() const override;

private:
    const ListedLight& listed_;
};

/// What rays find that highlights mirror, of the terms before it too. Pictures find it by rays of
/// their own, and harmonics hold no highlights.
class MirrorTerm final : public LightTerm {
public:
    MirrorTerm(const SceneMirrors& mirrors, const relight::Relighter& relighter,
               const SceneBounces& bounces, const SceneLamps& lamps,
               const SharedReceivers& receivers)
        : mirrors_(mirrors), relighter_(relighter), bounces_(bounces), lamps_(lamps),
          receivers_(receivers) {}
    [[nodiscard]] bool is_lit() const override { return mirrors_.is_needed(); }
    void add_radiance(std::span<glm::vec3> own) const override;
    void add_soft(std::span<glm::vec3>) const override {}
    void add_harmonics(ArrivingLight&) const override {}

private:
    const SceneMirrors& mirrors_;
    const relight::Relighter& relighter_;
    const SceneBounces& bounces_;
    const SceneLamps& lamps_;
    const SharedReceivers& receivers_;
};

} // namespace relumine
