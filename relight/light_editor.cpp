#include "relight/light_editor.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

#include "cubemap/layers/shapes/sphere_lines.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

/// Receivers whose radiance one task copies: about 10 microseconds, ten times the cost of starting
/// a task.
constexpr std::size_t CopyGrain = 8192;

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
            require_radiance(
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
    if (!from || !to || a.on != b.on || a.gain_ev != b.gain_ev || a.effect != b.effect ||
        from->radius_degrees != to->radius_degrees || from->softness != to->softness)
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

/// Returns the report of relighting everything.
UpdateReport report_of(const RelightTimes& times, const prt::Transfer& transfer) {
    return {.num_clusters = transfer.num_clusters(),
            .num_receivers = transfer.num_receivers(),
            .num_sharp_lights = times.num_sharp_lights,
            .seconds = times.seconds_bin + times.seconds_trace + times.seconds_relight};
}

} // namespace

LightEditor::LightEditor(const prt::Transfer& transfer, const ShadowRays& rays)
    : relighter_(transfer, rays), history_(1) {}

RelightTimes LightEditor::set_base(std::shared_ptr<const cubemap::CubeMap> base) {
    if (!base || base->resolution == 0)
        throw std::invalid_argument("expected a base with texels");
    const std::shared_ptr<const cubemap::CubeMap> before = std::exchange(base_, std::move(base));
    try {
        const RelightTimes times = relight_all();
        if (!before)
            for (State& state : history_)
                state.base = base_;
        return times;
    } catch (const std::invalid_argument&) { // too bright, alone or under its layers
        base_ = before;
        turn_base();
        throw;
    }
}

UpdateReport LightEditor::update_base(cubemap::CubeMap base) {
    if (!base_ || base.resolution != base_->resolution || rotation_degrees_ != 0.0)
        return report_of(set_base(std::move(base)), relighter_.transfer());
    dirty_.clear();
    append_changed_tiles(*base_, base, dirty_);
    require_radiance_in(base, dirty_); // the rest was checked before
    const UpdateReport report = update_dirty(base, turned_layers_);
    base_ = std::make_shared<const cubemap::CubeMap>(std::move(base));
    return report;
}

RelightTimes LightEditor::set_rotation(double degrees_about_y) {
    if (!std::isfinite(degrees_about_y))
        throw std::invalid_argument("expected a finite rotation");
    rotation_degrees_ = degrees_about_y;
    return relight_all();
}

RelightTimes LightEditor::relight_all() {
    if (!base_)
        return {};
    turn_base();
    turn(layers_, turned_layers_);
    cubemap::CubeMap environment = turned_base();
    cubemap::composite(environment, turned_layers_, cubemap::all_texels(environment.resolution),
                       environment);
    const RelightTimes times = relighter_.set_environment(std::move(environment));
    dirty_ = cubemap::all_texels(relighter_.environment().resolution);
    publish();
    return times;
}

void LightEditor::turn_base() {
    turned_base_ = rotation_degrees_ == 0.0 || !base_ ? cubemap::CubeMap()
                                                      : cubemap::rotated(*base_, rotation_degrees_);
}

void LightEditor::turn(std::span<const cubemap::LightLayer> layers,
                       std::vector<cubemap::LightLayer>& turned) const {
    turned.assign(layers.begin(), layers.end());
    if (rotation_degrees_ != 0.0)
        for (cubemap::LightLayer& layer : turned)
            layer.region = cubemap::turned(layer.region, rotation_degrees_);
}

UpdateReport LightEditor::set_layers(std::vector<cubemap::LightLayer> layers) {
    for (const cubemap::LightLayer& layer : layers)
        cubemap::validate(layer);
    const UpdateReport report = apply(layers);
    layers_ = std::move(layers);
    return report;
}

UpdateReport LightEditor::set_layer(std::size_t index, const cubemap::LightLayer& layer) {
    cubemap::LightLayer& target = layers_.at(index);
    cubemap::validate(layer);
    next_layer_ = layer;
    std::swap(target, next_layer_);
    try {
        return apply(layers_);
    } catch (...) {
        std::swap(target, next_layer_);
        throw;
    }
}

UpdateReport LightEditor::apply(std::span<const cubemap::LightLayer> layers) {
    turn(layers, next_layers_);
    dirty_.clear();
    touched_.clear();
    if (!base_) {
        std::swap(turned_layers_, next_layers_);
        return {};
    }
    // Equal layers at the same place in both lists change nothing. Every other layer dirties the
    // texels that it covers, before and after. A layer that moved within the list is compared with
    // its new neighbour, and so dirtied.
    const auto add = [&](const cubemap::LightLayer& layer) {
        for (const cubemap::TexelRectangle& touched : texels_of(layer))
            add_merged(touched, touched_);
    };
    const std::size_t num_places = std::max(turned_layers_.size(), next_layers_.size());
    for (std::size_t i = 0; i < num_places; ++i) {
        const bool both = i < turned_layers_.size() && i < next_layers_.size();
        if (both && turned_layers_[i] == next_layers_[i])
            continue;
        if (const auto piece =
                both ? added_piece(turned_layers_[i], next_layers_[i], base_->resolution)
                     : std::nullopt) {
            add(*piece);
            continue;
        }
        if (i < turned_layers_.size())
            add(turned_layers_[i]);
        const bool same_place =
            both && turned_layers_[i].on && turned_layers_[i].region == next_layers_[i].region;
        if (i < next_layers_.size() && !same_place)
            add(next_layers_[i]);
    }
    // Rectangles that could be joined without growing were joined. Where others overlap, each texel
    // still counts once.
    for (const cubemap::TexelRectangle& touched : touched_)
        append_uncovered(touched, 0, dirty_);
    const UpdateReport report = update_dirty(turned_base(), next_layers_);
    std::swap(turned_layers_, next_layers_);
    return report;
}

/// Returns touched_texels(), until the next call.
std::span<const cubemap::TexelRectangle> LightEditor::texels_of(const cubemap::LightLayer& layer) {
    constexpr std::size_t MostKnown = 8;
    if (!layer.on)
        return {};
    const auto known = std::find_if(known_.begin(), known_.end(), [&](const TouchedTexels& of) {
        return of.resolution == base_->resolution && of.region == layer.region;
    });
    if (known != known_.end())
        return known->rectangles;
    if (known_.size() == MostKnown)
        known_.erase(known_.begin());
    known_.push_back({.region = layer.region,
                      .resolution = base_->resolution,
                      .rectangles = cubemap::touched_texels(layer, base_->resolution)});
    return known_.back().rectangles;
}

UpdateReport LightEditor::update_dirty(const cubemap::CubeMap& base,
                                       std::span<const cubemap::LightLayer> layers) {
    if (dirty_.empty())
        return {};
    const UpdateReport report =
        relighter_.update_regions(dirty_, [&](cubemap::CubeMap& environment) {
            cubemap::composite(base, layers, dirty_, environment);
            try {
                require_radiance_in(environment, dirty_);
            } catch (const std::invalid_argument&) { // layers too bright together
                cubemap::composite(turned_base(), turned_layers_, dirty_, environment);
                throw;
            }
        });
    publish();
    return report;
}

void LightEditor::mark() {
    State present{.layers = layers_, .rotation_degrees = rotation_degrees_, .base = base_};
    history_.resize(at_ + 1);
    if (present != history_[at_]) {
        history_.push_back(std::move(present));
        ++at_;
        forget_oldest();
    }
    renew();
}

/// Makes the radiance the same bit by bit, whichever edits led to it.
void LightEditor::renew() {
    if (!base_)
        return;
    relighter_.resum();
    if (relighter_.bounces().matrix != nullptr)
        relighter_.bounce();
    publish();
}

void LightEditor::set_bounces(SurfaceBounces bounces) {
    relighter_.set_bounces(std::move(bounces));
    if (base_)
        publish();
}

BounceReport LightEditor::settle(std::span<const glm::vec3> more) {
    if (!base_ || relighter_.bounces().matrix == nullptr)
        return {};
    const BounceReport report = relighter_.bounce(more);
    publish();
    return report;
}

BounceReport LightEditor::step() {
    if (!base_ || is_settled())
        return {};
    const BounceReport report = relighter_.step();
    publish();
    return report;
}

void LightEditor::forget_oldest() {
    const auto bytes_of = [](const cubemap::CubeMap& map) {
        return map.texels.size() * sizeof(map.texels.front());
    };
    // Count from the newest mark back: how many fit?
    std::set<const cubemap::CubeMap*> bases = {base_.get()};
    std::size_t bytes = 0;
    std::size_t first = history_.size();
    while (first > 0) {
        const cubemap::CubeMap* base = history_[first - 1].base.get();
        if (base && bases.insert(base).second)
            bytes += bytes_of(*base);
        if (bytes > max_history_bytes_ && first + 2 <= history_.size())
            break;
        --first;
    }
    history_.erase(history_.begin(), history_.begin() + static_cast<std::ptrdiff_t>(first));
    at_ -= first;
}

void LightEditor::forget_history() {
    history_.assign(1, {.layers = layers_, .rotation_degrees = rotation_degrees_, .base = base_});
    at_ = 0;
    renew();
}

UpdateReport LightEditor::undo() {
    return can_undo() ? go_to(at_ - 1) : UpdateReport{};
}

UpdateReport LightEditor::redo() {
    return can_redo() ? go_to(at_ + 1) : UpdateReport{};
}

UpdateReport LightEditor::go_to(std::size_t mark) {
    at_ = mark;
    const State& state = history_[at_];
    layers_ = state.layers;
    if (state.base != base_ || state.rotation_degrees != rotation_degrees_) {
        base_ = state.base;
        rotation_degrees_ = state.rotation_degrees;
        const UpdateReport report = report_of(relight_all(), relighter_.transfer());
        settle();
        return report;
    }
    const UpdateReport report = apply(layers_);
    renew();
    return report;
}

void LightEditor::publish() {
    const std::span<const glm::vec3> radiance = relighter_.radiance();
    back_.resize(radiance.size());
    files::parallel_for(files::IndexRange<std::size_t>(0, radiance.size(), CopyGrain),
                        [&](const auto& part) {
                            std::copy(radiance.begin() + static_cast<std::ptrdiff_t>(part.begin()),
                                      radiance.begin() + static_cast<std::ptrdiff_t>(part.end()),
                                      back_.begin() + static_cast<std::ptrdiff_t>(part.begin()));
                        });
    const std::unique_lock lock(published_mutex_);
    std::swap(published_, back_);
}

void LightEditor::snapshot(std::vector<glm::vec3>& radiance) const {
    const std::shared_lock lock(published_mutex_);
    radiance.assign(published_.begin(), published_.end());
}

} // namespace relumine::relight
