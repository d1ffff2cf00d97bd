// What the page draws of a mesh besides its light: colours, textures, which triangles are the
// floor.
#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "app/web/web_files.h"
#include "files/json.h"
#include "relumine/in/scene.h"

namespace relumine::app {

struct WebLook {
    /// look.bin.gz, and the images of textures
    WebFiles files;
    /// Members `look` and `floor` of scene.json
    files::Json look, floor;
};

/// Returns what the page multiplies each vertex's light with where there is no texture: never 0, so
/// that what glows can be divided by it.
[[nodiscard]] std::vector<glm::vec3> web_albedo(const Scene& scene);

/// Surfaces with live highlights (relumine/light/live_eye.h) have what the page draws these with.
/// Others are matte: what they mirror counts as colour.
[[nodiscard]] WebLook web_look(const Scene& scene);

/// Returns a scene with live highlights whose vertices glow as the page's do, which multiplies with
/// the textures itself.
[[nodiscard]] Scene with_page_glow(Scene scene);

/// What the page does not show of the highlights that it has, in words.
[[nodiscard]] std::vector<std::string> left_out_of_highlights(const Scene& scene);

} // namespace relumine::app
