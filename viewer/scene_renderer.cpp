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
centroid out vec3 place;
flat out int on_floor;
void main() {
    radiance = vertex_radiance;
    place = position;
    on_floor = gl_VertexID >= first_floor_vertex ? 1 : 0;
    gl_Position = clip_from_world * vec4(position, 1.0);
}
)";

/// Shows what is behind, as relight::grounded_backdrop() and relight::sweep_backdrop() do.
constexpr const char* BehindSource = R"(
uniform samplerCube environment;
uniform int use_environment;
uniform int floor_look; // 0 grey, 1 photo, 2 studio
uniform vec3 eye;
uniform vec3 ground_camera;
uniform float ground_height;
uniform float ground_reach;
uniform vec3 studio_color;
vec3 ground_point(vec3 way) {
    vec3 from = eye - ground_camera;
    if (from.y <= -ground_height)
        return way;
    float radius = max(ground_reach, 4.0 * length(from));
    if (way.y < 0.0) {
        vec3 at = from + (-ground_height - from.y) / way.y * way;
        if (dot(at, at) <= radius * radius)
            return at;
    }
    float along = dot(from, way);
    return from + (sqrt(along * along + radius * radius - dot(from, from)) - along) * way;
}
vec3 behind(vec3 direction) {
    if (use_environment == 0)
        return vec3(0.0);
    vec3 way = normalize(direction);
    if (floor_look == 0)
        return looked_up(environment, way);
    vec3 at = ground_point(way);
    if (floor_look == 1)
        return looked_up(environment, normalize(at));
    vec3 beyond = looked_up(environment, way);
    if (way.y >= 0.0 || eye.y <= ground_camera.y - ground_height)
        return beyond;
    float t = max((1.0 / max(length(at.xz) / ground_height, 2.5) - 1.0 / 18.0) / (0.4 - 1.0 / 18.0), 0.0);
    return mix(beyond, studio_color, t * t * (3.0 - 2.0 * t));
}
// What is behind, darkened, as the screen shows it.
vec3 shown_behind(vec3 direction, vec3 part) {
    return use_environment != 0 ? shown(part * behind(direction)) : 0.17 * part;
}
)";

constexpr const char* MeshFragmentSource = R"(
centroid in vec3 radiance;
centroid in vec3 place;
flat in int on_floor;
uniform int as_lines;
uniform vec3 open_floor; // of a floor that nothing shades
uniform vec2 floor_center;
uniform vec2 floor_radii; // opaque up to the first, gone from the second on
out vec4 color;
void main() {
    float t = clamp((floor_radii.y - distance(place.xz, floor_center)) /
                    max(floor_radii.y - floor_radii.x, 1e-30), 0.0, 1.0);
    float opacity = on_floor != 0 ? t * t * (3.0 - 2.0 * t) : 1.0;
    if (as_lines != 0) {
        color = vec4(0.05, 0.07, 0.1, 0.22 * opacity);
    } else if (on_floor != 0 && floor_look != 0) {
        vec3 part = mix(vec3(1.0), radiance / max(open_floor, vec3(1e-30)), opacity);
        color = vec4(shown_behind(place - eye, part), eye.y > place.y ? 1.0 : 0.0);
    } else {
        color = vec4(shown(radiance), opacity);
    }
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
out vec4 color;
void main() {
    color = vec4(shown_behind(direction, vec3(1.0)), 1.0);
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
    : floor_(floor), mesh_program_(MeshVertexSource, shown_source() + cube_lookup_source() +
                                                         BehindSource + MeshFragmentSource),
      background_program_(BackgroundVertexSource, shown_source() + cube_lookup_source() +
                                                      BehindSource + BackgroundFragmentSource),
      picture_program_(PictureVertexSource, shown_source() + PictureFragmentSource),
      num_indices_(static_cast<GLsizei>(3 * mesh.num_triangles())) {
    upload_mesh(mesh);
    glBindVertexArray(mesh_array_.id());
    glBindBuffer(GL_ARRAY_BUFFER, positions_.id());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    glBindBuffer(GL_ARRAY_BUFFER, radiance_.id());
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    glBindVertexArray(0);
}

void SceneRenderer::upload_mesh(const mesh::TriangleMesh& mesh) {
    const mesh::Bounds box = mesh::bounds(mesh);
    center_ = box.center();
    diagonal_ = box.diagonal();
    glBindVertexArray(mesh_array_.id());
    fill<glm::vec3>(GL_ARRAY_BUFFER, positions_, mesh.positions, GL_STATIC_DRAW);
    fill<mesh::Triangle>(GL_ELEMENT_ARRAY_BUFFER, triangles_, mesh.triangles, GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void SceneRenderer::upload_radiance(std::span<const glm::vec3> radiance) {
    // New storage each time: the driver need not wait until the old radiance has been drawn.
    fill<glm::vec3>(GL_ARRAY_BUFFER, radiance_, radiance, GL_STREAM_DRAW);
}

/// Sets what the shaders need to know of what is behind the mesh.
void SceneRenderer::set_behind(const GlProgram& program, const OrbitCamera& camera,
                               const SceneLook& look, const FloorScene& floor) const {
    program.set("use_environment", look.background ? 1 : 0);
    program.set("environment", 0);
    program.set("floor_look", floor.look == FloorLook::Grey     ? 0
                              : floor.look == FloorLook::Studio ? 2
                                                                : 1);
    program.set("eye", camera.eye());
    program.set("ground_camera", glm::vec3(floor.ground.camera));
    program.set("ground_height", static_cast<float>(floor.ground.height));
    program.set("ground_reach", static_cast<float>(floor.ground.reach));
    program.set("studio_color", floor.color);
}

void SceneRenderer::draw_background(const OrbitCamera& camera, const PixelRectangle& viewport,
                                    const CubeTexture& environment, const SceneLook& look,
                                    const FloorScene& floor) const {
    const CameraFrame axes = frame(camera, viewport);
    background_program_.use();
    background_program_.set("right", axes.right);
    background_program_.set("up", axes.up);
    background_program_.set("forward", axes.forward);
    background_program_.set("exposure", std::exp2(look.exposure_ev));
    background_program_.set("tone", static_cast<int>(look.tone));
    set_behind(background_program_, camera, look, floor);
    environment.bind(0);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SceneRenderer::draw(const OrbitCamera& camera, const PixelRectangle& viewport,
                         const CubeTexture& environment, const SceneLook& look,
                         const FloorScene& floor) const {
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    draw_background(camera, viewport, environment, look, floor);

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
    set_behind(mesh_program_, camera, look, floor);
    mesh_program_.set("open_floor", floor.open);
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
