// --refine and what belongs to it: more vertices where light changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/session.h"
#include "relumine/in/mesh.h"

namespace relumine::app {

/// Reports what refinement did to a mesh that has so many vertices now.
void report_refinement(const RefineReport& found, std::size_t num_vertices, Session& session);

class RefineOptionGroup {
public:
    RefineOptionGroup() { options_.error.reset(); }

    /// For `precompute`: --refine [ERROR] and limits, which need it. `--refine off` sets
    /// `keeps_vertices`.
    void add_to_precompute(Command& command, bool& keeps_vertices);
    /// For `mesh refine`: --tolerance and limits. Light is asked unless --max-edge alone is given.
    void add_to_refine(Command& command);

    /// Refuses limits that contradict each other, or have nothing to limit.
    void check() const;
    /// Whether the mesh is to be refined.
    [[nodiscard]] bool is_wanted() const;

    /// Refines the mesh, and says and reports what was done.
    [[nodiscard]] Mesh refined(Mesh mesh, std::optional<float> bias, Session& session) const;

private:
    void add(Command& command, OptionTable table);

    /// No error: not asked for
    RefineOptions options_;
    bool is_command_ = false;
    /// --vertices, --curved, --refine-for
    std::vector<Option> limits_;
    /// An environment's file. Empty: none
    std::string light_;
};

} // namespace relumine::app
