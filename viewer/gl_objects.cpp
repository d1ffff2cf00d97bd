#include "viewer/gl_objects.h"

#include <algorithm>
#include <stdexcept>

#include <glm/gtc/type_ptr.hpp>

#include "relumine/out/pictures.h"

namespace relumine::viewer {

namespace {

GLuint compile(GLenum kind, const std::string& source) {
    const std::string whole = "#version 330 core\n" + source;
    const char* text = whole.c_str();
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint done = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (done == 0) {
        char message[1024] = {};
        glGetShaderInfoLog(shader, sizeof message, nullptr, message);
        glDeleteShader(shader);
        throw std::runtime_error(std::string("OpenGL: a shader did not compile: ") + message);
    }
    return shader;
}

/// What makes and frees the objects of each kind: the loader's pointers, which it sets when they
/// are first called.
struct ObjectFunctions {
    PFNGLGENBUFFERSPROC* make;
    PFNGLDELETEBUFFERSPROC* free;
};

ObjectFunctions functions_of(GlKind kind) {
    switch (kind) {
    case GlKind::Framebuffer:
        return {&glGenFramebuffers, &glDeleteFramebuffers};
    case GlKind::Renderbuffer:
        return {&glGenRenderbuffers, &glDeleteRenderbuffers};
    case GlKind::Buffer:
        return {&glGenBuffers, &glDeleteBuffers};
    case GlKind::VertexArray:
        return {&glGenVertexArrays, &glDeleteVertexArrays};
    case GlKind::Texture:
        break;
    }
    return {&glGenTextures, &glDeleteTextures};
}

} // namespace

GLuint make_object(GlKind kind) {
    GLuint id = 0;
    (*functions_of(kind).make)(1, &id);
    return id;
}

void free_object(GlKind kind, GLuint id) {
    (*functions_of(kind).free)(1, &id);
}

GlProgram::GlProgram(const std::string& vertex_source, const std::string& fragment_source) {
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source);
    const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
    id_ = glCreateProgram();
    glAttachShader(id_, vertex);
    glAttachShader(id_, fragment);
    glLinkProgram(id_);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint done = 0;
    glGetProgramiv(id_, GL_LINK_STATUS, &done);
    if (done == 0) {
        char message[1024] = {};
        glGetProgramInfoLog(id_, sizeof message, nullptr, message);
        glDeleteProgram(id_);
        throw std::runtime_error(std::string("OpenGL: shaders did not link: ") + message);
    }
}

GlProgram::~GlProgram() {
    glDeleteProgram(id_);
}

void GlProgram::set(const char* name, int value) const {
    glUniform1i(glGetUniformLocation(id_, name), value);
}
void GlProgram::set(const char* name, float value) const {
    glUniform1f(glGetUniformLocation(id_, name), value);
}
void GlProgram::set(const char* name, const glm::vec2& value) const {
    glUniform2fv(glGetUniformLocation(id_, name), 1, glm::value_ptr(value));
}
void GlProgram::set(const char* name, const glm::vec3& value) const {
    glUniform3fv(glGetUniformLocation(id_, name), 1, glm::value_ptr(value));
}
void GlProgram::set(const char* name, const glm::mat4& value) const {
    glUniformMatrix4fv(glGetUniformLocation(id_, name), 1, GL_FALSE, glm::value_ptr(value));
}

std::string shown_source() {
    return relight::on_screen_source() + R"(
uniform float exposure; // factor
uniform int tone; // relight::ToneCurve
vec3 shown(vec3 radiance) {
    vec3 x = on_screen(tone, radiance * exposure);
    return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), x));
}
)";
}

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
