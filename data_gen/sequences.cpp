#include "data_gen/sequences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "data_gen/daylight.h"
#include "data_gen/environments.h"
#include "data_gen/noise.h"
#include "data_gen/sampled.h"

namespace relumine::data_gen {

namespace {

/// The scale of the environment sun_sky: radiance 1 is 20 kcd/m^2.
DaylightOptions daylight_options(const cubemap::SkyAngles& sun) {
    return {.sun_elevation_degrees = sun.elevation_degrees,
            .sun_azimuth_degrees = sun.azimuth_degrees,
            .ground_albedo = {0.24, 0.20, 0.15},
            .scale = 1.0 / 20.0};
}

void check(const SequenceOptions& options) {
    if (options.num_frames == 0)
        throw std::invalid_argument("sequence: expected at least one frame, got 0");
    if (options.face_resolution < 1 || options.face_resolution > 16384)
        throw std::invalid_argument(
            fmt::format("sequence: expected a face resolution from 1 to 16384, got {}",
                        options.face_resolution));
}

FrameMaker sun(const SequenceOptions& options) {
    check(options);
    return [n = options.num_frames, r = options.face_resolution](std::size_t frame) {
        return sun_and_sky(r, daylight_options(sun_angles(frame, n)));
    };
}

FrameMaker turn(const SequenceOptions& options) {
    check(options);
    if (options.probe.resolution == 0)
        throw std::invalid_argument("sequence turn: expected an environment to turn");
    return [n = options.num_frames, probe = options.probe](std::size_t frame) {
        return cubemap::rotated(probe, 360.0 * static_cast<double>(frame) / static_cast<double>(n));
    };
}

FrameMaker switched(const SequenceOptions& options) {
    check(options);
    return [n = options.num_frames, r = options.face_resolution](std::size_t frame) {
        const SwitchedLight light;
        cubemap::CubeMap map(r, glm::vec3(light.background));
        if (frame >= n / 2)
            add_disc(map, light.direction, light.radius_degrees, light.radiance);
        return map;
    };
}

/// The sun of `clouds`, at the same place as in the environment sun_sky.
constexpr cubemap::SkyAngles CloudySun{.elevation_degrees = 35.0, .azimuth_degrees = -60.0};

FrameMaker clouds(const SequenceOptions& options) {
    check(options);
    const Daylight daylight(daylight_options(CloudySun));
    const glm::dvec3 albedo = daylight_options(CloudySun).ground_albedo;
    // Irradiance of level ground from the sun and the clear sky. Clouds take the sun's part away.
    // They also take a part of the sky's light, but give about the same back.
    const glm::dvec3 both = std::numbers::pi * daylight.ground() / albedo;
    const double sun_sine = std::sin(glm::radians(Daylight::SunRadiusDegrees));
    const glm::dvec3 from_sun =
        daylight.sun() * (std::numbers::pi * sun_sine * sun_sine * daylight.sun_direction().y);
    // From below, a cloud shows the light that passes through it: half of the light that falls on
    // it.
    const glm::dvec3 cloud = 0.5 * both / std::numbers::pi;
    return [=, r = options.face_resolution](std::size_t frame) {
        const auto time = static_cast<double>(frame);
        const double transmission = cloud_transmission(time);
        const glm::dvec3 ground =
            albedo / std::numbers::pi * (both - (1.0 - transmission) * from_sun);
        const int num_samples = std::min(4, num_smooth_samples(r));
        cubemap::CubeMap map = sampled(
            r,
            [&](const glm::dvec3& w) {
                if (w.y < 0.0)
                    return ground;
                const double cover = cloud_cover(w, time);
                return (1.0 - cover) * daylight.sky(w) + cover * cloud;
            },
            [&](cubemap::Face, double, double, double) { return num_samples; });
        add_disc(map, daylight.sun_direction(), Daylight::SunRadiusDegrees,
                 glm::vec3(transmission * daylight.sun()));
        return map;
    };
}

FrameMaker tunnel(const SequenceOptions& options) {
    check(options);
    return [r = options.face_resolution](std::size_t frame) {
        cubemap::CubeMap map(r, glm::vec3(TunnelWalls));
        for (const TunnelLamp& lamp : tunnel_lamps(frame))
            add_disc(map, lamp.direction, lamp.radius_degrees, lamp.radiance);
        return map;
    };
}

} // namespace

cubemap::SkyAngles sun_angles(std::size_t frame, std::size_t num_frames) {
    const double t =
        num_frames < 2 ? 0.5 : static_cast<double>(frame) / static_cast<double>(num_frames - 1);
    return {.elevation_degrees = 8.0 + 54.0 * std::sin(std::numbers::pi * t),
            .azimuth_degrees = 100.0 - 200.0 * t};
}

double cloud_cover(const glm::dvec3& direction, double frame) {
    if (direction.y <= 0.0)
        return 0.0;
    // Clouds are as wide as their height. Low in the sky there are fewer, because distant clouds
    // are finer than any texel.
    constexpr double Frequency = 0.9, Threshold = 0.0, Softness = 0.35, Haze = 0.15;
    const glm::dvec3 place = direction / direction.y - CloudWind * frame;
    const double noise = fractal_noise({Frequency * place.x, 0.37, Frequency * place.z},
                                       {.num_octaves = 5, .gain = 0.5, .seed = 11});
    return smooth_step((noise - Threshold) / Softness) * smooth_step(direction.y / Haze);
}

double cloud_transmission(double frame) {
    const double clear = 1.0 - cloud_cover(cubemap::direction(CloudySun), frame);
    return clear * clear;
}

std::vector<TunnelLamp> tunnel_lamps(std::size_t frame) {
    // In metres. Lamps fade in and out far away, where a lamp gives a thousandth of one overhead.
    constexpr double Spacing = 8.0, Height = 2.2, Aside = 1.6, Radius = 0.3, Far = 80.0,
                     Visible = 60.0;
    const double driven =
        Spacing * static_cast<double>(frame % TunnelPeriod) / static_cast<double>(TunnelPeriod);
    std::vector<TunnelLamp> lamps;
    for (int pair = -static_cast<int>(Far / Spacing); pair <= static_cast<int>(Far / Spacing) + 1;
         ++pair)
        for (const double side : {-1.0, 1.0}) {
            const glm::dvec3 place(pair * Spacing - driven, Height, side * Aside);
            const double distance = glm::length(place);
            const double seen = 1.0 - smooth_step((distance - Visible) / (Far - Visible));
            if (seen > 0.0)
                lamps.push_back(
                    {.direction = place / distance,
                     .radius_degrees = glm::degrees(std::asin(Radius / distance)),
                     .radiance = static_cast<float>(seen) * glm::vec3(60.0f, 42.0f, 20.0f)});
        }
    return lamps;
}

std::span<const Sequence> sequences() {
    static constexpr std::array<Sequence, 5> Sequences = {{
        {"sun", "the sun's way through a clear sky, from the right to the left of the viewer",
         false, sun},
        {"turn", "an environment of yours that turns once about +Y", true, turn},
        {"switch", "a dim room in which a light is switched on half-way", false, switched},
        {"clouds", "clouds that the wind blows over a clear sky and the sun", false, clouds},
        {"tunnel", "a drive through a tunnel with two rows of lamps", false, tunnel},
    }};
    return Sequences;
}

} // namespace relumine::data_gen
