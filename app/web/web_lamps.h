// The light of a scene's own lamps, each by itself: the page adds them up with factors.
#pragma once

#include "app/session.h"
#include "app/web/web_files.h"
#include "files/json.h"
#include "relumine/in/scene.h"

namespace relumine::app {

struct WebLamps {
    WebFiles files;
    /// Member `lamps` of scene.json: {name, file, bounced, glow}. Files are half floats
    /// [num_vertices][3]: radiance for albedo 1, what bounces add to it, and what the lamp itself
    /// glows. Without live highlights the glow is in `file`, divided by the albedo that the page
    /// shows.
    files::Json list = files::Json::Array{};
};

/// Traces the light of each lamp.
[[nodiscard]] WebLamps web_lamps(const Scene& scene, Session& session);

} // namespace relumine::app
