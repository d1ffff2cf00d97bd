// A scene that is lit by all processes of a team: each has the counts of its own receivers alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "prt/parts/scene_part.h"
#include "prt/team.h"
#include "relight/binned_environment.h"
#include "relumine/lit_scene.h"
#include "relumine/output.h"

namespace relumine {

/// Throws where processes light another scene, or by another environment, than the first. Without
/// an environment it looks at the scene alone. `path` is the scene's.
///
/// Throws:  std::runtime_error "path: expected X, got Y".
void require_same(prt::Team& team, const std::filesystem::path& path,
                  const cubemap::CubeMap* environment = nullptr);

/// Lights a scene as a Relighter of all of it does, bit by bit, for any number of processes.
///
/// All processes call the same functions in the same order, from one thread each.
///
/// Memory:  the mesh, all receivers, the part's share of the counts and of the rows of bounces, and
///          the light of all receivers.
/// Throws:  what the team throws where another process has failed.
class SharedLight {
public:
    /// `part` is the process's part of the scene in `path`, as prt::load_scene_part() reads it.
    ///
    /// Throws:  std::runtime_error where the first process has another scene.
    SharedLight(prt::Team& team, const std::filesystem::path& path, prt::ScenePart&& part,
                const LightOptions& options = {});
    ~SharedLight();
    SharedLight(SharedLight&&) noexcept;
    SharedLight& operator=(SharedLight&&) noexcept;

    /// The whole scene, without its counts, so that it can be drawn but not be lit.
    [[nodiscard]] const LitScene& lit() const;
    [[nodiscard]] bool is_first() const;
    [[nodiscard]] prt::Team& team() const;

    /// As Relighter::set_environment().
    ///
    /// Throws:  std::runtime_error where the first process has another environment.
    RelightTimes light(cubemap::CubeMap environment);
    /// As Relighter::set_frame(). Throws as light().
    UpdateReport set_frame(BinnedEnvironment frame, double bound = 0.0);
    /// As Relighter::set_lights().
    ///
    /// Throws:  std::runtime_error where the first process has other lights.
    RelightTimes set_lights(std::span<const lights::DistantLight> lights);
    /// Forgets the light, so that the next frame is as the first.
    void restart();

    /// Lets light bounce from now on; `bounces` is what bounces_of() gives for the scene.
    void set_bounces(const relight::SurfaceBounces& bounces);
    /// Adds the bounces to the present light; does nothing where set_bounces() was not called.
    /// `more` is as for Relighter::bounce().
    BounceReport bounce(std::span<const glm::vec3> more = {});
    /// As Relighter::diffuse_radiance(), of all receivers, in all processes.
    [[nodiscard]] std::vector<glm::vec3> diffuse_radiance();

    /// The light of all receivers, in the first process. It points into this object, and is good
    /// until the light changes. The others have no light.
    [[nodiscard]] Lighting lighting();
    /// What bounce() added, [num_receivers]; empty without it.
    [[nodiscard]] std::span<const glm::vec3> bounced() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace relumine
