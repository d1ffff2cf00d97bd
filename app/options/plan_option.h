// One part of a planned precompute, and the command that joins the parts.
#pragma once

#include <string>

#include "app/session.h"
#include "relumine/in/precompute.h"
#include "relumine/in/shared_work.h"

namespace relumine::app {

/// Reads I/N of --part, parts from 1 on. Throws UsageError.
[[nodiscard]] prt::Part parse_part(const std::string& text);

/// --part of `relumine precompute`.
class PlanOption {
public:
    void add_to(Command& command);

    /// Whether the line asks for a part instead of a mesh.
    [[nodiscard]] bool is_given() const { return part_.count != 0; }
    /// Does the part of a plan. All else that the line says must suit one: the plan knows the rest.
    void run(const Command& command, const std::string& plan, const std::string& output,
             const PrecomputeWork& work, Session& session) const;

private:
    /// count is 0 until it is given.
    prt::Part part_ = {.index = 0, .count = 0};
};

} // namespace relumine::app
