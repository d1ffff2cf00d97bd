#include "viewer/script_player.h"
#include "cubemap/resample/save_environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::viewer {

namespace {

[[noreturn]] void fail(const ScriptCommand& command, const std::string& reason) {
    throw std::runtime_error(fmt::format("script line {}: {}", command.line, reason));
}

glm::dvec3 vector_of(const ScriptCommand& command) {
    return glm::normalize(glm::dvec3(command.numbers[0], command.numbers[1], command.numbers[2]));
}

std::size_t layer_of(const ScriptCommand& command, const ViewState& state) {
    const std::optional<std::size_t> index = state.desk.find(command.text);
    if (!index)
        fail(command, fmt::format("expected the name of a layer, got '{}'", command.text));
    return *index;
}

/// The pointer arrives, presses, moves, and lets go.
Pointer dragged(const std::vector<double>& numbers, std::size_t frame, std::size_t num_frames) {
    const double t =
        frame < 2 ? 0.0 : static_cast<double>(frame - 1) / static_cast<double>(num_frames - 3);
    const glm::dvec2 from(numbers[0], numbers[1]);
    const glm::dvec2 to(numbers[2], numbers[3]);
    return {.pixel = glm::vec2(from + (to - from) * std::min(t, 1.0)),
            .down = frame > 0 && frame + 1 < num_frames};
}

/// As dragged(), around the ellipse that fills a rectangle.
Pointer lassoed(const std::vector<double>& numbers, std::size_t frame, std::size_t num_frames) {
    Pointer pointer = dragged({0.0, 0.0, 1.0, 0.0}, frame, num_frames);
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(pointer.pixel.x);
    const glm::dvec2 from(numbers[0], numbers[1]);
    const glm::dvec2 to(numbers[2], numbers[3]);
    pointer.pixel = glm::vec2(0.5 * (from + to) +
                              0.5 * (to - from) * glm::dvec2(std::cos(angle), std::sin(angle)));
    return pointer;
}

void resize_region(cubemap::Region& region, double degrees) {
    if (auto* disc = std::get_if<cubemap::Disc>(&region)) {
        disc->radius_degrees = degrees;
    } else if (auto* stroke = std::get_if<cubemap::Stroke>(&region)) {
        stroke->radius_degrees = degrees;
    } else if (auto* box = std::get_if<cubemap::Rectangle>(&region)) {
        box->height_degrees *= degrees / box->width_degrees;
        box->width_degrees = degrees;
    }
}

double size_of(const cubemap::Region& region) {
    if (const auto* disc = std::get_if<cubemap::Disc>(&region))
        return disc->radius_degrees;
    if (const auto* stroke = std::get_if<cubemap::Stroke>(&region))
        return stroke->radius_degrees;
    if (const auto* box = std::get_if<cubemap::Rectangle>(&region))
        return box->width_degrees;
    return 0.0;
}

cubemap::LightLayer new_layer(const ScriptCommand& command) {
    const std::vector<double>& n = command.numbers;
    if (command.action == Action::AddRectangle)
        return {.name = command.text,
                .region = cubemap::Rectangle{.direction = vector_of(command),
                                             .width_degrees = n[3],
                                             .height_degrees = n[4]}};
    const cubemap::Disc disc{.direction = vector_of(command), .radius_degrees = n[3]};
    if (command.action == Action::AddGain)
        return {.name = command.text,
                .region = disc,
                .effect = cubemap::Gain{.factor = static_cast<float>(n[4])}};
    return {.name = command.text, .region = disc};
}

void set_gain(const ScriptCommand& command, ViewState& state) {
    const std::size_t index = layer_of(command, state);
    cubemap::LightLayer layer = state.desk.layers()[index];
    layer.gain_ev = command.numbers[0];
    state.desk.change(index, layer);
    state.desk.finish();
}

/// Returns the pointer in a frame of a command, and sets the tool that it uses.
Pointer moved_pointer(const ScriptCommand& command, std::size_t frame, std::size_t num_frames,
                      Tool& tool) {
    const std::vector<double>& n = command.numbers;
    switch (command.action) {
    case Action::Click:
        return {.pixel = glm::vec2(n[0], n[1]), .down = frame == 1};
    case Action::LassoEnvironment:
        // The panel goes back to the move tool when the outline is closed.
        if (frame == 0)
            tool = Tool::Lasso;
        return lassoed(n, frame, num_frames);
    case Action::PaintEnvironment:
        tool = frame + 1 == num_frames ? Tool::Move : Tool::Paint;
        return dragged(n, frame, num_frames);
    default:
        tool = Tool::Move;
        return dragged(n, frame, num_frames);
    }
}

void set_look(Action action, double value, ViewState& state) {
    if (action == Action::SceneExposure)
        state.scene_look.exposure_ev = static_cast<float>(value);
    else if (action == Action::EnvironmentExposure)
        state.environment_look.exposure_ev = static_cast<float>(value);
    else if (action == Action::Wireframe)
        state.scene_look.wireframe = value != 0.0;
    else
        state.environment_look.quadtree = value != 0.0;
}

/// Opens or saves a file. Returns false for a failure; the state's message tells the reason.
bool use_file(Action action, const std::string& path, ViewState& state) {
    switch (action) {
    case Action::Open:
        return open(state, path);
    case Action::AddImage:
        return add_image(state, path);
    case Action::Drop:
        return drop(state, path);
    case Action::SaveLayers:
        return save_layers(state, path);
    default:
        return save_environment(state, path);
    }
}

} // namespace

ScriptPlayer::Frame ScriptPlayer::step(ViewState& state) {
    Frame frame;
    if (is_done())
        return frame;
    const ScriptCommand& command = commands_[next_];
    const std::size_t count = num_frames(command);
    try {
        apply(command, state, count, frame);
    } catch (const std::invalid_argument& error) { // values that no layer can have
        fail(command, error.what());
    }
    if (++frame_ >= count) {
        frame_ = 0;
        ++next_;
    }
    return frame;
}

void ScriptPlayer::drag_layer(const ScriptCommand& command, ViewState& state, std::size_t count) {
    const std::size_t index = layer_of(command, state);
    if (frame_ == 0) {
        from_ = turned(middle(state.desk.layers()[index].region), state.desk.editor().rotation());
        state.desk.begin_drag({.index = index, .grip = Grip::Body}, from_);
    }
    const glm::dvec3 on_way = from_ + (vector_of(command) - from_) * part_done(count);
    state.desk.drag_to(glm::length(on_way) > 1e-6 ? on_way : vector_of(command));
    if (frame_ + 1 == count)
        state.desk.end_drag();
}

void ScriptPlayer::resize_layer(const ScriptCommand& command, ViewState& state, std::size_t count) {
    const std::size_t index = layer_of(command, state);
    cubemap::LightLayer layer = state.desk.layers()[index];
    if (frame_ == 0)
        size_from_ = size_of(layer.region);
    resize_region(layer.region, size_from_ + (command.numbers[0] - size_from_) * part_done(count));
    state.desk.change(index, layer);
    if (frame_ + 1 == count)
        state.desk.finish();
}

void ScriptPlayer::apply(const ScriptCommand& command, ViewState& state, std::size_t count,
                         Frame& frame) {
    switch (command.action) {
    case Action::Wait:
        break;
    case Action::AddDisc:
    case Action::AddRectangle:
    case Action::AddGain:
        state.desk.add(new_layer(command));
        break;
    case Action::DragLayer:
        drag_layer(command, state, count);
        break;
    case Action::ResizeLayer:
        resize_layer(command, state, count);
        break;
    case Action::SetGain:
        set_gain(command, state);
        break;
    case Action::Click:
    case Action::DragEnvironment:
    case Action::DragMesh:
    case Action::LassoEnvironment:
    case Action::PaintEnvironment:
        frame.pointer = moved_pointer(command, frame_, count, state.tool);
        break;
    case Action::Rotate:
        state.desk.set_rotation(command.numbers[0]);
        state.desk.finish();
        break;
    case Action::Undo:
        state.desk.undo();
        break;
    case Action::Redo:
        state.desk.redo();
        break;
    case Action::SceneExposure:
    case Action::EnvironmentExposure:
    case Action::Wireframe:
    case Action::Quadtree:
        set_look(command.action, command.numbers[0], state);
        break;
    case Action::Open:
    case Action::AddImage:
    case Action::Drop:
    case Action::SaveLayers:
    case Action::SaveEnvironment:
        if (!use_file(command.action, command.text, state))
            fail(command, state.message);
        break;
    case Action::Screenshot:
        frame.screenshot = command.text;
        break;
    case Action::Quit:
        next_ = commands_.size();
        break;
    }
}

} // namespace relumine::viewer
