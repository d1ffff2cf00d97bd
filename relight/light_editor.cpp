#include "relight/light_editor.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cubemap/region_turn.h"

namespace relumine::relight {

namespace {

/// Receivers whose radiance one task copies: about 10 microseconds, ten times the cost of starting it.
constexpr std::size_t CopyGrain = 8192;

/// The tiles of 16 x 16 texels in which two maps of one resolution differ.
void append_changed_tiles(const cubemap::CubeMap& before, const cubemap::CubeMap& after,
                          std::vector<cubemap::TexelRectangle>& tiles) {
    constexpr std::uint32_t TileSize = 16;
    const std::uint32_t r = before.resolution;
    for (const cubemap::Face face : cubemap::AllFaces)
        for (std::uint32_t y = 0; y < r; y += TileSize)
            for (std::uint32_t x = 0; x < r; x += TileSize) {
                const cubemap::TexelRectangle tile{.face = face,
                                                   .x0 = x,
                                                   .y0 = y,
                                                   .x1 = std::min(x + TileSize, r),
                                                   .y1 = std::min(y + TileSize, r)};
                bool equal = true;
                for (std::uint32_t row = tile.y0; equal && row < tile.y1; ++row) {
                    const glm::vec3* of_before = &before.at(face, x, row);
                    equal = std::equal(of_before, of_before + (tile.x1 - tile.x0), &after.at(face, x, row));
                }
                if (!equal)
                    tiles.push_back(tile);
            }
}

/// The report of a relighting of everything.
UpdateReport report_of(const RelightTimes& times, const prt::Transfer& transfer) {
    return {.num_clusters = transfer.num_clusters(),
            .num_receivers = transfer.num_receivers(),
            .num_sharp_lights = times.num_sharp_lights,
            .seconds = times.seconds_bin + times.seconds_trace + times.seconds_relight};
}

} // namespace

LightEditor::LightEditor(const prt::Transfer& transfer, const ShadowRays& rays)
    : relighter_(transfer, rays), history_(1) {}

RelightTimes LightEditor::set_base(cubemap::CubeMap base) {
    auto next = std::make_shared<const cubemap::CubeMap>(std::move(base));
    if (next->resolution == 0)
        throw std::invalid_argument("expected a base with texels");
    const std::shared_ptr<const cubemap::CubeMap> before = std::exchange(base_, std::move(next));
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
    require_radiance(base.texels);
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
    cubemap::composite(turned_base(), turned_layers_, cubemap::all_texels(environment.resolution),
                       environment);
    const RelightTimes times = relighter_.set_environment(std::move(environment));
    publish();
    return times;
}

void LightEditor::turn_base() {
    turned_base_ =
        rotation_degrees_ == 0.0 || !base_ ? cubemap::CubeMap() : cubemap::rotated(*base_, rotation_degrees_);
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
    if (!base_) {
        std::swap(turned_layers_, next_layers_);
        return {};
    }
    // Layers at the same place in both lists that are equal change nothing; all others dirty what they cover, before and after. A layer that
    // moved within the list is compared with its new neighbour, and so dirtied.
    dirty_.clear();
    const auto add = [&](const cubemap::LightLayer& layer) {
        for (const cubemap::TexelRectangle& touched : cubemap::touched_texels(layer, base_->resolution))
            add_merged(touched, dirty_);
    };
    const std::size_t num_places = std::max(turned_layers_.size(), next_layers_.size());
    for (std::size_t i = 0; i < num_places; ++i) {
        const bool both = i < turned_layers_.size() && i < next_layers_.size();
        if (both && turned_layers_[i] == next_layers_[i])
            continue;
        if (i < turned_layers_.size())
            add(turned_layers_[i]);
        if (i < next_layers_.size())
            add(next_layers_[i]);
    }
    const UpdateReport report = update_dirty(turned_base(), next_layers_);
    std::swap(turned_layers_, next_layers_);
    return report;
}

UpdateReport LightEditor::update_dirty(const cubemap::CubeMap& base,
                                       std::span<const cubemap::LightLayer> layers) {
    if (dirty_.empty())
        return {};
    const UpdateReport report = relighter_.update_regions(dirty_, [&](cubemap::CubeMap& environment) {
        cubemap::composite(base, layers, dirty_, environment);
        try {
            for (const cubemap::TexelRectangle& rectangle : dirty_)
                for (std::uint32_t y = rectangle.y0; y < rectangle.y1; ++y)
                    require_radiance(
                        {&environment.at(rectangle.face, rectangle.x0, y), rectangle.x1 - rectangle.x0});
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
    // A mark is a state to come back to bit by bit, however one came there.
    if (base_) {
        relighter_.resum();
        publish();
    }
}

void LightEditor::forget_oldest() {
    const auto bytes_of = [](const cubemap::CubeMap& map) {
        return map.texels.size() * sizeof(map.texels.front());
    };
    // From the newest mark back: how many fit?
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
    if (base_) {
        relighter_.resum();
        publish();
    }
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
        return report_of(relight_all(), relighter_.transfer());
    }
    const UpdateReport report = apply(layers_);
    if (base_) {
        relighter_.resum();
        publish();
    }
    return report;
}

void LightEditor::publish() {
    const std::span<const glm::vec3> radiance = relighter_.radiance();
    back_.resize(radiance.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, radiance.size(), CopyGrain), [&](const auto& part) {
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
