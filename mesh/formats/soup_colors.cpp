#include "mesh/formats/soup_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/pixel_values.h"

namespace relumine::mesh {

namespace {

bool is_color(const glm::vec3& color) {
    return std::isfinite(color.r) && std::isfinite(color.g) && std::isfinite(color.b);
}

/// Makes colours white that are missing or not finite. Without any other there are no colours.
void whiten(std::vector<glm::vec3>& colors, const char* of, PolygonSoup& soup) {
    const auto num_good = std::count_if(colors.begin(), colors.end(), is_color);
    const std::size_t num_bad = colors.size() - static_cast<std::size_t>(num_good);
    if (num_bad == 0)
        return;
    soup.warnings.push_back(fmt::format("{} of {} {} have no colour, or none that is a number: "
                                        "they are white",
                                        num_bad, colors.size(), of));
    if (num_good == 0)
        colors.clear();
    std::replace_if(
        colors.begin(), colors.end(), [](const glm::vec3& color) { return !is_color(color); },
        glm::vec3(1.0f));
}

} // namespace

glm::vec3 no_color() {
    return glm::vec3(std::numeric_limits<float>::quiet_NaN());
}

float scale_to_one(std::vector<glm::vec3>& colors) {
    // Fractions of less may be light.
    constexpr float LeastOfBytes = 16.0f;
    float largest = 0.0f;
    bool is_whole = true;
    for (const glm::vec3& color : colors)
        for (int i = 0; i < 3 && is_color(color); ++i) {
            largest = std::max(largest, color[i]);
            is_whole = is_whole && color[i] == std::floor(color[i]);
        }
    float one = 1.0f;
    if (largest > 1.0f && largest <= 255.0f && (is_whole || largest >= LeastOfBytes))
        one = 255.0f;
    else if (largest > 255.0f && largest <= 65535.0f && is_whole)
        one = 65535.0f;
    if (one > 1.0f)
        for (glm::vec3& color : colors)
            color /= one;
    return one;
}

void settle_colors(PolygonSoup& soup, std::optional<ColorCurve> curve) {
    const ColorCustom& custom = soup.color_custom;
    if (custom.may_be_whole)
        for (std::vector<glm::vec3>* colors : {&soup.colors, &soup.face_colors})
            if (const float one = scale_to_one(*colors); one > 1.0f)
                soup.notes.push_back(fmt::format("colours are taken as numbers of 0 to {}", one));
    whiten(soup.colors, "vertices", soup);
    whiten(soup.face_colors, "faces", soup);
    if (soup.colors.empty() && soup.face_colors.empty())
        return;
    float largest = 0.0f;
    for (const std::vector<glm::vec3>* colors : {&soup.colors, &soup.face_colors})
        for (const glm::vec3& color : *colors)
            largest = std::max({largest, color.r, color.g, color.b});
    constexpr float Rounding = 1e-4f;
    if (custom.may_be_whole && largest > 1.0f + Rounding)
        soup.warnings.push_back(fmt::format(
            "colours are up to {:.4g}: such surfaces send back more light than arrives, "
            "and bounces may be refused",
            largest));
    const bool is_srgb = curve.value_or(custom.curve) == ColorCurve::Srgb;
    for (std::vector<glm::vec3>* colors : {&soup.colors, &soup.face_colors})
        for (glm::vec3& color : *colors) {
            color = glm::max(color, glm::vec3(0.0f));
            for (int i = 0; i < 3 && is_srgb; ++i)
                color[i] = files::linear_of_srgb(color[i]);
        }
    if (!custom.reason.empty() && !curve)
        soup.notes.push_back(
            fmt::format("colours are taken as {}, {}; --vertex-colors {} takes them otherwise",
                        is_srgb ? "sRGB" : "linear", custom.reason, is_srgb ? "linear" : "srgb"));
}

} // namespace relumine::mesh
