#include "viewer/multisample_target.h"

#include <algorithm>

namespace relumine::viewer {

void MultisampleTarget::begin(int width, int height) {
    width = std::max(width, 1);
    height = std::max(height, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    if (width != width_ || height != height_) {
        width_ = width;
        height_ = height;
        constexpr GLint Samples = 8;
        GLint most = 0;
        glGetIntegerv(GL_MAX_SAMPLES, &most);
        const auto allocate = [&](const GlRenderbuffer& buffer, GLenum format, GLenum place) {
            glBindRenderbuffer(GL_RENDERBUFFER, buffer.id());
            glRenderbufferStorageMultisample(GL_RENDERBUFFER, std::min(Samples, most), format,
                                             width, height);
            glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer.id());
        };
        allocate(color_, GL_RGBA8, GL_COLOR_ATTACHMENT0);
        allocate(depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    }
    glViewport(0, 0, width, height);
}

void MultisampleTarget::show_at(int x, int y) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width_, height_, x, y, x + width_, y + height_, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

} // namespace relumine::viewer
