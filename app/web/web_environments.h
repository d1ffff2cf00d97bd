// The environments of a page: files to light with, pictures for the strip, and how exact the light
// is.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "app/web/web_files.h"
#include "files/json.h"
#include "relumine/in/scene.h"

namespace relumine::app {

/// Resolution of the cube map that the page lights with
inline constexpr std::uint32_t PageLightResolution = 128;

struct WebEnvironments {
    WebFiles files;
    /// Member `environments` of scene.json
    files::Json list;
    /// The largest relative L2 error
    double worst = 0.0;
};

/// Reads the environments, or makes some where there are none. Verifies the scene's light under
/// each with so many receivers; 0: none.
[[nodiscard]] WebEnvironments web_environments(const std::vector<std::string>& paths,
                                               const Scene& scene, std::size_t num_samples,
                                               Session& session);

} // namespace relumine::app
