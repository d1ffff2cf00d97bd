// What the surfaces of a precomputed scene are made of, and their highlights.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::app {

/// --material and --glossy-tolerance.
class SurfaceOptions {
public:
    void add_to(Command& command);

    /// Refuses wrong usage before any work is done.
    void check() const;

    /// Gives the scene's receivers their surfaces: the mesh's materials, changed by the options.
    /// None where there are neither.
    void apply(prt::Scene& scene, Session& session) const;

    [[nodiscard]] float glossy_tolerance() const { return glossy_tolerance_; }

    /// Computes the glossy part of the scene's transfer, where its receivers have highlights and an
    /// eye. `precompute` is what the diffuse part was computed with, its checkpoint included.
    /// Throws std::runtime_error when it takes more than `max_bytes`, or would by an estimate;
    /// `mesh` is for that message.
    void precompute_highlights(prt::Scene& scene, const prt::RayScene& rays,
                               const prt::PrecomputeOptions& precompute,
                               std::optional<std::uint64_t> max_bytes, const std::string& mesh,
                               Session& session, Report& report) const;

private:
    std::vector<std::string> materials_;
    float glossy_tolerance_ = prt::GlossyOptions{}.tolerance;
};

} // namespace relumine::app
