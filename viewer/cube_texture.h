// A cube map of radiance on the graphics card.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "relumine/in/environment_files.h"
#include "relumine/light/layers.h"
#include "viewer/gl_objects.h"

namespace relumine::viewer {

/// A cube texture. OpenGL's cube maps are seen from outside, ours from inside. So each face goes to
/// the slot of its mirror image in z, and shaders look up (x, y, -z), as cube_lookup_source() does.
class CubeTexture {
public:
    CubeTexture();
    /// Uploads the rectangles, or the whole map where the resolution is new.
    void upload(const cubemap::CubeMap& map, std::span<const cubemap::TexelRectangle> rectangles);
    [[nodiscard]] std::uint32_t resolution() const { return resolution_; }
    void bind(GLenum unit) const;

private:
    GlTexture texture_;
    std::uint32_t resolution_ = 0;
};

/// Returns GLSL for `vec3 looked_up(samplerCube cube, vec3 direction)`.
[[nodiscard]] std::string cube_lookup_source();

} // namespace relumine::viewer
