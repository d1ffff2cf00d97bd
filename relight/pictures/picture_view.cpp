#include "relight/pictures/picture_view.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "files/parallel.h"
#include "prt/glossy/brdf.h"
#include "prt/receivers/mesh_point.h"
#include "relight/harmonics/harmonics.h"
#include "relight/pictures/mirrors.h"
#include "relight/sharp/light_packets.h"

namespace relumine::relight {

namespace {

constexpr std::uint32_t NoTriangle = ~std::uint32_t{0};

/// Pixels of a tile, on a side: small enough for the caches, large enough that the ring of pixels
/// around it, whose lights are looked at too, is a small part of the work.
constexpr std::uint32_t TileSize = 32;

using Lanes = std::vector<std::uint16_t>;

/// Alpha knows no colours.
float opacity_of(const glm::vec3& passed) {
    return std::clamp(1.0f - (passed.r + passed.g + passed.b) / 3.0f, 0.0f, 1.0f);
}

} // namespace

float FadingFloor::opacity(const glm::vec3& position) const {
    const float radius = glm::distance(glm::vec2(position.x, position.z), center);
    if (radius <= opaque_radius)
        return 1.0f;
    if (radius >= end_radius)
        return 0.0f;
    const float t = (end_radius - radius) / (end_radius - opaque_radius);
    return t * t * (3.0f - 2.0f * t);
}

glm::vec3 caught(const glm::vec3& radiance, const glm::vec3& open, float opacity) {
    glm::vec3 result(1.0f);
    for (int channel = 0; channel < 3; ++channel)
        if (open[channel] > 0.0f)
            result[channel] += opacity * (radiance[channel] / open[channel] - 1.0f);
    return result;
}

PictureView::PictureView(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                         const Camera& camera, const PictureOptions& options,
                         const FadingFloor& floor, std::size_t max_bytes)
    : mesh_(mesh), rays_(rays), camera_(camera), options_(options), floor_(floor),
      grid_(camera, options.width, options.height, options.samples_per_axis),
      twins_(std::make_unique<const prt::TwinTriangles>(mesh)) {
    const std::size_t num_samples =
        std::size_t{options.width} * options.height * grid_.samples_per_pixel();
    if (num_samples > max_bytes / sizeof(Sample))
        return;
    samples_.resize(num_samples);
    const std::size_t per_row = std::size_t{options.width} * grid_.samples_per_pixel();
    files::parallel_for(std::uint32_t{0}, options.height, [&](std::uint32_t y) {
        if (!options_.stop.stop_requested())
            trace(y, 0, options_.width, std::span(samples_).subspan(y * per_row, per_row));
    });
}

/// Finds what the samples of some pixels of a row see.
void PictureView::trace(std::uint32_t y, std::uint32_t x_begin, std::uint32_t x_end,
                        std::span<Sample> samples) const {
    const std::uint32_t per_pixel = grid_.samples_per_pixel();
    prt::DirectionPacket packet;
    std::array<prt::Hit, prt::PacketSize> hits;
    std::size_t done = 0;
    const auto trace_packet = [&] {
        const auto num = packet.num_directions;
        for (std::size_t lane = num; lane < prt::PacketSize; ++lane)
            packet.set(lane, {packet.x[0], packet.y[0], packet.z[0]});
        const std::uint32_t found =
            rays_.closest_hits(camera_.eye, packet, (1u << num) - 1u, hits, prt::RayOf::Eye);
        for (std::uint32_t lane = 0; lane < num; ++lane, ++done) {
            samples[done] = {NoTriangle, 0.0f, 0.0f};
            if ((found >> lane & 1u) == 0)
                continue;
            const prt::Hit hit =
                twins_->facing(hits[lane], {packet.x[lane], packet.y[lane], packet.z[lane]});
            samples[done] = {hit.triangle, hit.barycentric.x, hit.barycentric.y};
        }
        packet.num_directions = 0;
    };
    for (std::uint32_t x = x_begin; x < x_end; ++x)
        for (std::uint32_t i = 0; i < per_pixel; ++i) {
            packet.set(packet.num_directions++, grid_.direction(x, y, i));
            if (packet.num_directions == prt::PacketSize)
                trace_packet();
        }
    if (packet.num_directions != 0)
        trace_packet();
}

float PictureView::opacity(const Sample& sample) const {
    if (sample.triangle == NoTriangle)
        return 0.0f;
    const mesh::Triangle& triangle = mesh_.triangles[sample.triangle];
    if (!floor_.has(triangle))
        return 1.0f;
    return floor_.opacity(
        prt::value_at(mesh_, mesh_.positions,
                      {.triangle = sample.triangle, .barycentric = {sample.second, sample.third}}));
}

/// The samples of some pixels of a row, kept or traced.
class PictureView::Row {
public:
    Row(const PictureView& view, std::uint32_t y, std::uint32_t x_begin, std::uint32_t x_end)
        : per_pixel_(view.grid_.samples_per_pixel()), x_begin_(x_begin) {
        const std::size_t count = std::size_t{x_end - x_begin} * per_pixel_;
        if (!view.samples_.empty()) {
            samples_ =
                std::span(view.samples_)
                    .subspan((std::size_t{y} * view.options_.width + x_begin) * per_pixel_, count);
            return;
        }
        own_.resize(count);
        view.trace(y, x_begin, x_end, own_);
        samples_ = own_;
    }
    [[nodiscard]] std::span<const Sample> pixel(std::uint32_t x) const {
        return samples_.subspan(std::size_t{x - x_begin_} * per_pixel_, per_pixel_);
    }

private:
    std::size_t per_pixel_;
    std::uint32_t x_begin_;
    std::vector<Sample> own_;
    std::span<const Sample> samples_;
};

/// Draws a square of pixels.
class PictureView::Tile {
public:
    Tile(const PictureView& view, const MeshLight& light, const LightPackets& packets,
         const Backdrop* backdrop)
        : view_(view), mesh_(view.mesh_), light_(light),
          packets_(packets), rays_{.blockers = &view.rays_, .bias = light.bias},
          backdrop_(backdrop),
          mirrors_(mesh_, *view.twins_, light, view.floor_, backdrop, texture_view_),
          lanes_(packets.num_packets()) {
        if (light.textures != nullptr && light.textures->maps() != nullptr)
            texture_view_ = {*light.textures->maps(), view.camera_.eye, view.grid_};
    }

    /// Draws the mesh alone, with its alpha, where there is no backdrop.
    void draw(std::uint32_t x_begin, std::uint32_t y_begin, Picture& picture) {
        const std::uint32_t x_end = std::min(x_begin + TileSize, picture.width);
        const std::uint32_t y_end = std::min(y_begin + TileSize, picture.height);
        // The tile and a ring of pixels around it, for the lights and for what mirrors.
        const std::uint32_t ring = light_.reflections != nullptr ? Mirrors::Reach
                                   : packets_.num_packets() != 0 ? 1
                                                                 : 0;
        left_ = x_begin - std::min(x_begin, ring);
        top_ = y_begin - std::min(y_begin, ring);
        const std::uint32_t right = std::min(x_end + ring, picture.width);
        const std::uint32_t bottom = std::min(y_end + ring, picture.height);
        width_ = right - left_;
        rows_.clear();
        for (std::uint32_t y = top_; y < bottom; ++y)
            rows_.emplace_back(view_, y, left_, right);
        if (packets_.num_packets() != 0)
            look_at_lights(right, bottom);
        if (light_.reflections != nullptr)
            look_into_mirrors(right, bottom);

        for (std::uint32_t y = y_begin; y < y_end; ++y)
            for (std::uint32_t x = x_begin; x < x_end; ++x) {
                const std::size_t pixel = std::size_t{y} * picture.width + x;
                const auto [color, alpha] = drawn(x, y, right, bottom);
                picture.pixels[pixel] = color;
                if (backdrop_ == nullptr)
                    picture.alpha[pixel] = alpha;
                else if (alpha < 1.0f || light_.open_floor)
                    picture.pixels[pixel] += seen_behind(view_.grid_, x, y, passed_, *backdrop_);
            }
    }

private:
    struct Pixel {
        glm::vec3 color;
        float alpha;
    };

    [[nodiscard]] static prt::MeshPoint point(const Sample& sample) {
        return {.triangle = sample.triangle, .barycentric = {sample.second, sample.third}};
    }

    [[nodiscard]] bool has_texture(const Sample& sample) const {
        return light_.textures != nullptr && light_.textures->has(sample.triangle);
    }

    /// Returns what a sample sends on of the light of the vertices.
    [[nodiscard]] glm::vec3 soft(const Sample& sample, const std::optional<Mirror>& mirror) {
        const prt::MeshPoint at = point(sample);
        if (mirror)
            return mirrors_.soft(*mirror, at,
                                 light_.textures->light(light_.radiance, at, tilted(at)));
        if (!has_texture(sample))
            return prt::value_at(mesh_, light_.radiance, at);
        const glm::vec3 change = tilted(at);
        if (light_.lobes.empty())
            return light_.textures->radiance(light_.radiance, at, change, &texture_view_);
        const mesh::Triangle& triangle = mesh_.triangles[at.triangle];
        const glm::vec2& w = at.barycentric;
        prt::Lobes<glm::vec3> between;
        prt::add_scaled(between, light_.lobes[triangle[0]], 1.0f - w.x - w.y);
        prt::add_scaled(between, light_.lobes[triangle[1]], w.x);
        prt::add_scaled(between, light_.lobes[triangle[2]], w.y);
        between.diffuse = glm::max(between.diffuse + change, 0.0f);
        return prt::reflect(surface_at(sample), between, eye_cosine(at));
    }

    /// Returns what a normal map adds to the diffuse radiance of albedo 1: the light of its normal
    /// less that of the mesh's normal, so that a flat map adds nothing.
    [[nodiscard]] glm::vec3 tilted(const prt::MeshPoint& at) const {
        if (light_.harmonics.empty())
            return glm::vec3(0.0f);
        const glm::vec3 normal = prt::shading_normal(mesh_, at);
        const glm::vec3 mapped = prt::mapped_normal(mesh_, at);
        if (mapped == normal)
            return glm::vec3(0.0f);
        const std::size_t count = light_.harmonics.size() / mesh_.num_vertices();
        const glm::vec2& w = at.barycentric;
        const std::array<float, 3> weights = {1.0f - w.x - w.y, w.x, w.y};
        std::array<glm::vec3, MaxHarmonics> between{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::size_t first = mesh_.triangles[at.triangle][corner] * count;
            for (std::size_t i = 0; i < count; ++i)
                between[i] += weights[corner] * light_.harmonics[first + i];
        }
        const auto light = std::span(between).first(count);
        return glm::vec3((irradiance(light, mapped) - irradiance(light, normal)) /
                         std::numbers::pi);
    }

    /// Returns the cosine between normal and eye, 0 without an eye.
    [[nodiscard]] float eye_cosine(const prt::MeshPoint& at) const {
        if (!light_.eye)
            return 0.0f;
        return glm::dot(prt::shading_normal(mesh_, at),
                        glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, at)));
    }

    /// Returns what a sample gives of its own.
    [[nodiscard]] glm::vec3 emitted(const Sample& sample,
                                    const std::optional<Mirror>& mirror) const {
        if (light_.emission.empty())
            return glm::vec3(0.0f);
        const glm::vec3 gain = light_.emission_gain(sample.triangle);
        if (mirror)
            return gain * mirror->surface.emission;
        return has_texture(sample)
                   ? gain * light_.textures->surface(point(sample), &texture_view_).emission
                   : prt::value_at(mesh_, light_.emission, point(sample));
    }

    /// Finds the lights that reach a sample.
    void look(const Sample& sample, std::span<std::uint16_t> lanes) const {
        const prt::MeshPoint at = point(sample);
        packets_.visible(prt::smooth_position(mesh_, at), prt::mapped_normal(mesh_, at), rays_,
                         lanes);
    }

    [[nodiscard]] std::span<std::uint16_t> lanes_of(std::uint32_t x, std::uint32_t y) {
        const std::size_t pixel = std::size_t{y - top_} * width_ + (x - left_);
        return std::span(middles_).subspan(pixel * packets_.num_packets(), packets_.num_packets());
    }
    [[nodiscard]] static const Sample& middle(std::span<const Sample> samples) {
        return samples[samples.size() / 2];
    }

    /// Finds the lights that reach the middle of every pixel.
    void look_at_lights(std::uint32_t right, std::uint32_t bottom) {
        middles_.assign(std::size_t{width_} * (bottom - top_) * packets_.num_packets(), 0);
        for (std::uint32_t y = top_; y < bottom; ++y)
            for (std::uint32_t x = left_; x < right; ++x)
                if (const Sample& sample = middle(rows_[y - top_].pixel(x));
                    sample.triangle != NoTriangle)
                    look(sample, lanes_of(x, y));
    }

    void look_into_mirrors(std::uint32_t right, std::uint32_t bottom) {
        std::vector<std::optional<prt::MeshPoint>> points;
        for (std::uint32_t y = top_; y < bottom; ++y)
            for (std::uint32_t x = left_; x < right; ++x) {
                const Sample& sample = middle(rows_[y - top_].pixel(x));
                points.push_back(sample.triangle == NoTriangle ? std::nullopt
                                                               : std::optional(point(sample)));
            }
        mirrors_.begin_tile(left_, top_, width_, points);
    }

    /// Whether all pixels around see the same lights.
    [[nodiscard]] bool is_even(std::uint32_t x, std::uint32_t y, std::uint32_t right,
                               std::uint32_t bottom) {
        const std::span<const std::uint16_t> own = lanes_of(x, y);
        for (std::uint32_t v = y - std::min(y - top_, 1u); v < std::min(y + 2, bottom); ++v)
            for (std::uint32_t u = x - std::min(x - left_, 1u); u < std::min(x + 2, right); ++u)
                if (const auto other = lanes_of(u, v);
                    !std::equal(own.begin(), own.end(), other.begin()))
                    return false;
        return true;
    }

    [[nodiscard]] Pixel drawn(std::uint32_t x, std::uint32_t y, std::uint32_t right,
                              std::uint32_t bottom) {
        const std::span<const Sample> samples = rows_[y - top_].pixel(x);
        const bool traces = packets_.num_packets() != 0;
        const bool even = traces && is_even(x, y, right, bottom);
        if (even) {
            const auto lanes = lanes_of(x, y);
            std::copy(lanes.begin(), lanes.end(), lanes_.begin());
        }
        const bool is_dark = even && std::all_of(lanes_.begin(), lanes_.end(),
                                                 [](std::uint16_t lanes) { return lanes == 0; });
        glm::vec3 sum(0.0f);
        float alpha = 0.0f;
        passed_.assign(samples.size(), glm::vec3(1.0f));
        mirrors_.begin_pixel(x, y);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            float covered = 0.0f;
            for (const Layer& layer : layers(x, y, static_cast<std::uint32_t>(i), samples[i])) {
                const Sample& sample = layer.sample;
                const float opacity = view_.opacity(sample);
                if (opacity == 0.0f)
                    continue;
                const bool is_caught = catches(sample);
                const std::optional<Mirror> mirror = mirrors_.at(point(sample));
                glm::vec3 radiance = soft(sample, mirror);
                if (traces && !(is_dark && layer.is_first)) {
                    if (!even || !layer.is_first)
                        look(sample, lanes_);
                    radiance += is_caught ? white(prt::shading_normal(mesh_, point(sample)))
                                          : traced(sample, mirror);
                }
                if (!is_caught)
                    sum += passed_[i] * (layer.veil.weight * opacity) *
                           (radiance + emitted(sample, mirror));
                const glm::vec3 passed = is_caught ? caught(radiance, *light_.open_floor, opacity)
                                                   : 1.0f - opacity * (1.0f - layer.veil.through);
                passed_[i] *= passed;
                covered += (1.0f - covered) * (is_caught || layer.veil.through != glm::vec3(0.0f)
                                                   ? opacity_of(passed)
                                                   : opacity);
            }
            alpha += covered;
        }
        const auto count = static_cast<float>(samples.size());
        return {.color = sum / count, .alpha = alpha / count};
    }

    /// What a sample sees, one behind the other.
    struct Layer {
        Sample sample;
        mesh::Veil veil = {};
        bool is_first = true;
    };
    [[nodiscard]] std::span<const Layer> layers(std::uint32_t x, std::uint32_t y, std::uint32_t i,
                                                const Sample& first) {
        layers_.assign(1, {first});
        if (first.triangle == NoTriangle || !view_.rays_.is_thin(first.triangle))
            return layers_;
        view_.rays_.layers(view_.camera_.eye, view_.grid_.direction(x, y, i), found_);
        layers_.clear();
        for (const prt::RayScene::Layer& layer : found_)
            layers_.push_back(
                {{layer.hit.triangle, layer.hit.barycentric.x, layer.hit.barycentric.y},
                 layer.veil,
                 layers_.empty()});
        return layers_;
    }

    /// Whether a sample lies on a floor that catches shadows.
    [[nodiscard]] bool catches(const Sample& sample) const {
        return light_.open_floor && view_.floor_.has(mesh_.triangles[sample.triangle]);
    }

    /// Returns what the lights in lanes_ give to a white Lambert surface. Samples beside each other
    /// mostly see the same lights.
    [[nodiscard]] glm::vec3 white(const glm::vec3& normal) {
        if (lanes_ != summed_) {
            summed_ = lanes_;
            sum_ = packets_.irradiance(lanes_);
        }
        return glm::vec3(sum_.on(normal) / std::numbers::pi);
    }

    /// Returns what a sample sends on of the lights in lanes_.
    [[nodiscard]] glm::vec3 traced(const Sample& sample, const std::optional<Mirror>& mirror) {
        if (std::all_of(lanes_.begin(), lanes_.end(),
                        [](std::uint16_t lanes) { return lanes == 0; }))
            return glm::vec3(0.0f);
        const prt::MeshPoint at = point(sample);
        const glm::vec3 normal = prt::mapped_normal(mesh_, at);
        const glm::vec3 albedo =
            light_.albedo.empty() ? glm::vec3(1.0f) : prt::value_at(mesh_, light_.albedo, at);
        if (light_.surfaces.empty())
            return albedo * white(normal);
        if (mirror) {
            prt::Surface surface = mirror->surface;
            const float least = light_.reflections->least_roughness();
            if (prt::facts_of(surface.highlight).is_roughness)
                surface.roughness_or_exponent = std::max(surface.roughness_or_exponent, least);
            surface.coat_roughness = std::max(surface.coat_roughness, least);
            return albedo * reflected(surface, mirror->normal, mirror->to_eye);
        }
        const prt::Surface surface = surface_at(sample);
        if (surface.highlight == prt::Highlight::None || !light_.eye)
            return albedo * prt::reflect(surface, {.diffuse = white(normal)}, 0.0f);
        return albedo *
               reflected(surface, normal,
                         glm::normalize(*light_.eye - prt::value_at(mesh_, mesh_.positions, at)));
    }

    /// Returns what a surface sends to the eye of the lights in lanes_.
    [[nodiscard]] glm::vec3 reflected(const prt::Surface& surface, const glm::vec3& normal,
                                      const glm::vec3& to_eye) const {
        prt::BlockSurfaces block;
        block.set(0, surface, normal, to_eye);
        prt::Lobes<glm::dvec3> lobes;
        packets_.light_block(block, {&normal, 1}, lanes_, {&lobes, 1});
        return prt::reflect(surface, prt::converted<glm::vec3>(lobes), {surface, normal, to_eye});
    }

    /// Returns the surface between the vertices', with the highlight of the nearest and the colours
    /// of the textures.
    [[nodiscard]] prt::Surface surface_at(const Sample& sample) const {
        const prt::MeshPoint at = point(sample);
        const mesh::Triangle& triangle = mesh_.triangles[at.triangle];
        const std::array<float, 3> weights = {1.0f - at.barycentric.x - at.barycentric.y,
                                              at.barycentric.x, at.barycentric.y};
        const auto nearest = static_cast<std::size_t>(
            std::max_element(weights.begin(), weights.end()) - weights.begin());
        prt::Surface surface = light_.surfaces[triangle[nearest]];
        surface.albedo = surface.specular = surface.sheen = glm::vec3(0.0f);
        surface.coat = 0.0f;
        float shape = 0.0f, metallic = 0.0f;
        bool is_same = true;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const prt::Surface& own = light_.surfaces[triangle[corner]];
            surface.albedo += weights[corner] * own.albedo;
            surface.specular += weights[corner] * own.specular;
            surface.coat += weights[corner] * own.coat;
            surface.sheen += weights[corner] * own.sheen;
            metallic += weights[corner] * own.metallic;
            shape += weights[corner] * own.roughness_or_exponent;
            is_same = is_same && own.highlight == surface.highlight;
        }
        if (is_same)
            surface.roughness_or_exponent = shape;
        surface.metallic = metallic;
        if (has_texture(sample)) {
            const prt::Surface own = light_.textures->surface(at, &texture_view_);
            surface.albedo = own.albedo;
            surface.specular = own.specular;
            surface.metallic = own.metallic;
        }
        return surface;
    }

    const PictureView& view_;
    const mesh::TriangleMesh& mesh_;
    const MeshLight& light_;
    const LightPackets& packets_;
    ShadowRays rays_;
    /// Used where triangles have textures.
    prt::TextureView texture_view_;
    const Backdrop* backdrop_;
    Mirrors mirrors_;
    std::uint32_t left_ = 0, top_ = 0, width_ = 0;
    std::vector<Row> rows_;
    /// [pixels of the tile and its ring x packets]
    Lanes middles_;
    /// Scratch: [packets]
    Lanes lanes_;
    /// The lanes whose lights were summed last, and their sum.
    Lanes summed_;
    VectorIrradiance sum_;
    /// Scratch of layers()
    std::vector<Layer> layers_;
    std::vector<prt::RayScene::Layer> found_;
    /// [samples of a pixel] what passes of the light behind.
    std::vector<glm::vec3> passed_;
};

Picture PictureView::drawn(const MeshLight& light, const Backdrop* backdrop) const {
    const auto fits = [&](std::size_t size) {
        return size == 0 || size == mesh_.num_vertices();
    };
    if (light.radiance.size() != mesh_.num_vertices() || !fits(light.albedo.size()) ||
        !fits(light.surfaces.size()) || !fits(light.lobes.size()) || !fits(light.emission.size()) ||
        (light.reflections != nullptr && light.mirrored.size() != mesh_.num_vertices()) ||
        light.harmonics.size() % mesh_.num_vertices() != 0 ||
        light.harmonics.size() / mesh_.num_vertices() > MaxHarmonics)
        throw std::invalid_argument("expected one radiance, albedo and surface per vertex");
    const LightPackets packets(light.lights);
    Picture picture{.width = options_.width, .height = options_.height};
    picture.pixels.resize(std::size_t{options_.width} * options_.height);
    if (backdrop == nullptr)
        picture.alpha.resize(picture.pixels.size());
    const std::uint32_t num_columns = (options_.width + TileSize - 1) / TileSize;
    const std::uint32_t num_rows = (options_.height + TileSize - 1) / TileSize;
    const std::uint32_t num_tiles = num_columns * num_rows;
    std::mutex mutex;
    std::uint32_t num_drawn = 0;
    files::parallel_for(std::uint32_t{0}, num_tiles, [&](std::uint32_t tile) {
        if (options_.stop.stop_requested())
            return;
        Tile(*this, light, packets, backdrop)
            .draw(tile % num_columns * TileSize, tile / num_columns * TileSize, picture);
        if (!options_.on_progress)
            return;
        const std::scoped_lock lock(mutex);
        options_.on_progress(static_cast<double>(++num_drawn) / num_tiles);
    });
    return picture;
}

Picture PictureView::cut_out(const MeshLight& light) const {
    return drawn(light, nullptr);
}

Picture PictureView::draw(const MeshLight& light, const Backdrop& backdrop) const {
    return drawn(light, &backdrop);
}

} // namespace relumine::relight
