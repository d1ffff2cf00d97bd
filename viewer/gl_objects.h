// OpenGL objects that free themselves. All of them need a current context, to the end.
#pragma once

#include <string>
#include <utility>

#include <epoxy/gl.h>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace relumine::viewer {

enum class GlKind { Framebuffer, Renderbuffer, Buffer, VertexArray, Texture };

[[nodiscard]] GLuint make_object(GlKind kind);
void free_object(GlKind kind, GLuint id);

/// A handle to an object of OpenGL.
template<GlKind Kind>
class GlObject {
public:
    GlObject() : id_(make_object(Kind)) {}
    ~GlObject() {
        if (id_ != 0)
            free_object(Kind, id_);
    }
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    [[nodiscard]] GLuint id() const { return id_; }

private:
    GLuint id_ = 0;
};

using GlFramebuffer = GlObject<GlKind::Framebuffer>;
using GlRenderbuffer = GlObject<GlKind::Renderbuffer>;
using GlBuffer = GlObject<GlKind::Buffer>;
using GlVertexArray = GlObject<GlKind::VertexArray>;
using GlTexture = GlObject<GlKind::Texture>;

/// A vertex and a fragment shader. `#version 330 core` is put before each source.
class GlProgram {
public:
    /// Compiles and links the shaders.
    ///
    /// Throws:  std::runtime_error with the compiler's words.
    GlProgram(const std::string& vertex_source, const std::string& fragment_source);
    ~GlProgram();
    GlProgram(const GlProgram&) = delete;
    GlProgram& operator=(const GlProgram&) = delete;

    /// Makes the program current. The setters work on the current program.
    void use() const { glUseProgram(id_); }
    void set(const char* name, int value) const;
    void set(const char* name, float value) const;
    void set(const char* name, const glm::vec2& value) const;
    void set(const char* name, const glm::vec3& value) const;
    void set(const char* name, const glm::mat4& value) const;

private:
    GLuint id_ = 0;
};

/// Returns GLSL for `vec3 shown(vec3 radiance)`: exposure, tone curve and the sRGB curve, as
/// relight::save_picture() writes a PNG. The source declares the uniforms `exposure` and `tone`.
[[nodiscard]] std::string shown_source();

/// Draws go to a buffer of its own, so edges are smooth whatever the window's buffer is.
class MultisampleTarget {
public:
    /// Sends all that is drawn from now on here. The viewport is the whole buffer.
    void begin(int width, int height);
    /// Puts the picture into the window's buffer with its lower left corner at a pixel, and sends
    /// all that is drawn from now on there.
    void show_at(int x, int y) const;

private:
    GlFramebuffer framebuffer_;
    GlRenderbuffer color_;
    GlRenderbuffer depth_;
    int width_ = 0, height_ = 0;
};

} // namespace relumine::viewer
