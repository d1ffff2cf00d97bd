// Options of highlights that follow the eye, for the commands that have them.
#pragma once

#include <filesystem>

#include "app/session.h"
#include "relumine/live_eye.h"
#include "relumine/option_table.h"

namespace relumine::app {

/// --glossy-tolerance
[[nodiscard]] OptionRow glossy_tolerance_row(EyeOptions& options);
/// --glossy-budget
[[nodiscard]] OptionRow glossy_budget_row(EyeOptions& options);

/// Throws std::runtime_error "path: expected X, got Y" for a scene without live highlights.
void require_live_highlights(const Scene& scene, const std::filesystem::path& path);

/// Warns of highlights that come out wider than they are.
void warn_of_smooth_surfaces(const LiveEye& eye, const Session& session);

} // namespace relumine::app
