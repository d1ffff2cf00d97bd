#include "viewer/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace relumine::viewer {

namespace {

constexpr const char* MeshVertexSource = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertex_radiance;
uniform mat4 clip_from_world;
uniform int first_floor_vertex;
// Centroid: the edge of a triangle must not take radiance from beyond it.
centroid out vec3 radiance;
centroid out vec2 place;
flat out int on_floor;
void main() {
    radiance = vertex_radiance;
    place = position.xz;
    on_floor = gl_VertexID >= first_floor_vertex ? 1 : 0;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

constexpr const char* MeshFragmentSource = R"(
centroid in vec3 radiance;
centroid in vec2 place;
flat in int on_floor;
uniform int as_lines;
uniform vec2 floor_center;
uniform vec2 floor_radii; // opaque up to the first, gone from the second on
out vec4 color;
void main() {
    float t = clamp((floor_radii.y - distance(place, floor_center)) /
                    max(floor_radii.y - floor_radii.x, 1e-30), 0.0, 1.0);
    float opacity = on_floor != 0 ? t * t * (3.0 - 2.0 * t) : 1.0;
    color = vec4(as_lines != 0 ? vec3(0.05, 0.07, 0.1) : shown(radiance),
                 (as_lines != 0 ? 0.22 : 1.0) * opacity);
}
)";

/// One triangle over the whole viewport.
constexpr const char* BackgroundVertexSource = R"(
uniform vec3 right, up, forward;
out vec3 direction;
void main() {
    vec2 at = vec2((gl_VertexID & 1) * 4 - 1, (gl_VertexID & 2) * 2 - 1);
    direction = forward + at.x * right + at.y * up;
    gl_Position = vec4(at, 1.0, 1.0);
}
)";

constexpr const char* BackgroundFragmentSource = R"(
in vec3 direction;
uniform samplerCube environment;
uniform int use_environment;
out vec4 color;
void main() {
    color = vec4(use_environment != 0 ? shown(looked_up(environment, direction)) : vec3(0.17), 1.0);
}
)";

constexpr const char* PictureVertexSource = R"(
out vec2 uv;
void main() {
    vec2 at = vec2((gl_VertexID & 1) * 2, gl_VertexID & 2);
    uv = vec2(at.x, 1.0 - at.y);
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
)";

constexpr const char* PictureFragmentSource = R"(
in vec2 uv;
uniform sampler2D picture; // multiplied by alpha
out vec4 color;
void main() {
    vec4 own = texture(picture, uv);
    color = vec4(mix(vec3(0.17), shown(own.rgb / max(own.a, 1e-6)), own.a), 1.0);
}
)";

template<typename T>
void fill(GLenum target, const GlBuffer& buffer, std::span<const T> data, GLenum use) {
    glBindBuffer(target, buffer.id());
    glBufferData(target, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), use);
}

} // namespace

SceneRenderer::SceneRenderer(const mesh::TriangleMesh& mesh, const relight::FadingFloor& floor)
    : floor_(floor), mesh_program_(MeshVertexSource, shown_source() + MeshFragmentSource),
      background_program_(BackgroundVertexSource,
                          shown_source() + cube_lookup_source() + BackgroundFragmentSource),
      picture_program_(PictureVertexSource, shown_source() + PictureFragmentSource),
      num_indices_(static_cast<GLsizei>(3 * mesh.num_triangles())) {
    const mesh::Bounds box = mesh::bounds(mesh);
    center_ = box.center();
    diagonal_ = box.diagonal();

    glBindVertexArray(mesh_array_.id());
    fill<glm::vec3>(GL_ARRAY_BUFFER, positions_, mesh.positions, GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    glBindBuffer(GL_ARRAY_BUFFER, radiance_.id());
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    fill<mesh::Triangle>(GL_ELEMENT_ARRAY_BUFFER, triangles_, mesh.triangles, GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void SceneRenderer::upload_radiance(std::span<const glm::vec3> radiance) {
    // New storage each time: the driver need not wait until the old radiance has been drawn.
    fill<glm::vec3>(GL_ARRAY_BUFFER, radiance_, radiance, GL_STREAM_DRAW);
}

void SceneRenderer::draw_background(const OrbitCamera& camera, const PixelRectangle& viewport,
                                    const CubeTexture& environment, const SceneLook& look) const {
    const CameraFrame axes = frame(camera, viewport);
    background_program_.use();
    background_program_.set("right", axes.right);
    background_program_.set("up", axes.up);
    background_program_.set("forward", axes.forward);
    background_program_.set("exposure", std::exp2(look.exposure_ev));
    background_program_.set("tone", static_cast<int>(look.tone));
    background_program_.set("use_environment", look.background ? 1 : 0);
    background_program_.set("environment", 0);
    environment.bind(0);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SceneRenderer::draw(const OrbitCamera& camera, const PixelRectangle& viewport,
                         const CubeTexture& environment, const SceneLook& look) const {
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    draw_background(camera, viewport, environment, look);

    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDepthFunc(GL_LEQUAL);
    const float reach = glm::length(camera.target - center_) + diagonal_;
    mesh_program_.use();
    mesh_program_.set("clip_from_world", clip_from_world(camera, viewport, reach));
    mesh_program_.set("exposure", std::exp2(look.exposure_ev));
    mesh_program_.set("tone", static_cast<int>(look.tone));
    mesh_program_.set("as_lines", 0);
    constexpr std::uint32_t None = std::numeric_limits<int>::max();
    mesh_program_.set("first_floor_vertex", static_cast<int>(std::min(floor_.first_vertex, None)));
    mesh_program_.set("floor_center", floor_.center);
    mesh_program_.set("floor_radii", glm::vec2(floor_.opaque_radius, floor_.end_radius));
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glBindVertexArray(mesh_array_.id());
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.0f, 1.0f);
    glDrawElements(GL_TRIANGLES, num_indices_, GL_UNSIGNED_INT, nullptr);
    glDisable(GL_POLYGON_OFFSET_FILL);
    if (look.wireframe) {
        glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
        mesh_program_.set("as_lines", 1);
        glDrawElements(GL_TRIANGLES, num_indices_, GL_UNSIGNED_INT, nullptr);
        glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    }
    glBindVertexArray(0);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
}

void SceneRenderer::upload_picture(const relight::Picture& picture) {
    std::vector<glm::vec4> pixels;
    pixels.reserve(picture.pixels.size());
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        pixels.emplace_back(picture.pixels[i], picture.alpha.empty() ? 1.0f : picture.alpha[i]);
    glBindTexture(GL_TEXTURE_2D, picture_.id());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(picture.width),
                 static_cast<GLsizei>(picture.height), 0, GL_RGBA, GL_FLOAT, pixels.data());
}

void SceneRenderer::draw_picture(const SceneLook& look) const {
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    picture_program_.use();
    picture_program_.set("exposure", std::exp2(look.exposure_ev));
    picture_program_.set("tone", static_cast<int>(look.tone));
    picture_program_.set("picture", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, picture_.id());
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

} // namespace relumine::viewer
