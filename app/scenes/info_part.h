// `relumine info` of a plan and of a part: files that are on their way to a scene.
#pragma once

#include <string>

#include "app/session.h"

namespace relumine::app {

/// Says what a plan plans.
///
/// Throws:  as prt::load_plan().
void describe_plan(const std::string& path, const Session& session);

/// Says which part of what a file is.
///
/// Throws:  as prt::part_facts().
void describe_part(const std::string& path, const Session& session);

} // namespace relumine::app
