// A scene and its light, as the C door shows them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "prt/scene/relighting_file.h"
#include "relight/bounces/bounce_light.h"
#include "relight/relighter.h"
#include "runtime/caller_jobs.h"

namespace relumine::runtime {

/// Lights a scene on the caller's threads. Its functions do what those of the C header say.
///
/// Throws:  std::invalid_argument for wrong arguments, NotLit, NotThere.
class RuntimeScene {
public:
    struct NotLit {
        const char* message = "expected a scene with light, got one without";
    };
    struct NotThere {
        const char* what;
    };

    RuntimeScene(prt::RelightingScene given, std::uint32_t harmonics, const CallerJobs& jobs);
    /// Its relighter refers to its scene.
    RuntimeScene(const RuntimeScene&) = delete;
    RuntimeScene& operator=(const RuntimeScene&) = delete;

    [[nodiscard]] const prt::Scene& scene() const { return scene_; }
    [[nodiscard]] const CallerJobs& jobs() const { return jobs_; }
    [[nodiscard]] std::size_t num_receivers() const { return scene_.receivers.num_own(); }
    /// 0, 4 or 9.
    [[nodiscard]] std::size_t num_harmonics() const;

    void light(cubemap::CubeMap map);
    void light(std::span<const lights::DistantLight> lights);
    void turn(double degrees) { turn(degrees, std::numeric_limits<std::uint32_t>::max()); }
    void turn(double degrees, std::uint32_t most_resolution);
    void update(const cubemap::TexelRectangle& rectangle, std::span<const glm::vec3> radiance);

    void set_albedo(std::span<const glm::vec3> albedo);
    void bounce(const relight::BounceLimits& limits, bool is_step);

    void require_light() const;
    void require_environment() const;
    /// The light of the surfaces themselves, and what bounces add.
    [[nodiscard]] glm::vec3 radiance(std::size_t receiver) const;
    [[nodiscard]] std::vector<glm::vec3> harmonics() const;

    /// Without texels where no cube map lights the scene.
    [[nodiscard]] const cubemap::CubeMap& environment() const { return relighter_.environment(); }
    void visible_parts(std::span<const glm::vec3> directions, float radius,
                       std::span<std::uint8_t> parts) const;
    [[nodiscard]] cubemap::CubeMap contribution(std::uint32_t receiver) const;

private:
    CallerJobs jobs_;
    prt::Scene scene_;
    relight::Relighter relighter_;
    bool has_harmonics_;
    /// The environment before its first turn; without texels where there was none.
    cubemap::CubeMap unturned_;
    /// The environment before its turns, halved for the last turn that asked for a coarser one.
    cubemap::CubeMap coarse_;
    bool is_lit_ = false;
    /// Set where the scene has bounces and they have an albedo.
    std::optional<relight::BounceLight> bounces_;
    /// The matrix and albedo of bounces_, and how light bounced last.
    relight::SurfaceBounces surface_bounces_;
    bool has_bounced_ = false;
};

} // namespace relumine::runtime
