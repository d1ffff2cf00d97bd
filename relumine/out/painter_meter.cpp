#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "relight/pictures/exposure.h"
#include "relumine/out/painter_impl.h"

namespace relumine {

void Painter::Impl::meter(const Lighting& lighting) {
    require_fit(scene, lighting.radiance);
    constexpr double ShareOfRooms = 0.85;
    const double share = is_on_vertices() ? meter_picture(lighting) : meter_receivers(lighting);
    if (share > ShareOfRooms || !prt::kind_of(scene.layout).are_seen ||
        !std::holds_alternative<EnvironmentBehind>(options.background) ||
        lighting.environment == nullptr)
        return;
    constexpr std::uint32_t Side = 64;
    const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
    const prt::PictureRays rays_behind(pixels != nullptr ? pixels->camera : camera(), Side, Side,
                                       1);
    const relight::Backdrop behind = backdrop(lighting);
    for (std::uint32_t y = 0; y < Side; ++y)
        for (std::uint32_t x = 0; x < Side; ++x)
            metered.behind.push_back(behind(rays_behind.direction(x, y, 0)));
}

double Painter::Impl::meter_receivers(const Lighting& lighting) {
    const std::vector<glm::vec3> colors = own_colors(lighting);
    const std::vector<bool> is_floor = floor_receivers(scene);
    const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout);
    // Samples of a receiver that stands for all of a pixel: it counts as one.
    const double per_receiver =
        pixels != nullptr && !pixels->shares.empty() ? prt::PixelLayout::EdgeSamples : 1.0;
    double covered = 0.0;
    std::optional<relight::Backdrop> behind;
    const std::optional<glm::vec3> open = open_floor(scene, lighting, look(lighting), eye());
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (is_floor.empty() || !is_floor[i]) {
            const double weight =
                pixels == nullptr ? 1.0 : static_cast<double>(pixels->num_shown(i)) / per_receiver;
            metered.colors.push_back(
                lighting.arriving.empty()
                    ? colors[i]
                    : glm::max(colors[i], relight::LeastMeteredAlbedo * lighting.arriving[i]));
            metered.weights.push_back(static_cast<float>(weight));
            covered += weight;
        } else if (pixels != nullptr && !scene.lamps.empty() &&
                   floor.opacity(scene.receivers.positions[i]) == 1.0f) {
            if (open && !behind)
                behind = backdrop(lighting);
            meter_floor(open ? relight::caught(lighting.radiance[i], *open, 1.0f) : colors[i],
                        scene.receivers.positions[i] - pixels->camera.eye,
                        behind ? &*behind : nullptr);
        }
    if (pixels == nullptr)
        return 0.0;
    const double num_samples = static_cast<double>(pixels->num_samples()) / per_receiver;
    metered.num_pixels += num_samples;
    return covered / num_samples;
}

double Painter::Impl::meter_picture(const Lighting& lighting) {
    relight::FadingFloor gone = floor, opaque = floor;
    gone.opaque_radius = gone.end_radius = -1.0f;
    opaque.end_radius = opaque.opaque_radius;
    if (!small)
        small.emplace(scene.mesh, rays, camera(), small_size(), gone);
    const Picture seen = drawn(*small, lighting, nullptr);
    Picture arriving;
    if (!lighting.arriving.empty())
        arriving = small->cut_out({.radiance = lighting.arriving});
    double covered = 0.0;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i)
        if (seen.alpha[i] > 0.0f) {
            glm::vec3 color = seen.pixels[i] / seen.alpha[i];
            if (!arriving.pixels.empty() && arriving.alpha[i] > 0.0f)
                color = glm::max(color, relight::LeastMeteredAlbedo * arriving.pixels[i] /
                                            arriving.alpha[i]);
            metered.colors.push_back(color);
            metered.weights.push_back(seen.alpha[i]);
            covered += static_cast<double>(seen.alpha[i]);
        }
    const auto num_pixels = static_cast<double>(seen.pixels.size());
    metered.num_pixels += num_pixels;
    // Without lamps the floor is as bright as the environment makes it, and that is metered.
    if (floor.first_vertex >= scene.mesh.num_vertices() || scene.lamps.empty())
        return covered / num_pixels;
    const bool is_caught = catches(lighting);
    // Drawn before white, it shows by how much it is brighter.
    const relight::Backdrop white = relight::plain_backdrop(glm::vec3(1.0f)),
                            behind = is_caught ? backdrop(lighting) : white;
    const relight::PictureView floored(scene.mesh, rays, camera(), small_size(), opaque, 0);
    const Picture with = drawn(floored, lighting, is_caught ? &white : nullptr);
    const prt::PictureRays directions(camera(), with.width, with.height, 1);
    for (std::uint32_t i = 0; i < with.pixels.size(); ++i)
        if (seen.alpha[i] == 0.0f && (is_caught || with.alpha[i] == 1.0f))
            meter_floor(with.pixels[i], directions.direction(i % with.width, i / with.width, 0),
                        is_caught ? &behind : nullptr);
    return covered / num_pixels;
}

void Painter::Impl::meter_floor(const glm::vec3& color, const glm::vec3& direction,
                                const relight::Backdrop* behind) {
    constexpr float Brightened = 1.05f;
    if (behind == nullptr)
        metered.floor.push_back(color);
    else if (std::max({color.r, color.g, color.b}) > Brightened)
        metered.floor.push_back(color * (*behind)(glm::normalize(direction)));
}

relight::PictureOptions Painter::Impl::small_size() const {
    constexpr float Pixels = 256.0f * 192.0f;
    const float width = std::sqrt(Pixels * size().aspect());
    const auto side = [](float length) {
        return static_cast<std::uint32_t>(std::clamp(length, 1.0f, 4096.0f));
    };
    return {.width = side(width), .height = side(width / size().aspect()), .samples_per_axis = 1};
}

double Painter::Impl::most_exposure(const Lighting& lighting) const {
    constexpr double LeastPart = 0x1p-12;
    if (!lighting.open_floor || !scene.lamps.empty())
        return std::numeric_limits<double>::infinity();
    const glm::vec3& open = *lighting.open_floor;
    return std::round(-100.0 * std::log2(LeastPart *
                                         static_cast<double>(std::max({open.r, open.g, open.b})))) /
           100.0;
}

double Painter::Impl::exposure(const Lighting& lighting) {
    if (options.exposure_ev)
        return *options.exposure_ev;
    if (!chosen_ev) {
        if (metered.colors.empty() && metered.behind.empty())
            meter(lighting);
        const auto suitable = static_cast<double>(relight::suitable_exposure_ev(
            metered.colors, metered.weights, metered.behind,
            {.colors = metered.floor,
             .share = metered.num_pixels > 0.0 ? 1.0 / metered.num_pixels : 0.0}));
        chosen_ev = std::min(suitable, most_exposure(lighting));
        metered = {};
        small.reset();
    }
    return *chosen_ev;
}

} // namespace relumine
