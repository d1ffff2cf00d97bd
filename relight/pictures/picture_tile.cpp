#include "relight/pictures/picture_tile.h"

#include <algorithm>
#include <functional>

#include <glm/common.hpp>

#include "cubemap/luminance.h"
#include "prt/receivers/lit_position.h"

namespace relumine::relight {

namespace {

/// Alpha knows no colours.
float opacity_of(const glm::vec3& passed) {
    return std::clamp(1.0f - (passed.r + passed.g + passed.b) / 3.0f, 0.0f, 1.0f);
}

bool is_none(std::span<const std::uint16_t> lights) {
    return std::all_of(lights.begin(), lights.end(), [](std::uint16_t word) { return word == 0; });
}

} // namespace

PictureTile::PictureTile(const TileScene& scene)
    : scene_(scene), rays_{.blockers = &scene.rays, .bias = scene.light.bias},
      mirrors_(scene.mesh, scene.rays, scene.samples.twins(), scene.light, scene.floor,
               scene.backdrop != nullptr ? Mirrors::Behind(std::cref(*scene.backdrop)) : nullptr,
               texture_view_),
      refractions_(scene.mesh, scene.rays, scene.light, mirrors_, texture_view_),
      shading_(scene.mesh, scene.light, scene.packets, scene.samples.twins(), texture_view_),
      lights_(scene.mesh, scene.rays,
              scene.light.blockers != nullptr ? *scene.light.blockers
                                              : static_cast<const prt::Blockers&>(scene.rays),
              scene.light.bias, scene.beams),
      floor_shadows_(scene.mesh, scene.floor,
                     scene.light.blockers != nullptr
                         ? *scene.light.blockers
                         : static_cast<const prt::Blockers&>(scene.rays),
                     scene.light.bias, scene.floor_lights),
      own_lights_(scene.packets.num_packets()) {
    texture_view_ = {scene.eye, scene.grid};
    if (scene.light.textures != nullptr)
        texture_view_.maps = scene.light.textures->maps();
}

void PictureTile::draw(std::uint32_t tile, Picture& picture) {
    // The tile and a ring of pixels around it, for the lights and for what mirrors.
    static_assert(Mirrors::Reach <= PictureTiles::LargestRing &&
                  FloorShadows::Reach <= Mirrors::Reach);
    const bool traces = scene_.packets.num_packets() != 0;
    const std::uint32_t ring = scene_.light.reflections != nullptr ? Mirrors::Reach
                               : has_floor_lights()                ? FloorShadows::Reach
                               : traces                            ? 1
                                                                   : 0;
    const PixelRectangle inner = scene_.tiles.pixels(tile, 0);
    const SampleRectangle seen = scene_.samples.of(tile, ring);
    if (traces)
        lights_.trace(seen, inner);
    if (has_floor_lights())
        floor_shadows_.trace(seen, inner);
    if (scene_.light.reflections != nullptr)
        look_into_mirrors(seen);
    std::optional<BackdropPixels> behind;
    if (scene_.backdrop != nullptr)
        behind.emplace(scene_.grid, *scene_.backdrop, inner);
    for (std::uint32_t y = inner.top; y < inner.bottom; ++y)
        for (std::uint32_t x = inner.left; x < inner.right; ++x) {
            const std::size_t pixel = std::size_t{y} * picture.width + x;
            const auto [color, alpha] = drawn(x, y, seen.pixel(x, y));
            picture.pixels[pixel] = color;
            if (!behind)
                picture.alpha[pixel] = alpha;
            else if (alpha < 1.0f || scene_.light.open_floor)
                picture.pixels[pixel] += behind->seen(x, y, passed_);
        }
}

void PictureTile::look_into_mirrors(const SampleRectangle& seen) {
    const PixelRectangle& pixels = seen.pixels();
    std::vector<std::optional<prt::MeshPoint>> points;
    for (std::uint32_t y = pixels.top; y < pixels.bottom; ++y)
        for (std::uint32_t x = pixels.left; x < pixels.right; ++x) {
            const EyeSample& sample = seen.middle(x, y);
            points.push_back(sample.hits() ? std::optional(sample.point()) : std::nullopt);
        }
    mirrors_.begin_tile(pixels.left, pixels.top, static_cast<std::uint32_t>(pixels.width()),
                        points);
}

PictureTile::Pixel PictureTile::drawn(std::uint32_t x, std::uint32_t y,
                                      std::span<const EyeSample> samples) {
    passed_.assign(samples.size(), glm::vec3(1.0f));
    mirrors_.begin_pixel(x, y);
    find_parts(samples, scene_.packets.num_packets() == 0 || lights_.is_even(x, y));
    glm::vec3 sum(0.0f);
    float alpha = 0.0f;
    double num_seen = 0.0, brightest = 0.0;
    for (Part& part : parts_) {
        const EyeSample mean{part.sum.triangle, part.sum.second / part.count,
                             part.sum.third / part.count};
        const Shown seen =
            shown(x, y,
                  {mean, scene_.grid.direction(x, y, static_cast<std::uint32_t>(part.first)),
                   part.first});
        sum += part.count * seen.color;
        alpha += part.count * seen.covered;
        num_seen += part.count;
        brightest = std::max(brightest, cubemap::luminance(seen.color));
        if (seen.passed != glm::vec3(1.0f))
            for (std::size_t i = part.first; i < samples.size(); ++i)
                if (part_of_[i] == static_cast<std::size_t>(&part - parts_.data()))
                    passed_[i] = seen.passed;
    }
    const auto count = static_cast<float>(samples.size());
    Pixel pixel{.color = sum / count, .alpha = alpha / count};
    // A light that few samples find is a speck, or a gap in a bright line. Edges between bright and
    // dark have most of a picture's error, and are few pixels.
    constexpr double OverMean = 2.0;
    if (brightest * num_seen > OverMean * cubemap::luminance(sum)) {
        const auto [more, num_more] = further(x, y);
        pixel.color = glm::mix(pixel.color, more, num_more / (num_more + count));
    }
    return pixel;
}

std::pair<glm::vec3, float> PictureTile::further(std::uint32_t x, std::uint32_t y) {
    const std::uint32_t per_axis = 2 * scene_.grid.samples_per_axis();
    const auto step = 1.0f / static_cast<float>(per_axis);
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = 0; i < per_axis * per_axis; ++i) {
        const glm::vec2 place =
            glm::vec2(x, y) + step * (glm::vec2(i % per_axis, i / per_axis) + 0.5f);
        const glm::vec3 direction = scene_.grid.direction(place);
        const auto met = scene_.seen.rays().closest_hit(scene_.eye, direction, prt::RayOf::Eye);
        if (!met)
            continue;
        const prt::Hit hit = scene_.samples.twins().facing(*met, direction);
        sum += shown(x, y,
                     {.sample = {hit.triangle, hit.barycentric.x, hit.barycentric.y},
                      .direction = direction,
                      .number = i % scene_.grid.samples_per_pixel(),
                      .is_known = false})
                   .color;
    }
    const auto count = static_cast<float>(per_axis * per_axis);
    return {sum / count, count};
}

bool PictureTile::is_linear(std::uint32_t triangle) const {
    return scene_.light.reflections == nullptr && !shading_.has_texture(triangle) &&
           !scene_.rays.is_thin(triangle);
}

void PictureTile::find_parts(std::span<const EyeSample> samples, bool is_even) {
    /// Samples look for their triangle among so many parts, those before them.
    constexpr std::size_t Looks = 8;
    constexpr std::size_t NoPart = ~std::size_t{0};
    parts_.clear();
    part_of_.assign(samples.size(), NoPart);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const EyeSample& sample = samples[i];
        if (!sample.hits())
            continue;
        std::size_t part = parts_.size();
        if (is_even && is_linear(sample.triangle))
            for (std::size_t k = 1; k <= std::min(Looks, parts_.size()); ++k)
                if (parts_[parts_.size() - k].sum.triangle == sample.triangle) {
                    part = parts_.size() - k;
                    break;
                }
        if (part == parts_.size())
            parts_.push_back({.sum = {sample.triangle, 0.0f, 0.0f}, .count = 0.0f, .first = i});
        Part& own = parts_[part];
        own.sum.second += sample.second;
        own.sum.third += sample.third;
        own.count += 1.0f;
        part_of_[i] = part;
    }
}

PictureTile::Shown PictureTile::shown(std::uint32_t x, std::uint32_t y, const SeenAt& seen) {
    const MeshLight& light = scene_.light;
    const bool traces = scene_.packets.num_packets() != 0;
    Shown result;
    for (const Layer& layer : layers(seen)) {
        const EyeSample& sample = layer.sample;
        const float opacity = this->opacity(sample);
        if (opacity == 0.0f)
            continue;
        const prt::MeshPoint at = sample.point();
        const bool is_floor = this->is_floor(sample);
        const bool is_caught = is_floor && light.open_floor;
        const std::optional<Mirror> mirror = mirrors_.at(at);
        const glm::vec3 gathered =
            scene_.gathered != nullptr ? scene_.gathered->change(x, y, at) : glm::vec3(0.0f);
        glm::vec3 radiance = shading_.soft(at, mirror, mirrors_, gathered);
        if (traces) {
            std::span<const std::uint16_t> lights = own_lights_;
            if (layer.is_first && seen.is_known)
                lights = lights_.of(x, y, seen.number);
            else
                trace_own(at);
            if (!is_none(lights))
                radiance += is_caught ? shading_.white(prt::shading_normal(scene_.mesh, at), lights)
                                      : shading_.traced(at, mirror, lights);
        }
        if (const auto other = shading_.other_side(at)) {
            radiance += shading_.soft(*other, mirror);
            if (traces) {
                trace_own(other->at);
                radiance += shading_.traced(*other, mirror, own_lights_);
            }
        }
        if (is_floor && has_floor_lights()) {
            const glm::vec3 shaded = layer.is_first && seen.is_known
                                         ? floor_shadows_.of(x, y)
                                         : floor_shadows_.at(at, seen.number);
            radiance += is_caught || light.albedo.empty()
                            ? shaded
                            : shaded * prt::value_at(scene_.mesh, light.albedo, at);
        }
        if (!is_caught)
            result.color += result.passed * (layer.veil.weight * opacity) *
                            (radiance + shading_.emitted(at, mirror));
        if (mirror && refractions_.bends(*mirror, at)) {
            result.color += result.passed * layer.veil.weight *
                            refractions_.light(*mirror, at, static_cast<std::uint32_t>(seen.number),
                                               mirrors_.shift());
            result.passed *= 1.0f - layer.veil.weight;
            result.covered += (1.0f - result.covered) * layer.veil.weight;
            if (layer.veil.weight == 1.0f)
                break;
            continue;
        }
        const glm::vec3 passed = is_caught ? caught(radiance, *light.open_floor, opacity)
                                           : 1.0f - opacity * (1.0f - layer.veil.through);
        result.passed *= passed;
        result.covered +=
            (1.0f - result.covered) *
            (is_caught || layer.veil.through != glm::vec3(0.0f) ? opacity_of(passed) : opacity);
    }
    return result;
}

void PictureTile::trace_own(const prt::MeshPoint& at) {
    const glm::vec3 normal = prt::mapped_normal(scene_.mesh, at);
    scene_.packets.visible(prt::lit_position(scene_.mesh, scene_.rays, at, normal, rays_.bias),
                           normal, rays_, own_lights_);
}

std::span<const PictureTile::Layer> PictureTile::layers(const SeenAt& seen) {
    layers_.assign(1, {seen.sample});
    if (!scene_.rays.is_thin(seen.sample.triangle))
        return layers_;
    scene_.seen.rays().layers(scene_.eye, seen.direction, found_);
    layers_.clear();
    for (const prt::RayScene::Layer& layer : found_)
        layers_.push_back({{layer.hit.triangle, layer.hit.barycentric.x, layer.hit.barycentric.y},
                           layer.veil,
                           layers_.empty()});
    return layers_;
}

float PictureTile::opacity(const EyeSample& sample) const {
    if (!scene_.floor.has(scene_.mesh.triangles[sample.triangle]))
        return 1.0f;
    return scene_.floor.opacity(prt::value_at(scene_.mesh, scene_.mesh.positions, sample.point()));
}

} // namespace relumine::relight
