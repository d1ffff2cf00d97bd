#include "viewer/script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/output_file.h"
#include "relumine/light/layers.h"

namespace relumine::viewer {

namespace {

constexpr std::size_t DragEvents = 20;
/// With the pointer's coming and its letting go.
constexpr std::size_t DragFrames = DragEvents + 2;

[[noreturn]] void fail(const ScriptCommand& command, const std::string& reason) {
    throw std::runtime_error(fmt::format("script line {}: {}", command.line, reason));
}

/// One frame of a command.
struct Step {
    const ScriptCommand& command;
    ViewState& state;
    /// The rectangle of the scene's picture.
    const PixelRectangle& viewport;
    ScriptPlayer::Frame& wishes;
    /// The number of this frame of the command, and of all its frames.
    std::size_t index, count;
    /// Kept from frame to frame.
    glm::dvec3& from;

    [[nodiscard]] bool is_first() const { return index == 0; }
    [[nodiscard]] bool is_last() const { return index + 1 == count; }
    /// The part of the command that is done after this frame, up to 1.
    [[nodiscard]] double part_done() const {
        return static_cast<double>(index + 1) / static_cast<double>(count);
    }
    [[nodiscard]] double number(std::size_t i) const { return command.numbers[i]; }
    [[nodiscard]] glm::dvec3 direction() const {
        return glm::normalize(glm::dvec3(number(0), number(1), number(2)));
    }
    /// The layer that the command names.
    [[nodiscard]] std::size_t layer() const {
        const std::optional<std::size_t> found = find(state.desk, command.text);
        if (!found)
            fail(command, fmt::format("expected the name of a layer, got '{}'", command.text));
        return *found;
    }
};

/// The pointer arrives, presses, moves, and lets go.
Pointer dragged(const Step& s, const glm::dvec2& from, const glm::dvec2& to) {
    const double t =
        s.index < 2 ? 0.0 : static_cast<double>(s.index - 1) / static_cast<double>(s.count - 3);
    return {.pixel = glm::vec2(from + (to - from) * std::min(t, 1.0)),
            .down = !s.is_first() && !s.is_last()};
}

void drag(Step& s) {
    s.wishes.pointer = dragged(s, {s.number(0), s.number(1)}, {s.number(2), s.number(3)});
}

void drag_to_move(Step& s) {
    s.state.tool = Tool::Move;
    drag(s);
}

void drag_thing(Step& s) {
    s.state.click = s.is_last() ? Click::Ask : Click::Move;
    drag(s);
}

void paint(Step& s) {
    s.state.tool = s.is_last() ? Tool::Move : Tool::Paint;
    drag(s);
}

/// Drags around the ellipse that fills a rectangle.
void draw_lasso(Step& s) {
    // The panel goes back to the move tool when the outline is closed.
    if (s.is_first())
        s.state.tool = Tool::Lasso;
    Pointer pointer = dragged(s, {0.0, 0.0}, {1.0, 0.0});
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(pointer.pixel.x);
    const glm::dvec2 from(s.number(0), s.number(1)), to(s.number(2), s.number(3));
    pointer.pixel = glm::vec2(0.5 * (from + to) +
                              0.5 * (to - from) * glm::dvec2(std::cos(angle), std::sin(angle)));
    s.wishes.pointer = pointer;
}

void click(Step& s) {
    s.wishes.pointer = Pointer{.pixel = glm::vec2(s.number(0), s.number(1)), .down = s.index == 1};
}

void add_disc(Step& s) {
    add(s.state.desk,
        {.name = s.command.text,
         .region = cubemap::Disc{.direction = s.direction(), .radius_degrees = s.number(3)}});
}

void add_rectangle(Step& s) {
    add(s.state.desk, {.name = s.command.text,
                       .region = cubemap::Rectangle{.direction = s.direction(),
                                                    .width_degrees = s.number(3),
                                                    .height_degrees = s.number(4)}});
}

void add_gain(Step& s) {
    add(s.state.desk,
        {.name = s.command.text,
         .region = cubemap::Disc{.direction = s.direction(), .radius_degrees = s.number(3)},
         .effect = cubemap::Gain{.factor = static_cast<float>(s.number(4))}});
}

void drag_layer(Step& s) {
    const LightDesk& desk = s.state.desk;
    const std::size_t index = s.layer();
    if (s.is_first()) {
        s.from = turned(middle(desk.layers()[index].region), desk.state().rotation_degrees);
        s.state.hand.begin_drag({.index = index, .grip = Grip::Body}, s.from);
    }
    const glm::dvec3 on_way = s.from + (s.direction() - s.from) * s.part_done();
    s.state.hand.move_to(glm::length(on_way) > 1e-6 ? on_way : s.direction());
    if (s.is_last())
        s.state.hand.end();
}

/// The radius or the width; null for a lasso, which has neither.
double* size_of(cubemap::Region& region) {
    if (auto* disc = std::get_if<cubemap::Disc>(&region))
        return &disc->radius_degrees;
    if (auto* stroke = std::get_if<cubemap::Stroke>(&region))
        return &stroke->radius_degrees;
    auto* box = std::get_if<cubemap::Rectangle>(&region);
    return box != nullptr ? &box->width_degrees : nullptr;
}

void resize_layer(Step& s) {
    const std::size_t index = s.layer();
    cubemap::LightLayer layer = s.state.desk.layers()[index];
    if (double* size = size_of(layer.region)) {
        if (s.is_first())
            s.from.x = *size;
        const double degrees = s.from.x + (s.number(0) - s.from.x) * s.part_done();
        if (auto* box = std::get_if<cubemap::Rectangle>(&layer.region))
            box->height_degrees *= degrees / box->width_degrees;
        *size = degrees;
    } else {
        fail(s.command, "expected a layer with a radius or a width");
    }
    change(s.state.desk, index, layer);
    if (s.is_last())
        s.state.desk.finish();
}

/// Lets a light fall on the point of the mesh that a pixel shows.
template<Aim How>
void aim(Step& s) {
    if (!aim_light(s.state, s.layer(), s.viewport, {s.number(0), s.number(1)}, How))
        fail(s.command,
             fmt::format("expected a pixel of the mesh, got {} {}", s.number(0), s.number(1)));
    s.state.desk.finish();
}

void add_preset(Step& s) {
    const cubemap::LayerPreset* preset = cubemap::find_preset(s.command.text);
    if (preset == nullptr)
        fail(s.command, fmt::format("expected the name of a preset, got '{}'", s.command.text));
    add(s.state.desk, cubemap::placed(*preset, s.direction()));
}

void solo(Step& s) {
    set_solo(s.state.desk, s.layer(), s.number(0) != 0.0);
}

void set_gain(Step& s) {
    const std::size_t index = s.layer();
    cubemap::LightLayer layer = s.state.desk.layers()[index];
    layer.gain_ev = s.number(0);
    change(s.state.desk, index, layer);
    s.state.desk.finish();
}

/// Without a name, all lamps.
void dim(Step& s) {
    try {
        set_dimmer(s.state.desk, s.command.text, glm::vec3(static_cast<float>(s.number(0))));
    } catch (const std::invalid_argument& error) {
        fail(s.command, error.what());
    }
}

void set_roughness(Step& s) {
    if (!s.state.live_eye)
        fail(s.command, "expected a scene whose highlights follow the eye");
    const double roughness = s.number(0);
    if (!(roughness >= 0.0 && roughness <= 1.0))
        fail(s.command, "expected a roughness from 0 to 1");
    s.state.roughness = static_cast<float>(roughness);
}

void rotate(Step& s) {
    set_rotation(s.state.desk, s.number(0));
    s.state.desk.finish();
}

/// Opens or saves a file.
template<bool (*Use)(ViewState&, const std::filesystem::path&)>
void use_file(Step& s) {
    if (!Use(s.state, s.command.text))
        fail(s.command, s.state.message);
}

void picture(Step& s) {
    if (!save_picture(s.state, s.viewport, s.command.text))
        fail(s.command, s.state.message);
}

constexpr std::size_t None = std::numeric_limits<std::size_t>::max();

/// A command: its word and its arguments, what it does in a frame, and how many frames it takes.
struct Verb {
    /// NAME and FILE are a word or "words in quotes", X,Y,Z is a direction, all others are numbers;
    /// those in brackets may be left out.
    std::string_view usage;
    void (*play)(Step&);
    std::size_t frames = 1;
    /// The number that says how many frames, if it is there.
    std::size_t frames_at = None;

    [[nodiscard]] std::string_view name() const { return usage.substr(0, usage.find(' ')); }
};

constexpr std::array Verbs = {
    Verb{"wait FRAMES", [](Step&) {}, 1, 0},
    Verb{"add_disc NAME X,Y,Z RADIUS", add_disc},
    Verb{"add_rectangle NAME X,Y,Z WIDTH HEIGHT", add_rectangle},
    Verb{"add_gain NAME X,Y,Z RADIUS FACTOR", add_gain},
    Verb{"add_preset NAME X,Y,Z", add_preset},
    Verb{"solo NAME 0|1", solo},
    Verb{"drag_layer NAME X,Y,Z [EVENTS]", drag_layer, DragEvents, 3},
    Verb{"resize_layer NAME DEGREES [EVENTS]", resize_layer, DragEvents, 1},
    Verb{"aim_layer NAME X Y", aim<Aim::Facing>},
    Verb{"mirror_layer NAME X Y", aim<Aim::Mirrored>},
    Verb{"set_gain NAME EV", set_gain},
    Verb{"dim NAME GAIN", dim},
    Verb{"roughness R", set_roughness},
    Verb{"drag_env X0 Y0 X1 Y1", drag_to_move, DragFrames},
    Verb{"paint_env X0 Y0 X1 Y1", paint, DragFrames},
    Verb{"lasso_env X0 Y0 X1 Y1", draw_lasso, DragFrames},
    Verb{"drag_mesh X0 Y0 X1 Y1", drag_to_move, DragFrames},
    Verb{"drag_thing X0 Y0 X1 Y1", drag_thing, DragFrames},
    Verb{"click_does 0|1|2|3",
         [](Step& s) {
             s.state.click = static_cast<Click>(std::clamp(s.number(0), 0.0, 3.0));
         }},
    Verb{"click X Y", click, 3},
    Verb{"click_mesh X Y", click, 3},
    Verb{"rotate DEGREES", rotate},
    Verb{"undo",
         [](Step& s) {
             s.state.desk.undo();
         }},
    Verb{"redo",
         [](Step& s) {
             s.state.desk.redo();
         }},
    Verb{"exposure EV",
         [](Step& s) {
             s.state.scene_look.exposure_ev = static_cast<float>(s.number(0));
         }},
    Verb{"env_exposure EV",
         [](Step& s) {
             s.state.environment_look.exposure_ev = static_cast<float>(s.number(0));
         }},
    Verb{"wireframe 0|1",
         [](Step& s) {
             s.state.scene_look.wireframe = s.number(0) != 0.0;
         }},
    Verb{"quadtree 0|1",
         [](Step& s) {
             s.state.environment_look.quadtree = s.number(0) != 0.0;
         }},
    Verb{"open FILE", use_file<open>},
    Verb{"add_image FILE", use_file<add_image>},
    Verb{"drop FILE", use_file<drop>},
    Verb{"save_layers FILE", use_file<save_layers>},
    Verb{"save_env FILE", use_file<save_environment>},
    Verb{"save_picture FILE", picture},
    Verb{"look X Y",
         [](Step& s) {
             s.state.camera.look({s.number(0), s.number(1)});
         }},
    Verb{"fly X,Y,Z",
         [](Step& s) {
             s.state.camera.fly({s.number(0), s.number(1), s.number(2)});
         }},
    Verb{"screenshot FILE",
         [](Step& s) {
             s.wishes.screenshot = s.command.text;
         }},
    Verb{"quit",
         [](Step&) {
         }},
};

/// Returns the words of a line, up to a #; nothing for quotes without an end.
std::optional<std::vector<std::string>> words_of(std::string_view line) {
    std::vector<std::string> words;
    std::size_t at = 0;
    while (true) {
        at = line.find_first_not_of(" \t\r", at);
        if (at == std::string_view::npos || line[at] == '#')
            return words;
        if (line[at] == '"') {
            const std::size_t end = line.find('"', at + 1);
            if (end == std::string_view::npos)
                return std::nullopt;
            words.emplace_back(line.substr(at + 1, end - at - 1));
            at = end + 1;
        } else {
            const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
            words.emplace_back(line.substr(at, end - at));
            at = end;
        }
    }
}

/// Appends the numbers of a word, with commas between them. Returns false for other words.
bool append_numbers(std::string_view word, std::size_t count, std::vector<double>& numbers) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t end = i + 1 < count ? word.find(',') : word.size();
        if (end == std::string_view::npos)
            return false;
        double value = 0.0;
        const auto [last, error] = std::from_chars(word.data(), word.data() + end, value);
        if (error != std::errc() || last != word.data() + end || !std::isfinite(value))
            return false;
        numbers.push_back(value);
        word.remove_prefix(std::min(end + 1, word.size()));
    }
    return true;
}

/// Reads the arguments. Returns false when the words do not fit the usage.
bool read_arguments(const std::vector<std::string>& words, ScriptCommand& command) {
    const std::vector<std::string> wanted = *words_of(Verbs[command.verb].usage);
    if (words.size() > wanted.size())
        return false;
    for (std::size_t i = 1; i < wanted.size(); ++i) {
        if (i == words.size())
            return wanted[i].starts_with('[');
        std::vector<double>& numbers = command.numbers;
        if (wanted[i] == "NAME" || wanted[i] == "FILE") {
            command.text = words[i];
            if (words[i].empty())
                return false;
        } else if (wanted[i] == "X,Y,Z") {
            if (!append_numbers(words[i], 3, numbers) ||
                std::all_of(numbers.end() - 3, numbers.end(), [](double n) { return n == 0.0; }))
                return false;
        } else if (!append_numbers(words[i], 1, numbers)) {
            return false;
        }
    }
    return true;
}

} // namespace

std::string_view ScriptCommand::name() const {
    return Verbs[verb].name();
}

std::size_t ScriptCommand::num_frames() const {
    constexpr double MaxFrames = 100'000.0;
    const Verb& own = Verbs[verb];
    return own.frames_at < numbers.size()
               ? static_cast<std::size_t>(std::clamp(numbers[own.frames_at], 1.0, MaxFrames))
               : own.frames;
}

std::vector<ScriptCommand> parse_script(std::string_view text, const std::string& source) {
    std::vector<ScriptCommand> commands;
    std::size_t line_number = 0;
    while (!text.empty()) {
        ++line_number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const auto expect = [&](bool is_met, std::string_view expected, std::string_view got) {
            if (!is_met)
                throw std::runtime_error(
                    fmt::format("{}:{}: expected {}, got {}", source, line_number, expected, got));
        };
        const std::optional<std::vector<std::string>> words = words_of(line);
        expect(words.has_value(), "a closing quote", "the line's end");
        if (words->empty())
            continue;
        const auto verb = std::find_if(Verbs.begin(), Verbs.end(), [&](const Verb& each) {
            return each.name() == words->front();
        });
        expect(verb != Verbs.end(), "a command of docs/viewer.md",
               fmt::format("'{}'", words->front()));
        ScriptCommand command{.verb = static_cast<std::size_t>(verb - Verbs.begin()),
                              .line = line_number};
        expect(read_arguments(*words, command), verb->usage, fmt::format("'{}'", line));
        commands.push_back(std::move(command));
    }
    return commands;
}

std::vector<ScriptCommand> load_script(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    return parse_script({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string());
}

ScriptPlayer::Frame ScriptPlayer::step(ViewState& state, const PixelRectangle& viewport) {
    Frame wishes;
    if (is_done())
        return wishes;
    const ScriptCommand& command = commands_[next_];
    const std::size_t count = command.num_frames();
    Step now{command, state, viewport, wishes, frame_, count, from_};
    try {
        Verbs[command.verb].play(now);
    } catch (const std::invalid_argument& error) { // values that no layer can have
        fail(command, error.what());
    }
    if (++frame_ >= count) {
        frame_ = 0;
        next_ = command.name() == "quit" ? commands_.size() : next_ + 1;
    }
    return wishes;
}

} // namespace relumine::viewer
