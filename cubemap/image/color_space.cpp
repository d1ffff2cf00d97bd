#include "cubemap/image/color_space.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

#include "files/counted.h"
#include "files/parallel.h"
#include "files/pixel_values.h"

namespace relumine::cubemap {

namespace {

/// The luminance of a display's white, in cd/m2
constexpr float DisplayWhite = 203.0f;

constexpr glm::dvec2 D65{0.3127, 0.3290}, AcesWhite{0.32168, 0.33767};
constexpr Primaries Rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, D65};

struct Named {
    /// The colour space's colorInteropID
    std::string_view id;
    std::string_view name;
    Primaries primaries;
};
constexpr std::array<Named, 5> Spaces = {{
    {"ap1", "ACEScg", {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, AcesWhite}},
    {"ap0", "ACES2065-1", {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, AcesWhite}},
    {"p3d65", "P3-D65", {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, D65}},
    {"rec2020", "Rec. 2020", {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, D65}},
    {"adobergb", "Adobe RGB", {{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, D65}},
}};

glm::dvec3 xyz_of(const glm::dvec2& xy) {
    return {xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y};
}

/// The matrix to CIE XYZ in which white has the luminance 1.
glm::dmat3 to_xyz(const Primaries& p) {
    const auto direction = [](const glm::dvec2& xy) {
        return glm::dvec3(xy.x, xy.y, 1.0 - xy.x - xy.y);
    };
    const glm::dmat3 colors(direction(p.red), direction(p.green), direction(p.blue));
    if (!(std::abs(glm::determinant(colors)) > 1e-6) || !(p.white.y > 1e-6))
        throw std::invalid_argument("expected primaries that span colours, and a white");
    const glm::dvec3 gains = glm::inverse(colors) * xyz_of(p.white);
    return {colors[0] * gains.x, colors[1] * gains.y, colors[2] * gains.z};
}

glm::dmat3 adapted(const glm::dvec2& from, const glm::dvec2& to) {
    // Rows of Bradford's cone responses.
    const glm::dmat3 cones = glm::transpose(
        glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
    const glm::dvec3 gain = (cones * xyz_of(to)) / (cones * xyz_of(from));
    return glm::inverse(cones) * glm::dmat3(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z) * cones;
}

bool are_near(const Primaries& a, const Primaries& b) {
    const auto is_near = [](const glm::dvec2& p, const glm::dvec2& q) {
        return std::abs(p.x - q.x) < 1e-3 && std::abs(p.y - q.y) < 1e-3;
    };
    return is_near(a.red, b.red) && is_near(a.green, b.green) && is_near(a.blue, b.blue) &&
           is_near(a.white, b.white);
}

} // namespace

float linear(float value, Transfer transfer) {
    const float size = std::abs(value);
    const auto power = [&](float exponent) {
        return std::copysign(std::pow(size, exponent), value);
    };
    switch (transfer) {
    case Transfer::Srgb:
        return std::copysign(files::linear_of_srgb(size), value);
    case Transfer::Gamma22:
        return power(2.2f);
    case Transfer::Gamma18:
        return power(1.8f);
    case Transfer::Pq: {
        constexpr float M1 = 2610.0f / 16384.0f, M2 = 2523.0f / 32.0f;
        constexpr float C1 = 107.0f / 128.0f, C2 = 2413.0f / 128.0f, C3 = 2392.0f / 128.0f;
        const float root = std::pow(size, 1.0f / M2);
        return std::copysign(std::pow(std::max(root - C1, 0.0f) / (C2 - C3 * root), 1.0f / M1) *
                                 (10'000.0f / DisplayWhite),
                             value);
    }
    case Transfer::Hlg: {
        constexpr float A = 0.17883277f, B = 1.0f - 4.0f * A, C = 0.55991073f;
        const float light = size <= 0.5f ? size * size / 3.0f : (std::exp((size - C) / A) + B) / 12;
        return std::copysign(light, value);
    }
    default:
        return value;
    }
}

glm::dmat3 to_rec709(const Primaries& primaries) {
    const glm::dmat3 result =
        glm::inverse(to_xyz(Rec709)) * adapted(primaries.white, D65) * to_xyz(primaries);
    for (int column = 0; column < 3; ++column)
        if (!std::isfinite(glm::dot(result[column], glm::dvec3(1.0))))
            throw std::invalid_argument("expected primaries that span colours, and a white");
    return result;
}

glm::dmat3 rec709_from_xyz() {
    return glm::inverse(to_xyz(Rec709));
}

std::optional<ColorSpace> space_of(const Primaries& primaries, Transfer transfer) {
    const std::string_view curve = transfer == Transfer::Linear ? ""
                                   : transfer == Transfer::Srgb ? " by sRGB's curve"
                                   : transfer == Transfer::Pq   ? " by PQ"
                                   : transfer == Transfer::Hlg  ? " by HLG"
                                                                : " with a gamma";
    if (are_near(primaries, Rec709))
        return transfer == Transfer::Linear
                   ? std::nullopt
                   : std::optional(ColorSpace{.primaries = Rec709,
                                              .transfer = transfer,
                                              .name = fmt::format("Rec. 709{}", curve)});
    for (const Named& each : Spaces)
        if (are_near(primaries, each.primaries))
            return ColorSpace{.primaries = each.primaries,
                              .transfer = transfer,
                              .name = fmt::format("{}{}", each.name, curve)};
    return ColorSpace{.primaries = primaries, .transfer = transfer};
}

std::optional<ColorSpace> space_of_id(std::string_view id) {
    const std::size_t first = id.find('_'), second = id.find('_', first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos)
        return std::nullopt;
    const std::string_view curve = id.substr(0, first);
    const std::string_view gamut = id.substr(first + 1, second - first - 1);
    ColorSpace space{.primaries = Rec709, .name = std::string(id)};
    if (curve == "srgb")
        space.transfer = Transfer::Srgb;
    else if (curve == "g22")
        space.transfer = Transfer::Gamma22;
    else if (curve == "g18")
        space.transfer = Transfer::Gamma18;
    else if (curve != "lin")
        return std::nullopt;
    if (gamut == "rec709")
        return space.transfer == Transfer::Linear ? std::nullopt : std::optional(space);
    for (const Named& each : Spaces)
        if (gamut == each.id) {
            space.primaries = each.primaries;
            return space;
        }
    return std::nullopt;
}

ColorConversion::ColorConversion(const ColorSpace& from)
    : transfer_(from.transfer), from_(from.name.empty() ? "the header's primaries" : from.name) {
    try {
        matrix_ = to_rec709(from.primaries);
        luminances_ = glm::row(to_xyz(from.primaries), 1);
    } catch (const std::invalid_argument&) { // said by the remark
    }
}

ColorConversion::ColorConversion() : matrix_(rec709_from_xyz()), from_("CIE XYZ") {}

std::size_t ColorConversion::convert(std::span<glm::vec3> pixels) const {
    std::size_t num_outside = 0;
    if (!matrix_)
        return num_outside;
    for (glm::vec3& pixel : pixels) {
        if (transfer_ != Transfer::Linear)
            for (int channel = 0; channel < 3; ++channel)
                pixel[channel] = linear(pixel[channel], transfer_);
        if (transfer_ == Transfer::Hlg) {
            // On a display of 1,000 cd/m2 [ITU-R BT.2100, table 5].
            const float luminance = std::max(glm::dot(luminances_, pixel), 0.0f);
            pixel *= 1000.0f / DisplayWhite * std::pow(luminance, 0.2f);
        }
        const bool was_light = pixel.x >= 0.0f && pixel.y >= 0.0f && pixel.z >= 0.0f;
        pixel = *matrix_ * pixel;
        if (was_light && (pixel.x < 0.0f || pixel.y < 0.0f || pixel.z < 0.0f)) {
            pixel = glm::max(pixel, glm::vec3(0.0f));
            ++num_outside;
        }
    }
    return num_outside;
}

std::string ColorConversion::remark(std::size_t num_outside) const {
    if (!matrix_)
        return fmt::format("{} span no colours: passed over", from_);
    return num_outside == 0
               ? fmt::format("{} converted to Rec. 709", from_)
               : fmt::format("{} converted to Rec. 709, which cannot show the colour of {}", from_,
                             files::counted(num_outside, "pixel"));
}

std::string convert(const ColorConversion& conversion, Picture& picture) {
    std::atomic<std::size_t> num_outside = 0;
    files::parallel_for(std::size_t{0}, std::size_t{picture.height}, [&](std::size_t row) {
        num_outside += conversion.convert(
            std::span(picture.pixels).subspan(row * picture.width, picture.width));
    });
    return conversion.remark(num_outside);
}

} // namespace relumine::cubemap
