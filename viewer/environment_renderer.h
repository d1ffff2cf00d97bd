// Draws the environment as a lat-long. The clusters' borders, and the light that reaches a
// receiver, can lie over it.
#pragma once

#include "relumine/in/environment_files.h"
#include "relumine/light/light_parts.h"
#include "viewer/cube_texture.h"
#include "viewer/gl_objects.h"
#include "viewer/lat_long_view.h"
#include "viewer/look.h"

namespace relumine::viewer {

class EnvironmentRenderer {
public:
    explicit EnvironmentRenderer(const prt::Quadtree& quadtree);
    /// Takes the light that reaches the chosen receiver (relight::contribution_map()). The hottest
    /// colour stands for its brightest two-hundredth.
    void upload_heat(const cubemap::CubeMap& contribution);
    /// Draws into the current viewport, which must be `viewport`.
    void draw(const LatLongView& view, const PixelRectangle& viewport,
              const CubeTexture& environment, const EnvironmentLook& look) const;

private:
    GlProgram program_;
    GlProgram line_program_;
    GlVertexArray line_array_;
    GlVertexArray no_array_;
    GlBuffer lines_;
    GLsizei num_line_ends_ = 0;
    CubeTexture heat_;
    float hottest_ = 1.0f;
};

} // namespace relumine::viewer
