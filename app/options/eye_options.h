// Options of highlights that follow the eye, for the commands that have them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include <glm/vec3.hpp>

#include "app/session.h"
#include "relumine/light/live_eye.h"
#include "relumine/options/option_table.h"

namespace relumine::app {

/// --glossy-tolerance
[[nodiscard]] OptionRow glossy_tolerance_row(EyeOptions& options);

/// Throws std::runtime_error "path: expected X, got Y" for a scene without live highlights.
void require_live_highlights(const Scene& scene, const std::filesystem::path& path);

/// Warns where an eye, if there is one, is inside of the mesh. It is a place of the mesh's file.
void warn_of_eye_inside(const LitScene& lit, const std::optional<glm::dvec3>& eye,
                        const Session& session);

/// Warns of highlights that come out wider than they are.
void warn_of_smooth_surfaces(std::size_t num_receivers, const Session& session);

} // namespace relumine::app
