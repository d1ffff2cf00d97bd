#include "data_gen/environments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/sampled.h"

namespace relumine::data_gen {
namespace {

// A soft box with its axes.
class PlacedBox {
public:
    explicit PlacedBox(const SoftBox& box) : box_(box), forward_(glm::normalize(box.direction)) {
        const double length = glm::length(box.direction);
        if (!(length > 0.0) || !std::isfinite(length)) {
            throw std::invalid_argument("soft box: expected a direction other than zero");
        }
        const double smaller = std::min(box.half_width, box.half_height);
        if (!(box.edge > 0.0 && box.edge <= smaller)) {
            throw std::invalid_argument(fmt::format(
                "soft box: expected an edge above 0 and up to {}, got {}", smaller, box.edge));
        }
        const glm::dvec3 up =
            std::abs(forward_.y) < 0.999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
        right_ = glm::normalize(glm::cross(up, forward_));
        up_ = glm::cross(forward_, right_);
    }
    [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& w) const {
        const double depth = glm::dot(w, forward_);
        if (depth <= 0.0) {
            return glm::dvec3(0.0);
        }
        const double inside_x = box_.half_width - std::abs(glm::dot(w, right_)) / depth;
        const double inside_y = box_.half_height - std::abs(glm::dot(w, up_)) / depth;
        return glm::dvec3(box_.radiance) *
               (smooth_step(inside_x / box_.edge) * smooth_step(inside_y / box_.edge));
    }

private:
    SoftBox box_;
    glm::dvec3 forward_;
    glm::dvec3 right_{0.0};
    glm::dvec3 up_{0.0};
};

} // namespace

cubemap::CubeMap constant(std::uint32_t resolution, const glm::vec3& radiance) {
    return cubemap::CubeMap(resolution, radiance);
}

cubemap::CubeMap soft_boxes(std::uint32_t resolution, std::span<const SoftBox> boxes,
                            const glm::vec3& background) {
    const std::vector<PlacedBox> placed(boxes.begin(), boxes.end());
    const int num_samples = std::max(2, num_smooth_samples(resolution));
    return sampled(
        resolution,
        [&](const glm::dvec3& w) {
            glm::dvec3 sum(background);
            for (const PlacedBox& box : placed) {
                sum += box.radiance(w);
            }
            return sum;
        },
        [&](cubemap::Face, double, double, double) { return num_samples; });
}

cubemap::CubeMap two_soft_boxes(std::uint32_t resolution) {
    const std::array<SoftBox, 2> boxes = {{{.direction = {-0.62, 0.62, 0.48},
                                            .half_width = 0.36,
                                            .half_height = 0.30,
                                            .edge = 0.06,
                                            .radiance = {15.0f, 12.5f, 9.6f}},
                                           {.direction = {0.90, 0.30, 0.32},
                                            .half_width = 0.22,
                                            .half_height = 0.55,
                                            .edge = 0.10,
                                            .radiance = {1.3f, 2.0f, 3.1f}}}};
    return soft_boxes(resolution, boxes, glm::vec3(0.05f, 0.055f, 0.065f));
}

cubemap::CubeMap sun_and_sky(std::uint32_t resolution, const DaylightOptions& options) {
    const Daylight daylight(options);
    const int num_samples = num_smooth_samples(resolution);
    constexpr int NumHorizonSamples = 16;
    cubemap::CubeMap map = sampled(
        resolution,
        [&](const glm::dvec3& w) { return w.y >= 0.0 ? daylight.sky(w) : daylight.ground(); },
        [&](cubemap::Face face, double s, double t, double texel) {
            // The horizon runs along rows of the side faces.
            const double top = cubemap::cube_point(face, s, t).y;
            const double bottom = cubemap::cube_point(face, s, t + texel).y;
            const bool side = face != cubemap::Face::PositiveY && face != cubemap::Face::NegativeY;
            return side && top > 1e-9 && bottom < -1e-9 ? NumHorizonSamples : num_samples;
        });
    add_disc(map, daylight.sun_direction(), Daylight::SunRadiusDegrees, glm::vec3(daylight.sun()));
    return map;
}

std::span<const Environment> environments() {
    static constexpr std::array<Environment, 4> Environments = {{
        {"sun_sky",
         "a clear afternoon (Preetham): sun of true size, sky, ground; radiance 1 = 20 kcd/m^2",
         [](std::uint32_t resolution) {
             return sun_and_sky(resolution,
                                {.ground_albedo = {0.24, 0.20, 0.15}, .scale = 1.0 / 20.0});
         }},
        {"soft_boxes",
         "a studio: warm key from the front left, cool fill from the right, dim background",
         two_soft_boxes},
        {"small_light", "one round light of 3 degrees radius in the dark, from the front left",
         [](std::uint32_t resolution) {
             return disc_light(resolution, direction_from_angles(45.0, -50.0), 3.0,
                               glm::vec3(500.0f));
         }},
        {"constant", "radiance 1 from everywhere: the white furnace",
         [](std::uint32_t resolution) {
             return constant(resolution);
         }},
    }};
    return Environments;
}

} // namespace relumine::data_gen
