#include "viewer/light_desk.h"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "cubemap/layers/layer_composite.h"

namespace relumine::viewer {

namespace {

/// A direction as seen, before the rotation.
glm::dvec3 unturned(const LightDesk& desk, const glm::dvec3& direction) {
    return turned(direction, -desk.editor().rotation());
}

std::string unused_name(const LightDesk& desk, const std::string& name) {
    std::string result = name;
    for (int number = 2; find_layer(desk, result); ++number)
        result = fmt::format("{} {}", name, number);
    return result;
}

std::vector<cubemap::LightLayer> copy_of(std::span<const cubemap::LightLayer> layers) {
    return {layers.begin(), layers.end()};
}

/// Replaces all layers; not yet a step of undo.
void set_layers(LightDesk& desk, std::vector<cubemap::LightLayer> layers) {
    desk.edit([&](relight::LightEditor& editor) { return editor.set_layers(std::move(layers)); });
}

/// Puts a layer on top and selects it; not yet a step of undo.
void put_on_top(LightDesk& desk, cubemap::LightLayer layer) {
    layer.name = unused_name(desk, layer.name);
    std::vector<cubemap::LightLayer> changed = copy_of(desk.layers());
    changed.push_back(std::move(layer));
    set_layers(desk, std::move(changed));
    desk.select(desk.layers().size() - 1);
}

} // namespace

LightDesk::LightDesk(relight::LightEditor& editor) : editor_(editor) {
    editor_.forget_history();
    note_all_texels();
}

void LightDesk::note_edit(const relight::UpdateReport& report,
                          std::chrono::steady_clock::time_point start) {
    last_cost_.report = report;
    last_cost_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::span<const cubemap::TexelRectangle> changed = editor_.changed_texels();
    changed_texels_.insert(changed_texels_.end(), changed.begin(), changed.end());
    ++version_;
    if (selected_ && *selected_ >= layers().size())
        selected_.reset();
}

relight::UpdateReport LightDesk::report_of(const relight::RelightTimes& times) const {
    return {.num_clusters = editor_.relighter().transfer().num_clusters(),
            .num_receivers = editor_.radiance().size(),
            .num_sharp_lights = times.num_sharp_lights};
}

void LightDesk::note_all_texels() {
    changed_texels_ = cubemap::all_texels(std::max(editor_.environment().resolution, 1u));
}

std::vector<cubemap::TexelRectangle> LightDesk::take_changed_texels() {
    // After many edits between two frames the whole map is less work than all rectangles.
    constexpr std::size_t ManyRectangles = 200;
    if (changed_texels_.size() > ManyRectangles)
        note_all_texels();
    return std::exchange(changed_texels_, {});
}

void LightDesk::finish() {
    editor_.mark();
    ++version_;
}

void LightDesk::undo() {
    edit([](relight::LightEditor& editor) { return editor.undo(); });
}

void LightDesk::redo() {
    edit([](relight::LightEditor& editor) { return editor.redo(); });
}

void LightDesk::go_on() {
    if (editor_.is_settled())
        return;
    editor_.step();
    ++version_;
}

void LightDesk::settle() {
    if (editor_.is_settled())
        return;
    editor_.settle();
    ++version_;
}

std::optional<std::size_t> find_layer(const LightDesk& desk, const std::string& name) {
    for (std::size_t i = 0; i < desk.layers().size(); ++i)
        if (desk.layers()[i].name == name)
            return i;
    return std::nullopt;
}

std::size_t add_layer(LightDesk& desk, cubemap::LightLayer layer) {
    put_on_top(desk, std::move(layer));
    desk.finish();
    return *desk.selected();
}

void remove_layer(LightDesk& desk, std::size_t index) {
    std::vector<cubemap::LightLayer> changed = copy_of(desk.layers());
    changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(index));
    replace_layers(desk, std::move(changed));
    desk.select(std::nullopt);
}

void reorder_layers(LightDesk& desk, std::size_t from, std::size_t to) {
    std::vector<cubemap::LightLayer> changed = copy_of(desk.layers());
    cubemap::LightLayer layer = std::move(changed.at(from));
    changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(from));
    to = std::min(to, changed.size());
    changed.insert(changed.begin() + static_cast<std::ptrdiff_t>(to), std::move(layer));
    replace_layers(desk, std::move(changed));
    desk.select(to);
}

void replace_layers(LightDesk& desk, std::vector<cubemap::LightLayer> layers) {
    set_layers(desk, std::move(layers));
    desk.finish();
}

void set_rotation(LightDesk& desk, double degrees) {
    desk.edit([&](relight::LightEditor& editor) { return editor.set_rotation(degrees); });
}

Held held_at(const LightDesk& desk, const glm::dvec3& direction, double tolerance_degrees) {
    const glm::dvec3 before_turn = unturned(desk, direction);
    const auto held = [&](std::size_t i) {
        return Held{i, grip_at(desk.layers()[i].region, before_turn, tolerance_degrees)};
    };
    if (desk.selected())
        if (const Held found = held(*desk.selected()); found.grip != Grip::None)
            return found;
    for (std::size_t i = desk.layers().size(); i-- > 0;)
        if (desk.layers()[i].on)
            if (const Held found = held(i); found.grip != Grip::None)
                return found;
    return {};
}

void Gesture::begin_drag(LightDesk& desk, const Held& held, const glm::dvec3& direction) {
    if (held.grip == Grip::None)
        return;
    desk.select(held.index);
    drag_ = Drag{.index = held.index,
                 .grip = held.grip,
                 .region = desk.layers()[held.index].region,
                 .from = unturned(desk, direction)};
}

void Gesture::begin_stroke(LightDesk& desk, const cubemap::LightLayer& brush,
                           const glm::dvec3& direction) {
    cubemap::LightLayer layer = brush;
    std::get<cubemap::Stroke>(layer.region).points = {unturned(desk, direction)};
    put_on_top(desk, std::move(layer));
    seconds_.push_back(desk.last_cost().seconds);
    painting_ = true;
}

void Gesture::move_to(LightDesk& desk, const glm::dvec3& direction, double spacing_degrees) {
    if (!lasso_.empty()) {
        if (angle_between(lasso_.back(), direction) >= spacing_degrees)
            lasso_.push_back(direction);
        return;
    }
    if (!changes_light())
        return;
    const glm::dvec3 to = unturned(desk, direction);
    const std::size_t index = drag_ ? drag_->index : desk.layers().size() - 1;
    cubemap::LightLayer layer = desk.layers()[index];
    if (drag_) {
        layer.region = drag_->grip == Grip::Body ? moved(drag_->region, drag_->from, to)
                                                 : resized(drag_->region, drag_->from, to);
    } else {
        auto& stroke = std::get<cubemap::Stroke>(layer.region);
        if (angle_between(stroke.points.back(), to) < 0.25 * stroke.radius_degrees)
            return;
        stroke.points.push_back(to);
    }
    desk.change(index, layer);
    seconds_.push_back(desk.last_cost().seconds);
}

void Gesture::end(LightDesk& desk) {
    if (!changes_light())
        return;
    drag_.reset();
    painting_ = false;
    desk.finish();
}

bool Gesture::end_lasso(LightDesk& desk, cubemap::LightLayer layer) {
    std::vector<glm::dvec3> points = std::exchange(lasso_, {});
    if (points.size() < 3)
        return false;
    for (glm::dvec3& point : points)
        point = unturned(desk, point);
    std::get<cubemap::Lasso>(layer.region).points = std::move(points);
    add_layer(desk, std::move(layer));
    return true;
}

} // namespace relumine::viewer
