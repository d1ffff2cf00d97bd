#include "viewer/script_player.h"

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

void ScriptPlayer::apply(const ScriptCommand& command, ViewState& state, std::size_t count,
                         Frame& frame) {
    const std::vector<double>& n = command.numbers;
    const double t = static_cast<double>(frame_ + 1) / static_cast<double>(count);
    const bool is_last = frame_ + 1 == count;
    const auto must = [&](bool worked) {
        if (!worked)
            fail(command, state.message);
    };
    switch (command.action) {
    case Action::Wait:
        break;
    case Action::AddDisc:
        state.desk.add(
            {.name = command.text,
             .region = cubemap::Disc{.direction = vector_of(command), .radius_degrees = n[3]}});
        break;
    case Action::AddRectangle:
        state.desk.add({.name = command.text,
                        .region = cubemap::Rectangle{.direction = vector_of(command),
                                                     .width_degrees = n[3],
                                                     .height_degrees = n[4]}});
        break;
    case Action::AddGain:
        state.desk.add(
            {.name = command.text,
             .region = cubemap::Disc{.direction = vector_of(command), .radius_degrees = n[3]},
             .effect = cubemap::Gain{.factor = static_cast<float>(n[4])}});
        break;
    case Action::DragLayer: {
        const std::size_t index = layer_of(command, state);
        if (frame_ == 0) {
            from_ =
                turned(middle(state.desk.layers()[index].region), state.desk.editor().rotation());
            state.desk.begin_drag({.index = index, .grip = Grip::Body}, from_);
        }
        const glm::dvec3 on_way = from_ + (vector_of(command) - from_) * t;
        state.desk.drag_to(glm::length(on_way) > 1e-6 ? on_way : vector_of(command));
        if (is_last)
            state.desk.end_drag();
        break;
    }
    case Action::ResizeLayer: {
        const std::size_t index = layer_of(command, state);
        cubemap::LightLayer layer = state.desk.layers()[index];
        if (frame_ == 0)
            size_from_ = size_of(layer.region);
        resize_region(layer.region, size_from_ + (n[0] - size_from_) * t);
        state.desk.change(index, layer);
        if (is_last)
            state.desk.finish();
        break;
    }
    case Action::SetGain: {
        const std::size_t index = layer_of(command, state);
        cubemap::LightLayer layer = state.desk.layers()[index];
        layer.gain_ev = n[0];
        state.desk.change(index, layer);
        state.desk.finish();
        break;
    }
    case Action::DragEnvironment:
    case Action::PaintEnvironment:
    case Action::DragMesh:
        state.tool =
            command.action == Action::PaintEnvironment && !is_last ? Tool::Paint : Tool::Move;
        frame.pointer = dragged(n, frame_, count);
        break;
    case Action::LassoEnvironment:
        // The panel goes back to the move tool when the outline is closed.
        if (frame_ == 0)
            state.tool = Tool::Lasso;
        frame.pointer = lassoed(n, frame_, count);
        break;
    case Action::Click:
        frame.pointer = Pointer{.pixel = glm::vec2(n[0], n[1]), .down = frame_ == 1};
        break;
    case Action::Rotate:
        state.desk.set_rotation(n[0]);
        state.desk.finish();
        break;
    case Action::Undo:
        state.desk.undo();
        break;
    case Action::Redo:
        state.desk.redo();
        break;
    case Action::SceneExposure:
        state.scene_look.exposure_ev = static_cast<float>(n[0]);
        break;
    case Action::EnvironmentExposure:
        state.environment_look.exposure_ev = static_cast<float>(n[0]);
        break;
    case Action::Wireframe:
        state.scene_look.wireframe = n[0] != 0.0;
        break;
    case Action::Quadtree:
        state.environment_look.quadtree = n[0] != 0.0;
        break;
    case Action::Open:
        must(open(state, command.text));
        break;
    case Action::AddImage:
        must(add_image(state, command.text));
        break;
    case Action::Drop:
        must(drop(state, command.text));
        break;
    case Action::SaveLayers:
        must(save_layers(state, command.text));
        break;
    case Action::SaveEnvironment:
        must(save_environment(state, command.text));
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
