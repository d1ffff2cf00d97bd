// A scene under light: what a program that relights keeps in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/texel_rectangle.h"
#include "prt/parts/scene_part.h"
#include "prt/team.h"
#include "prt/visibility/blockers.h"
#include "relight/relighter.h"
#include "relumine/in/precompute_options.h"
#include "relumine/in/scene.h"
#include "relumine/in/scene_rays.h"
#include "relumine/light/bounces.h"
#include "relumine/light/edited_environment.h"
#include "relumine/light/lamps.h"
#include "relumine/light/light.h"
#include "relumine/light/lighting.h"
#include "relumine/light/listed_light.h"
#include "relumine/light/mirrors.h"
#include "relumine/light/shared_receivers.h"

namespace relumine {

class SceneMoves;

struct LightOptions {
    /// Lights the sun through its cluster too, without shadow rays of its own: faster, softer
    bool clusters_only = false;
    /// Order of the spherical harmonics that LitScene::harmonics() returns: 2 or 3. 0: none.
    std::uint32_t harmonics = 0;
    /// Rays that find the highlights of a pixel that are not stored. 0: none.
    std::uint32_t highlight_rays = DefaultHighlightRays;
    /// What keeps sharp lights and distant lights from the receivers, as
    /// PrecomputeOptions::blockers. Null: the scene's triangles. Pictures trace the mesh all the
    /// same, and so do questions: verify(), sees().
    std::shared_ptr<const prt::Blockers> blockers = {};
    /// The processes that share the light of a part, each with its own. It must outlive the
    /// LitScene. Null: this one has no others.
    prt::Team* team = nullptr;
    /// The scene's file, for what is said where processes have different ones
    std::filesystem::path path = {};
};

/// What LitScene::bounce() does.
struct Bouncing {
    /// [num_receivers] what pictures multiply the radiance with, as bounce_albedo(). Empty: albedo
    /// and limits of the call before.
    std::span<const glm::vec3> albedo = {};
    BounceLimits limits = {};
    /// Goes one bounce on from the bounces of the light before, for light that changes while it is
    /// looked at.
    bool is_step = false;
};

/// Owns a scene, its ray accelerators and its light, so that nothing can dangle. The light is a sum
/// of terms (relumine/light/terms.h). Movable; references to its parts stay valid when it is moved.
///
///     relumine::LitScene lit(relumine::load_scene("bunny.prt"));
///     lit.light(relumine::load_environment("grace.exr"));
///     save(lit, "bunny.png");
///
/// Where processes share the light, all call the same functions in the same order, from one thread
/// each. The light is that of one process, bit by bit, and the first process has it.
///
/// Threads: one thread at a time may call what is not const. Every result is the same bit by bit
///          for any number of threads.
/// Memory:  the scene, about 100 bytes per triangle for its rays, and about 1 KB for 16 receivers.
///          A part: the mesh, all receivers, the part's share of the counts and of the rows of
///          bounces, and the light of all receivers.
class LitScene {
public:
    /// Builds the ray accelerators, O(n log n); nothing is lit yet.
    ///
    /// Throws:  std::invalid_argument for a transfer of other receivers, and for clusters_only with
    ///          a scene that has no clusters.
    explicit LitScene(Scene scene, const LightOptions& options = {});
    /// Shares the scene with others, each in a light of its own.
    explicit LitScene(std::shared_ptr<const Scene> scene, const LightOptions& options = {});
    /// Has a part of the receivers: those of this process of a team, or of one that has no others.
    ///
    /// Throws:  also std::runtime_error where the first process has another scene.
    explicit LitScene(prt::ScenePart part, const LightOptions& options = {});

    LitScene(LitScene&&) noexcept;
    LitScene& operator=(LitScene&&) noexcept;
    ~LitScene();

    [[nodiscard]] const Scene& scene() const;
    [[nodiscard]] const SceneRays& rays() const;
    /// The direct light of this process's receivers, without added lights.
    ///
    /// Throws:  std::invalid_argument for a scene without clusters.
    [[nodiscard]] const relight::Relighter& relighter() const;
    /// The environment with its layers and its turn: what edits them.
    [[nodiscard]] EditedEnvironment& environment();
    [[nodiscard]] const EditedEnvironment& environment() const;
    [[nodiscard]] const SceneBounces& bounces() const;
    [[nodiscard]] const SceneLamps& lamps() const;
    [[nodiscard]] const SceneMirrors& mirrors() const;
    /// What moves groups of the scene's mesh (include relumine/light/scene_moves.h).
    [[nodiscard]] SceneMoves& moves();

    /// Lights the scene [JN, Eq. 8]. Layers and the turn of set_rotation() stay: a new environment
    /// is turned as well. A list without one takes the layers away, with the history. Bounces go
    /// until the next call of bounce().
    ///
    /// Throws:  std::invalid_argument for a map without texels, radiance that is not finite or
    ///          negative, a direction that is not of unit length, an environment binned for another
    ///          scene or for a scene without clusters; std::runtime_error where the first process
    ///          has other light.
    /// Cost:    milliseconds, see docs/measurements.md.
    UpdateReport light(Light light);

    /// Adds the light that surfaces send to each other to radiance() and lighting(), all of its
    /// bounces or so many. Radiance stays that of the receivers' own surfaces, or for albedo 1.
    ///
    /// Throws:  std::invalid_argument for a scene without bounces, and as
    ///          relight::BounceLight::set_albedo(); std::logic_error before the first light() and
    ///          without an albedo.
    /// Cost:    milliseconds, see docs/measurements.md.
    BounceReport bounce(const Bouncing& how = {});

    /// Dims and colours the scene's own lamps, whose light is added to that of light(): factors on
    /// what they give, in place of those before.
    ///
    /// Throws:  std::invalid_argument for a name that no lamp of the scene has; nothing has changed
    ///          then.
    /// Cost:    O(receivers) once the lamp's light is there. A name that the call before had not
    ///          costs some 20 rays a receiver, and a solution of bounces.
    void dim(std::vector<EmissionGain> gains);

    /// Sets the roughness of highlights that follow the eye (relumine/in/scene.h). The light stays
    /// as it is; a LiveEye must take the surfaces.
    ///
    /// Throws:  as relumine::set_roughness(); std::logic_error where the scene is shared.
    void set_roughness(float roughness);

    /// Outgoing radiance of this process's receivers, in their order and the unit of the
    /// environment's; without materials for albedo 1. Empty before the first light().
    [[nodiscard]] std::span<const glm::vec3> radiance() const;

    /// Returns the light that arrives at the receivers as spherical harmonics (docs/harmonics.md),
    /// [num_receivers][order^2] in the receivers' order, for any normal. At a surface's own normal
    /// their irradiance is that of all light, bounces included; away from it the bounces count as
    /// if they came from around the normal. Of processes that share the light, all call it; the
    /// first gets the light of all, the others get none.
    ///
    /// Throws:  std::logic_error before the first light() and without LightOptions::harmonics.
    [[nodiscard]] std::vector<glm::vec3> harmonics() const;

    /// Returns what a picture is drawn of, or its radiance alone. It points into this object, and
    /// is good until the light changes. Of processes that share the light, all call it; the first
    /// gets the light of all, the others get none.
    ///
    /// Throws:  std::logic_error before the first light().
    [[nodiscard]] Lighting lighting(bool is_drawn = true) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// What lights the scene, layers included; black under a light list, without texels before the
/// first light().
[[nodiscard]] const cubemap::CubeMap& environment_of(const LitScene& lit);
/// Whether an environment lights the scene.
[[nodiscard]] bool has_environment(const LitScene& lit);

/// What surfaces send to all receivers, as a part of the radiance: [num_receivers]; empty before
/// LitScene::bounce().
[[nodiscard]] std::vector<glm::vec3> bounced(const LitScene& lit);

/// Sums an environment into the scene's clusters, for LitScene::light(). An environment that comes
/// again need not be summed again.
///
/// Throws:  std::invalid_argument as LitScene::light().
/// Cost:    O(6 R^2). What is returned holds the map; copies of it share the map.
[[nodiscard]] BinnedEnvironment bin(const LitScene& lit, cubemap::CubeMap environment);

} // namespace relumine
