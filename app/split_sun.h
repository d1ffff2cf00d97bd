// --split-sun: the sun of an environment as a file of its own.
#pragma once

#include <filesystem>
#include <string>

#include "app/session.h"
#include "cubemap/environment.h"

namespace relumine::app {

/// Where the sun of a map goes: "out.exr" -> "out.sun.json".
[[nodiscard]] std::filesystem::path sun_path(const std::filesystem::path& map_path);

/// Takes the sun out of an image (the sky around fills its place) and writes it as a light list of one light to sun_path(map_path).
/// The caller writes the map. Returns the sun's figures for the session's report. Throws std::runtime_error "path: expected a sun
/// ..., got none: why" where there is none; `image_path` names the image in it.
nlohmann::json split_sun(cubemap::EnvironmentImage& image, const std::string& image_path,
                         const std::filesystem::path& map_path, const Session& session);

} // namespace relumine::app
