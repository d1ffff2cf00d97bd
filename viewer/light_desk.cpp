#include "viewer/light_desk.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "cubemap/layers/layer_composite.h"

namespace relumine::viewer {

LightDesk::LightDesk(relight::LightEditor& editor, const std::filesystem::path& base_path)
    : editor_(editor) {
    editor_.forget_history();
    note_base_path(base_path);
    note_all_texels();
}

template<typename Edit>
void LightDesk::timed(Edit edit) {
    const auto start = std::chrono::steady_clock::now();
    last_cost_.report = edit();
    last_cost_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::span<const cubemap::TexelRectangle> changed = editor_.changed_texels();
    changed_texels_.insert(changed_texels_.end(), changed.begin(), changed.end());
    ++version_;
    if (selected_ && *selected_ >= layers().size())
        selected_.reset();
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

std::optional<std::size_t> LightDesk::find(const std::string& name) const {
    const auto found = std::find_if(layers().begin(), layers().end(),
                                    [&](const auto& layer) { return layer.name == name; });
    return found == layers().end()
               ? std::nullopt
               : std::optional<std::size_t>(static_cast<std::size_t>(found - layers().begin()));
}

std::string LightDesk::unused_name(const std::string& name) const {
    std::string result = name;
    for (int number = 2; find(result); ++number)
        result = fmt::format("{} {}", name, number);
    return result;
}

std::size_t LightDesk::add(cubemap::LightLayer layer) {
    layer.name = unused_name(layer.name);
    std::vector<cubemap::LightLayer> changed = copy();
    changed.push_back(std::move(layer));
    const std::size_t index = changed.size() - 1;
    replace(std::move(changed));
    selected_ = index;
    return index;
}

void LightDesk::remove(std::size_t index) {
    std::vector<cubemap::LightLayer> changed = copy();
    changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(index));
    replace(std::move(changed));
    selected_.reset();
}

void LightDesk::reorder(std::size_t from, std::size_t to) {
    std::vector<cubemap::LightLayer> changed = copy();
    cubemap::LightLayer layer = std::move(changed.at(from));
    changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(from));
    changed.insert(changed.begin() + static_cast<std::ptrdiff_t>(std::min(to, changed.size())),
                   std::move(layer));
    replace(std::move(changed));
    selected_ = std::min(to, layers().size() - 1);
}

void LightDesk::replace(std::vector<cubemap::LightLayer> changed) {
    timed([&] { return editor_.set_layers(std::move(changed)); });
    editor_.mark();
}

void LightDesk::undo() {
    timed([&] { return editor_.undo(); });
}

void LightDesk::redo() {
    timed([&] { return editor_.redo(); });
}

void LightDesk::change(std::size_t index, const cubemap::LightLayer& layer) {
    timed([&] { return editor_.set_layer(index, layer); });
}

void LightDesk::finish() {
    editor_.mark();
    ++version_;
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

LightDesk::Held LightDesk::held_at(const glm::dvec3& direction, double tolerance_degrees) const {
    const glm::dvec3 before_turn = turned(direction, -editor_.rotation());
    if (selected_)
        if (const Grip grip = grip_at(layers()[*selected_].region, before_turn, tolerance_degrees);
            grip != Grip::None)
            return {.index = *selected_, .grip = grip};
    for (std::size_t i = layers().size(); i-- > 0;) {
        if (!layers()[i].on)
            continue;
        if (const Grip grip = grip_at(layers()[i].region, before_turn, tolerance_degrees);
            grip != Grip::None)
            return {.index = i, .grip = grip};
    }
    return {};
}

void LightDesk::begin_drag(const Held& held, const glm::dvec3& direction) {
    if (held.grip == Grip::None)
        return;
    selected_ = held.index;
    drag_ = Drag{.index = held.index,
                 .grip = held.grip,
                 .region = layers()[held.index].region,
                 .from = turned(direction, -editor_.rotation())};
}

void LightDesk::drag_to(const glm::dvec3& direction) {
    if (!drag_)
        return;
    const glm::dvec3 to = turned(direction, -editor_.rotation());
    cubemap::LightLayer layer = layers()[drag_->index];
    layer.region = drag_->grip == Grip::Body ? moved(drag_->region, drag_->from, to)
                                             : resized(drag_->region, drag_->from, to);
    change(drag_->index, layer);
    drag_seconds_.push_back(last_cost_.seconds);
}

void LightDesk::end_drag() {
    if (!drag_)
        return;
    drag_.reset();
    finish();
}

void LightDesk::begin_stroke(const cubemap::LightLayer& brush, const glm::dvec3& direction) {
    cubemap::LightLayer layer = brush;
    layer.name = unused_name(layer.name);
    std::get<cubemap::Stroke>(layer.region).points = {turned(direction, -editor_.rotation())};
    std::vector<cubemap::LightLayer> changed = copy();
    changed.push_back(layer);
    timed([&] { return editor_.set_layers(std::move(changed)); });
    drag_seconds_.push_back(last_cost_.seconds);
    selected_ = layers().size() - 1;
    painting_ = true;
}

void LightDesk::stroke_to(const glm::dvec3& direction) {
    if (!painting_)
        return;
    cubemap::LightLayer layer = layers().back();
    auto& stroke = std::get<cubemap::Stroke>(layer.region);
    const glm::dvec3 to = turned(direction, -editor_.rotation());
    if (angle_between(stroke.points.back(), to) < 0.25 * stroke.radius_degrees)
        return;
    stroke.points.push_back(to);
    change(layers().size() - 1, layer);
    drag_seconds_.push_back(last_cost_.seconds);
}

void LightDesk::end_stroke() {
    if (!std::exchange(painting_, false))
        return;
    finish();
}

void LightDesk::begin_lasso(const glm::dvec3& direction) {
    lasso_ = {direction};
}

void LightDesk::lasso_to(const glm::dvec3& direction, double spacing_degrees) {
    if (!lasso_.empty() && angle_between(lasso_.back(), direction) >= spacing_degrees)
        lasso_.push_back(direction);
}

bool LightDesk::end_lasso(cubemap::LightLayer layer) {
    std::vector<glm::dvec3> points = std::exchange(lasso_, {});
    if (points.size() < 3)
        return false;
    for (glm::dvec3& point : points)
        point = turned(point, -editor_.rotation());
    std::get<cubemap::Lasso>(layer.region).points = std::move(points);
    add(std::move(layer));
    return true;
}

void LightDesk::set_rotation(double degrees) {
    timed([&] { return whole(editor_.set_rotation(degrees)); });
}

void LightDesk::set_base(cubemap::CubeMap base, const std::filesystem::path& path) {
    timed([&] { return whole(editor_.set_base(std::move(base))); });
    note_base_path(path);
}

relight::UpdateReport LightDesk::whole(const relight::RelightTimes& times) const {
    return {.num_clusters = editor_.relighter().transfer().num_clusters(),
            .num_receivers = editor_.radiance().size(),
            .num_sharp_lights = times.num_sharp_lights};
}

void LightDesk::note_base_path(const std::filesystem::path& path) {
    std::erase_if(base_paths_, [](const auto& entry) { return entry.first.expired(); });
    if (editor_.base())
        base_paths_.emplace_back(editor_.base(), path);
}

std::filesystem::path LightDesk::base_path() const {
    for (const auto& [base, path] : base_paths_)
        if (base.lock() == editor_.base())
            return path;
    return {};
}

} // namespace relumine::viewer
