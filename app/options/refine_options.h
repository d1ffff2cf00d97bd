// --refine and what belongs to it: more vertices where light changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session.h"
#include "relumine/mesh.h"

namespace relumine::app {

class RefineOptionGroup {
public:
    /// For `precompute`: --refine [ERROR] and limits, which need it.
    void add_to_precompute(Command& command);
    /// For `mesh refine`: --error and limits. Light is asked unless --max-edge alone is given.
    void add_to_refine(Command& command);

    /// Refuses limits that contradict each other, or have nothing to limit.
    void check() const;
    /// Whether the mesh is to be refined.
    [[nodiscard]] bool is_wanted() const;

    /// Refines the mesh, and says and reports what was done.
    [[nodiscard]] Mesh refined(Mesh mesh, std::optional<float> bias, Session& session) const;

private:
    void add_limits(Command& command);

    /// Empty: not asked for.
    std::optional<float> error_;
    bool is_command_ = false;
    /// 0: no limit.
    std::uint32_t max_vertices_ = 0;
    std::optional<float> min_edge_;
    std::optional<float> max_edge_;
    bool curved_ = false;
    /// An environment's file. Empty: none
    std::string light_;
};

} // namespace relumine::app
