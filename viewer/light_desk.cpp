#include "viewer/light_desk.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "files/seconds.h"
#include "relumine/light/layers.h"

namespace relumine::viewer {

LightDesk::LightDesk(LitScene& lit) : lit_(lit) {
    forget_history(lit_);
    note_all_texels();
}

template<typename Edit>
void LightDesk::timed(Edit edit) {
    const auto start = std::chrono::steady_clock::now();
    last_cost_.report = edit();
    last_cost_.seconds = files::seconds_since(start);
    const auto changed = std::exchange(last_cost_.report.texels, {});
    changed_texels_.insert(changed_texels_.end(), changed.begin(), changed.end());
    ++version_;
    if (selected_ && *selected_ >= layers().size())
        selected_.reset();
}

void LightDesk::note_all_texels() {
    changed_texels_ = cubemap::all_texels(environment_of(lit_).resolution);
}

std::vector<cubemap::TexelRectangle> LightDesk::take_changed_texels() {
    // After many edits between two frames the whole map is less work than all rectangles.
    constexpr std::size_t ManyRectangles = 200;
    if (changed_texels_.size() > ManyRectangles)
        note_all_texels();
    return std::exchange(changed_texels_, {});
}

void LightDesk::edit(LightState next, Ending ending) {
    timed([&] { return lit_.environment().edit(std::move(next), ending); });
}

void LightDesk::finish() {
    const std::uint32_t shown = environment_of(lit_).resolution;
    mark(lit_);
    // A map that turned while a slider moved has all its texels again.
    if (environment_of(lit_).resolution != shown)
        note_all_texels();
    ++version_;
}

template<typename Move>
void LightDesk::moving(Move move) {
    stop_();
    ++mesh_version_;
    timed([&] {
        move();
        return UpdateReport{.num_receivers = lit_.radiance().size()};
    });
}

void LightDesk::move(const GroupMove& to) {
    moving([&] { lit_.moves().move(to); });
    moved_in_.push_back(state());
    undone_in_.clear();
}

void LightDesk::drag(const GroupMove& to) {
    moving([&] { lit_.moves().drag(to); });
}

void LightDesk::drop() {
    moving([&] { lit_.moves().drop(); });
    moved_in_.push_back(state());
    undone_in_.clear();
}

/// Returns false where the light was changed since the last move.
bool LightDesk::exchange_move(bool is_undo) {
    if (lit_.moves().is_dragging()) {
        moving([&] { lit_.moves().undo(); });
        return true;
    }
    std::vector<LightState>& from = is_undo ? moved_in_ : undone_in_;
    if (from.empty() || from.back() != state())
        return false;
    (is_undo ? undone_in_ : moved_in_).push_back(state());
    from.pop_back();
    bool is_done = false;
    moving([&] { is_done = is_undo ? lit_.moves().undo() : lit_.moves().redo(); });
    return is_done;
}

void LightDesk::undo() {
    if (exchange_move(true))
        return;
    timed([&] { return relumine::undo(lit_); });
}

void LightDesk::redo() {
    if (exchange_move(false))
        return;
    timed([&] { return relumine::redo(lit_); });
}

void LightDesk::dim(std::vector<EmissionGain> gains) {
    timed([&] {
        lit_.dim(std::move(gains));
        return UpdateReport{.num_receivers = lit_.radiance().size()};
    });
}

void LightDesk::set_roughness(float roughness) {
    lit_.set_roughness(roughness);
    ++version_;
}

void LightDesk::bounce(bool all) {
    if (lit_.bounces().is_settled())
        return;
    lit_.bounce({.is_step = !all});
    ++version_;
}

glm::vec3 dimmer(const LightDesk& desk, const std::string& name) {
    glm::vec3 result(1.0f);
    for (const EmissionGain& gain : desk.lit().lamps().gains())
        if (gain.name == name)
            result *= gain.gain;
    return result;
}

void set_dimmer(LightDesk& desk, const std::string& name, const glm::vec3& gain) {
    std::vector<EmissionGain> gains = desk.lit().lamps().gains();
    std::erase_if(gains, [&](const EmissionGain& one) {
        return one.name == name && one.profile_file.empty();
    });
    gains.push_back({.name = name, .gain = gain});
    desk.dim(std::move(gains));
}

std::optional<std::size_t> find(const LightDesk& desk, const std::string& name) {
    const auto layers = desk.layers();
    const auto found = std::find_if(layers.begin(), layers.end(),
                                    [&](const auto& layer) { return layer.name == name; });
    return found == layers.end()
               ? std::nullopt
               : std::optional<std::size_t>(static_cast<std::size_t>(found - layers.begin()));
}

void change(LightDesk& desk, std::size_t index, const cubemap::LightLayer& layer) {
    LightState next = desk.state();
    next.layers.at(index) = layer;
    desk.edit(std::move(next));
}

void move_middle(LightDesk& desk, std::size_t index, const glm::dvec3& direction) {
    cubemap::LightLayer layer = desk.layers()[index];
    layer.region = cubemap::centred(std::move(layer.region),
                                    cubemap::turned(direction, -desk.state().rotation_degrees));
    change(desk, index, layer);
}

void set_rotation(LightDesk& desk, double degrees) {
    LightState next = desk.state();
    next.rotation_degrees = degrees;
    desk.edit(std::move(next), Ending::Moving);
}

void set_base(LightDesk& desk, Environment environment) {
    LightState next = desk.state();
    next.base = base_of(std::move(environment));
    desk.edit(std::move(next));
}

std::size_t put_on_top(LightDesk& desk, cubemap::LightLayer layer) {
    const std::string name = layer.name;
    for (int number = 2; find(desk, layer.name); ++number)
        layer.name = fmt::format("{} {}", name, number);
    LightState next = desk.state();
    next.layers.push_back(std::move(layer));
    desk.edit(std::move(next));
    desk.select(desk.layers().size() - 1);
    return *desk.selected();
}

std::size_t add(LightDesk& desk, cubemap::LightLayer layer) {
    const std::size_t index = put_on_top(desk, std::move(layer));
    desk.finish();
    return index;
}

void set_solo(LightDesk& desk, std::size_t index, bool solo) {
    cubemap::LightLayer layer = desk.layers()[index];
    layer.solo = solo;
    change(desk, index, layer);
    desk.finish();
}

void replace(LightDesk& desk, std::vector<cubemap::LightLayer> layers) {
    LightState next = desk.state();
    next.layers = std::move(layers);
    desk.edit(std::move(next));
    desk.finish();
}

void remove(LightDesk& desk, std::size_t index) {
    std::vector<cubemap::LightLayer> layers = desk.state().layers;
    layers.erase(layers.begin() + static_cast<std::ptrdiff_t>(index));
    replace(desk, std::move(layers));
    desk.select(std::nullopt);
}

void reorder(LightDesk& desk, std::size_t from, std::size_t to) {
    std::vector<cubemap::LightLayer> layers = desk.state().layers;
    cubemap::LightLayer layer = std::move(layers.at(from));
    layers.erase(layers.begin() + static_cast<std::ptrdiff_t>(from));
    to = std::min(to, layers.size());
    layers.insert(layers.begin() + static_cast<std::ptrdiff_t>(to), std::move(layer));
    replace(desk, std::move(layers));
    desk.select(to);
}

} // namespace relumine::viewer
