#include "viewer/gl_objects.h"

#include <stdexcept>

#include <glm/gtc/type_ptr.hpp>

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
    // relight/pictures/tone_curve.cpp says where the curves come from.
    return R"(
uniform float exposure; // factor
uniform int tone; // relight::ToneCurve
vec3 neutral(vec3 radiance) {
    float least = min(radiance.r, min(radiance.g, radiance.b));
    vec3 color = radiance - (least < 0.08 ? least - least * least / 0.16 : 0.04);
    float peak = max(color.r, max(color.g, color.b));
    if (peak <= 0.76)
        return color;
    float most = 1.0 - 0.0576 / (peak - 0.52);
    return mix(vec3(most), color * (most / peak), 1.0 / (0.15 * (peak - most) + 1.0));
}
vec3 agx(vec3 radiance) {
    vec3 wide = mat3(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956) * radiance;
    vec3 inset = mat3(0.856627153, 0.137318973, 0.111898213, 0.0951212405, 0.761241991, 0.0767994186,
                      0.0482516061, 0.101439036, 0.811302368) * wide;
    vec3 x = clamp((log2(max(inset, 1e-10)) + 12.47393) / 16.5, 0.0, 1.0);
    vec3 x2 = x * x;
    vec3 x4 = x2 * x2;
    vec3 contrast = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 +
                    0.1191 * x - 0.00232;
    vec3 outset = mat3(1.12710058, -0.141329763, -0.141329763, -0.110606643, 1.15782370, -0.110606643,
                       -0.0164939387, -0.0164939387, 1.25193641) * contrast;
    return mat3(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187) *
           pow(max(outset, 0.0), vec3(2.2));
}
vec3 aces(vec3 radiance) {
    vec3 v = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777) *
             (radiance / 0.6);
    v = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602) * v;
}
vec3 shown(vec3 radiance) {
    vec3 x = clamp(radiance * exposure, 0.0, 1e8);
    x = tone == 0 ? neutral(x) : tone == 1 ? agx(x) : tone == 2 ? aces(x) : x;
    x = clamp(x, 0.0, 1.0);
    return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), x));
}
)";
}

} // namespace relumine::viewer
