#include "viewer/cube_texture.h"

#include <array>

namespace relumine::viewer {

namespace {

/// By cubemap::Face; +Z and -Z change places.
constexpr std::array<GLenum, cubemap::NumFaces> Slots = {
    GL_TEXTURE_CUBE_MAP_POSITIVE_X, GL_TEXTURE_CUBE_MAP_NEGATIVE_X, GL_TEXTURE_CUBE_MAP_POSITIVE_Y,
    GL_TEXTURE_CUBE_MAP_NEGATIVE_Y, GL_TEXTURE_CUBE_MAP_NEGATIVE_Z, GL_TEXTURE_CUBE_MAP_POSITIVE_Z};

} // namespace

CubeTexture::CubeTexture() {
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_.id());
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

void CubeTexture::upload(const cubemap::CubeMap& map,
                         std::span<const cubemap::TexelRectangle> rectangles) {
    if (map.resolution == 0)
        return;
    const auto r = static_cast<GLsizei>(map.resolution);
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (map.resolution != resolution_) {
        // Nine bits and a shared exponent: four bytes per texel, no overflow at a sun, exact enough
        // for a screen.
        for (const cubemap::Face face : cubemap::AllFaces)
            glTexImage2D(Slots[static_cast<std::size_t>(face)], 0, GL_RGB9_E5, r, r, 0, GL_RGB,
                         GL_FLOAT, &map.at(face, 0, 0));
        resolution_ = map.resolution;
        return;
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, r);
    for (const cubemap::TexelRectangle& part : rectangles)
        if (part.x1 > part.x0 && part.y1 > part.y0)
            glTexSubImage2D(Slots[static_cast<std::size_t>(part.face)], 0,
                            static_cast<GLint>(part.x0), static_cast<GLint>(part.y0),
                            static_cast<GLsizei>(part.x1 - part.x0),
                            static_cast<GLsizei>(part.y1 - part.y0), GL_RGB, GL_FLOAT,
                            &map.at(part.face, part.x0, part.y0));
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void CubeTexture::bind(GLenum unit) const {
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture_.id());
    glActiveTexture(GL_TEXTURE0);
}

std::string cube_lookup_source() {
    return "vec3 looked_up(samplerCube cube, vec3 w) { return texture(cube, vec3(w.xy, -w.z)).rgb; "
           "}\n";
}

} // namespace relumine::viewer
