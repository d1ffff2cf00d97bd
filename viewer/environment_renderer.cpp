#include "viewer/environment_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "relumine/light/layers.h"
#include "viewer/quadtree_lines.h"

namespace relumine::viewer {

namespace {

constexpr const char* VertexSource = R"(
uniform vec2 uv_min, uv_max; // at the viewport's left top and right bottom
out vec2 uv;
void main() {
    vec2 at = vec2((gl_VertexID & 1) * 2, gl_VertexID & 2);
    uv = vec2(mix(uv_min.x, uv_max.x, at.x), mix(uv_max.y, uv_min.y, at.y));
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
)";

/// Four samples a pixel: a small sun must not come and go between pixels.
constexpr const char* FragmentSource = R"(
in vec2 uv;
uniform samplerCube environment, heat;
uniform int use_heat;
uniform float hottest;
uniform vec2 uv_step; // of a pixel
out vec4 color;
vec3 direction_at(vec2 at) {
    float longitude = 3.14159265358979 * (1.0 - 2.0 * at.x);
    float latitude = 3.14159265358979 * (0.5 - at.y);
    return vec3(sin(longitude) * cos(latitude), sin(latitude), cos(longitude) * cos(latitude));
}
vec3 hot(float t) {
    return clamp(vec3(3.0 * t, 3.0 * t - 1.0, 3.0 * t - 2.0), 0.0, 1.0);
}
void main() {
    vec3 sum = vec3(0.0);
    float heat_sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 at = uv + uv_step * (vec2(i & 1, i >> 1) * 0.5 - 0.25);
        vec3 w = direction_at(at);
        sum += shown(looked_up(environment, w));
        if (use_heat != 0)
            heat_sum += dot(looked_up(heat, w), vec3(0.2126, 0.7152, 0.0722));
    }
    vec3 below = 0.25 * sum;
    // Logarithmic, over eight stops.
    float t = log2(1.0 + 255.0 * clamp(0.25 * heat_sum / hottest, 0.0, 1.0)) / 8.0;
    vec3 grey = vec3(0.35 * dot(below, vec3(0.2126, 0.7152, 0.0722)));
    vec3 over = mix(grey, hot(t), min(1.0, 0.2 + 2.0 * t));
    color = vec4(use_heat != 0 ? over : below, 1.0);
    if (uv.y < 0.0 || uv.y > 1.0)
        color = vec4(0.1, 0.1, 0.1, 1.0);
}
)";

constexpr const char* LineVertexSource = R"(
layout(location = 0) in vec2 uv;
uniform vec2 uv_min, uv_max;
uniform float turn; // whole turns to the side
void main() {
    vec2 at = (uv + vec2(turn, 0.0) - uv_min) / (uv_max - uv_min);
    gl_Position = vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
}
)";

constexpr const char* LineFragmentSource = R"(
out vec4 color;
void main() { color = vec4(0.35, 0.85, 1.0, 0.4); }
)";

} // namespace

EnvironmentRenderer::EnvironmentRenderer(const prt::Quadtree& quadtree)
    : program_(VertexSource, shown_source() + cube_lookup_source() + FragmentSource),
      line_program_(LineVertexSource, LineFragmentSource) {
    const std::vector<glm::vec2> ends = quadtree_lines(quadtree);
    num_line_ends_ = static_cast<GLsizei>(ends.size());
    glBindVertexArray(line_array_.id());
    glBindBuffer(GL_ARRAY_BUFFER, lines_.id());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(ends.size() * sizeof(glm::vec2)),
                 ends.data(), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
    glBindVertexArray(0);
}

void EnvironmentRenderer::upload_heat(const cubemap::CubeMap& contribution) {
    heat_.upload(contribution, cubemap::all_texels(contribution.resolution));
    // The brightest two-hundredth of the sphere is white-hot: one sun must not leave the sky black.
    std::vector<float> brightness;
    brightness.reserve(contribution.texels.size());
    for (const glm::vec3& texel : contribution.texels)
        brightness.push_back(0.2126f * texel.r + 0.7152f * texel.g + 0.0722f * texel.b);
    const auto bright =
        brightness.begin() + static_cast<std::ptrdiff_t>(brightness.size() * 199 / 200);
    std::nth_element(brightness.begin(), bright, brightness.end());
    hottest_ =
        *bright > 0.0f ? *bright : std::max(*std::max_element(bright, brightness.end()), 1e-20f);
}

void EnvironmentRenderer::draw(const LatLongView& view, const PixelRectangle& viewport,
                               const CubeTexture& environment, const EnvironmentLook& look) const {
    const glm::dvec2 corner(viewport.x, viewport.y);
    const glm::dvec2 size(viewport.width, viewport.height);
    const glm::vec2 uv_min(view.uv_at(viewport, corner));
    const glm::vec2 uv_max(view.uv_at(viewport, corner + size));
    const bool heat = look.heat && heat_.resolution() != 0;

    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    program_.use();
    program_.set("uv_min", uv_min);
    program_.set("uv_max", uv_max);
    program_.set("uv_step", (uv_max - uv_min) / glm::vec2(size));
    program_.set("exposure", std::exp2(look.exposure_ev));
    program_.set("tone", static_cast<int>(look.tone));
    program_.set("use_heat", heat ? 1 : 0);
    program_.set("hottest", hottest_);
    program_.set("environment", 0);
    program_.set("heat", 1);
    environment.bind(0);
    (heat ? heat_ : environment).bind(1);
    glBindVertexArray(no_array_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);

    if (look.quadtree) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        line_program_.use();
        line_program_.set("uv_min", uv_min);
        line_program_.set("uv_max", uv_max);
        glBindVertexArray(line_array_.id());
        const int last_turn = static_cast<int>(std::floor(uv_max.x));
        for (int turn = static_cast<int>(std::floor(uv_min.x)) - 1; turn <= last_turn; ++turn) {
            line_program_.set("turn", static_cast<float>(turn));
            glDrawArrays(GL_LINES, 0, num_line_ends_);
        }
    }
    glBindVertexArray(0);
}

} // namespace relumine::viewer
