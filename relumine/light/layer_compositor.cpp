#include "relumine/light/layer_compositor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "files/parallel.h"
#include "relight/radiance.h"

namespace relumine {

namespace {

/// Appends the tiles of 16 x 16 texels in which two maps of one resolution differ. NaN differs from
/// everything.
void append_changed_tiles(const cubemap::CubeMap& before, const cubemap::CubeMap& after,
                          std::vector<cubemap::TexelRectangle>& tiles) {
    constexpr std::uint32_t EditTileSize = 16;
    const std::uint32_t r = before.resolution;
    const std::uint32_t rows = (r + EditTileSize - 1) / EditTileSize;
    std::vector<std::vector<cubemap::TexelRectangle>> of_row(cubemap::NumFaces * std::size_t{rows});
    files::parallel_for(std::size_t{0}, of_row.size(), [&](std::size_t i) {
        const cubemap::Face face = cubemap::AllFaces[i / rows];
        const auto y = static_cast<std::uint32_t>(i % rows) * EditTileSize;
        for (std::uint32_t x = 0; x < r; x += EditTileSize) {
            const cubemap::TexelRectangle tile{.face = face,
                                               .x0 = x,
                                               .y0 = y,
                                               .x1 = std::min(x + EditTileSize, r),
                                               .y1 = std::min(y + EditTileSize, r)};
            bool equal = true;
            for (std::uint32_t row = tile.y0; equal && row < tile.y1; ++row) {
                const glm::vec3* of_before = &before.at(face, x, row);
                equal =
                    std::equal(of_before, of_before + (tile.x1 - tile.x0), &after.at(face, x, row));
            }
            if (!equal)
                of_row[i].push_back(tile);
        }
    });
    for (const std::vector<cubemap::TexelRectangle>& some : of_row)
        tiles.insert(tiles.end(), some.begin(), some.end());
}

void require_radiance_in(const cubemap::CubeMap& map,
                         std::span<const cubemap::TexelRectangle> rectangles) {
    for (const cubemap::TexelRectangle& rectangle : rectangles)
        for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
            relight::require_radiance(
                {&map.at(rectangle.face, rectangle.x0, y), rectangle.x1 - rectangle.x0});
}

/// Adds the parts of a rectangle that no rectangle of the list covers.
void append_uncovered(const cubemap::TexelRectangle& rectangle, std::size_t first,
                      std::vector<cubemap::TexelRectangle>& list) {
    for (std::size_t i = first; i < list.size(); ++i) {
        const cubemap::TexelRectangle there = list[i];
        if (there.face != rectangle.face || there.x0 >= rectangle.x1 || there.x1 <= rectangle.x0 ||
            there.y0 >= rectangle.y1 || there.y1 <= rectangle.y0)
            continue;
        // Parts above and below have the full width; parts on the left and right lie between them.
        cubemap::TexelRectangle above = rectangle, below = rectangle, left = rectangle,
                                right = rectangle;
        above.y1 = left.y0 = right.y0 = std::max(rectangle.y0, there.y0);
        below.y0 = left.y1 = right.y1 = std::min(rectangle.y1, there.y1);
        left.x1 = std::max(rectangle.x0, there.x0);
        right.x0 = std::min(rectangle.x1, there.x1);
        for (const cubemap::TexelRectangle& part : {above, below, left, right})
            if (part.x0 < part.x1 && part.y0 < part.y1)
                append_uncovered(part, i + 1, list);
        return;
    }
    list.push_back(rectangle);
}

/// Returns the piece by which one stroke continues another, made a little wider; nothing for other
/// pairs of layers. A stroke that is being painted grows by such pieces.
std::optional<cubemap::LightLayer>
added_piece(const cubemap::LightLayer& a, const cubemap::LightLayer& b, std::uint32_t resolution) {
    const auto* from = std::get_if<cubemap::Stroke>(&a.region);
    const auto* to = std::get_if<cubemap::Stroke>(&b.region);
    if (!from || !to || a.on != b.on || a.gain_ev != b.gain_ev || a.kelvin != b.kelvin ||
        a.effect != b.effect || from->radius_degrees != to->radius_degrees ||
        from->softness != to->softness)
        return std::nullopt;
    if (from->points.size() > to->points.size())
        std::swap(from, to);
    if (!std::equal(from->points.begin(), from->points.end(), to->points.begin()))
        return std::nullopt;
    // A texel at the rim of both strokes is fitted to the distance at its corners. So a piece also
    // changes texels near it that it does not cover. They lie within three times the chord from a
    // texel's centre to its corner; touched_texels() adds one of the three.
    constexpr double Radian = 180.0 / std::numbers::pi;
    const double margin = 2.0 * 1.5 / resolution;
    const double chord = 2.0 * std::sin(0.5 * to->radius_degrees / Radian) + margin;
    cubemap::LightLayer piece = b;
    cubemap::Stroke stroke = *to;
    stroke.points.assign(to->points.begin() + static_cast<std::ptrdiff_t>(from->points.size()) - 1,
                         to->points.end());
    stroke.radius_degrees = 2.0 * std::asin(std::min(0.5 * chord, 1.0)) * Radian;
    stroke.softness = 0.0;
    if (stroke.radius_degrees > 90.0)
        return std::nullopt;
    piece.region = std::move(stroke);
    return piece;
}

} // namespace

LayerCompositor::LayerCompositor(const LightState& state, cubemap::CubeMap memory)
    : LayerCompositor(state, state.base->map()) {
    if (rotation_degrees_ == 0.0)
        return;
    turned_base_ = std::make_shared<cubemap::CubeMap>(
        cubemap::rotated(*state.base->map(), rotation_degrees_, std::move(memory)));
    now_.base = turned_base_;
}

LayerCompositor::LayerCompositor(const LightState& state,
                                 std::shared_ptr<const cubemap::CubeMap> turned_base)
    : rotation_degrees_(state.rotation_degrees), now_{.base = std::move(turned_base)} {
    turn_layers(state, now_.layers);
}

cubemap::CubeMap LayerCompositor::take_turned() {
    // turned_base_ and now_.base
    if (!turned_base_ || turned_base_.use_count() > 2)
        return {};
    return std::exchange(*turned_base_, {});
}

std::shared_ptr<const cubemap::CubeMap> LayerCompositor::base_alone() {
    if (std::any_of(now_.layers.begin(), now_.layers.end(),
                    [](const cubemap::LightLayer& layer) { return layer.on; }))
        return nullptr;
    changed_ = cubemap::all_texels(now_.base->resolution);
    return now_.base;
}

cubemap::CubeMap LayerCompositor::whole(cubemap::CubeMap memory) {
    changed_ = cubemap::all_texels(now_.base->resolution);
    memory = cubemap::written_over(std::move(memory), now_.base->resolution);
    cubemap::composite(*now_.base, now_.layers, changed_, memory);
    return memory;
}

void LayerCompositor::turn_layers(const LightState& state,
                                  std::vector<cubemap::LightLayer>& turned) const {
    turned = cubemap::without_solo(state.layers);
    if (rotation_degrees_ != 0.0)
        for (cubemap::LightLayer& layer : turned)
            layer.region = cubemap::turned(layer.region, rotation_degrees_);
}

void LayerCompositor::find_changes(const LightState& next) {
    turn_layers(next, next_.layers);
    next_.base = rotation_degrees_ == 0.0 ? next.base->map() : now_.base;
    changed_.clear();
    touched_.clear();
    if (next_.base != now_.base) {
        append_changed_tiles(*now_.base, *next_.base, changed_);
        require_radiance_in(*next_.base, changed_); // the rest was checked before
    }
    // Equal layers at the same place in both lists change nothing. Every other layer dirties the
    // texels that it covers, before and after. A layer that moved within the list is compared with
    // its new neighbour, and so dirtied.
    const auto add = [&](const cubemap::LightLayer& layer) {
        for (const cubemap::TexelRectangle& touched : texels_of(layer))
            add_merged(touched, touched_);
    };
    const std::size_t num_places = std::max(now_.layers.size(), next_.layers.size());
    for (std::size_t i = 0; i < num_places; ++i) {
        const bool both = i < now_.layers.size() && i < next_.layers.size();
        if (both && now_.layers[i] == next_.layers[i])
            continue;
        if (const auto piece =
                both ? added_piece(now_.layers[i], next_.layers[i], now_.base->resolution)
                     : std::nullopt) {
            add(*piece);
            continue;
        }
        if (i < now_.layers.size())
            add(now_.layers[i]);
        const bool same_place =
            both && now_.layers[i].on && now_.layers[i].region == next_.layers[i].region;
        if (i < next_.layers.size() && !same_place)
            add(next_.layers[i]);
    }
    // Rectangles that could be joined without growing were joined. Where others overlap, each texel
    // still counts once.
    for (const cubemap::TexelRectangle& touched : touched_)
        append_uncovered(touched, 0, changed_);
}

/// Returns touched_texels(), until the next call.
std::span<const cubemap::TexelRectangle>
LayerCompositor::texels_of(const cubemap::LightLayer& layer) {
    constexpr std::size_t MostKnown = 8;
    if (!layer.on)
        return {};
    const auto known = std::find_if(known_.begin(), known_.end(), [&](const TouchedTexels& of) {
        return of.resolution == now_.base->resolution && of.region == layer.region;
    });
    if (known != known_.end())
        return known->rectangles;
    if (known_.size() == MostKnown)
        known_.erase(known_.begin());
    known_.push_back({.region = layer.region,
                      .resolution = now_.base->resolution,
                      .rectangles = cubemap::touched_texels(layer, now_.base->resolution)});
    return known_.back().rectangles;
}

void LayerCompositor::composite(cubemap::CubeMap& environment) const {
    cubemap::composite(*next_.base, next_.layers, changed_, environment);
    try {
        require_radiance_in(environment, changed_);
    } catch (const std::invalid_argument&) { // layers too bright together
        cubemap::composite(*now_.base, now_.layers, changed_, environment);
        throw;
    }
}

void LayerCompositor::accept() {
    std::swap(now_, next_);
    next_.base.reset();
}

std::shared_ptr<const cubemap::CubeMap> seen_environment(const LightState& state) {
    if (!state.base || !state.base->map() || !cubemap::hides_from_camera(state.layers))
        return nullptr;
    LightState seen = state;
    seen.layers = cubemap::seen_layers(state.layers);
    return std::make_shared<const cubemap::CubeMap>(LayerCompositor(seen).whole());
}

} // namespace relumine
