// What the surfaces of a precomputed scene are made of.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/glossy/surface_sampling.h"

namespace relumine::app {

/// --material and --glossy-tolerance.
class SurfaceOptions {
public:
    void add_to(Command& command);

    /// Refuses wrong usage before any work is done.
    void check() const;

    /// What the options make of a mesh's surfaces; empty without --material. Throws UsageError for
    /// a group that the mesh does not have.
    [[nodiscard]] prt::SurfaceOverride surface(const mesh::TriangleMesh& mesh) const;

    /// What the options make of the added floor: the last one whose group is `floor`, else white
    /// Lambert.
    [[nodiscard]] prt::Surface floor_surface() const;

    [[nodiscard]] float glossy_tolerance() const { return glossy_tolerance_; }

private:
    std::vector<std::string> materials_;
    float glossy_tolerance_ = prt::GlossyOptions{}.tolerance;
};

} // namespace relumine::app
