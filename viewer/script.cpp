#include "viewer/script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/output_file.h"

namespace relumine::viewer {

namespace {

/// A command's word and its arguments: t is a word or "words in quotes", v is X,Y,Z, n is a number;
/// ? stands before optional arguments.
struct Form {
    std::string_view name;
    Action action;
    std::string_view arguments;
    std::string_view usage;
};

constexpr std::array Forms = {
    Form{"wait", Action::Wait, "n", "wait FRAMES"},
    Form{"add_disc", Action::AddDisc, "tvn", "add_disc NAME X,Y,Z RADIUS"},
    Form{"add_rectangle", Action::AddRectangle, "tvnn", "add_rectangle NAME X,Y,Z WIDTH HEIGHT"},
    Form{"add_gain", Action::AddGain, "tvnn", "add_gain NAME X,Y,Z RADIUS FACTOR"},
    Form{"drag_layer", Action::DragLayer, "tv?n", "drag_layer NAME X,Y,Z [EVENTS]"},
    Form{"resize_layer", Action::ResizeLayer, "tn?n", "resize_layer NAME DEGREES [EVENTS]"},
    Form{"set_gain", Action::SetGain, "tn", "set_gain NAME EV"},
    Form{"drag_env", Action::DragEnvironment, "nnnn", "drag_env X0 Y0 X1 Y1"},
    Form{"paint_env", Action::PaintEnvironment, "nnnn", "paint_env X0 Y0 X1 Y1"},
    Form{"lasso_env", Action::LassoEnvironment, "nnnn", "lasso_env X0 Y0 X1 Y1"},
    Form{"drag_mesh", Action::DragMesh, "nnnn", "drag_mesh X0 Y0 X1 Y1"},
    Form{"click", Action::Click, "nn", "click X Y"},
    Form{"click_mesh", Action::Click, "nn", "click_mesh X Y"},
    Form{"rotate", Action::Rotate, "n", "rotate DEGREES"},
    Form{"undo", Action::Undo, "", "undo"},
    Form{"redo", Action::Redo, "", "redo"},
    Form{"exposure", Action::SceneExposure, "n", "exposure EV"},
    Form{"env_exposure", Action::EnvironmentExposure, "n", "env_exposure EV"},
    Form{"wireframe", Action::Wireframe, "n", "wireframe 0|1"},
    Form{"quadtree", Action::Quadtree, "n", "quadtree 0|1"},
    Form{"open", Action::Open, "t", "open FILE"},
    Form{"add_image", Action::AddImage, "t", "add_image FILE"},
    Form{"drop", Action::Drop, "t", "drop FILE"},
    Form{"save_layers", Action::SaveLayers, "t", "save_layers FILE"},
    Form{"save_env", Action::SaveEnvironment, "t", "save_env FILE"},
    Form{"screenshot", Action::Screenshot, "t", "screenshot FILE"},
    Form{"quit", Action::Quit, "", "quit"},
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

std::optional<double> number(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool append_vector(std::string_view text, std::vector<double>& numbers) {
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = i < 2 ? text.find(',') : text.size();
        const std::optional<double> value =
            comma == std::string_view::npos ? std::nullopt : number(text.substr(0, comma));
        if (!value)
            return false;
        numbers.push_back(*value);
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    const std::size_t n = numbers.size();
    return numbers[n - 3] != 0.0 || numbers[n - 2] != 0.0 || numbers[n - 1] != 0.0;
}

/// Reads the arguments. Returns false when the words do not fit the form.
bool read_arguments(const Form& form, const std::vector<std::string>& words,
                    ScriptCommand& command) {
    std::size_t next = 1;
    bool optional = false;
    for (const char kind : form.arguments) {
        if (kind == '?') {
            optional = true;
            continue;
        }
        if (next == words.size())
            return optional;
        const std::string& word = words[next++];
        if (kind == 't') {
            command.text = word;
            if (word.empty())
                return false;
        } else if (kind == 'v') {
            if (!append_vector(word, command.numbers))
                return false;
        } else if (const std::optional<double> value = number(word)) {
            command.numbers.push_back(*value);
        } else {
            return false;
        }
    }
    return next == words.size();
}

} // namespace

std::size_t num_frames(const ScriptCommand& command) {
    constexpr std::size_t DragEvents = 20;
    constexpr double MaxFrames = 100'000.0;
    const auto frames = [&](std::size_t index, std::size_t otherwise) {
        if (index >= command.numbers.size())
            return otherwise;
        return static_cast<std::size_t>(std::clamp(command.numbers[index], 1.0, MaxFrames));
    };
    switch (command.action) {
    case Action::Wait:
        return frames(0, 1);
    case Action::DragLayer:
        return frames(3, DragEvents);
    case Action::ResizeLayer:
        return frames(1, DragEvents);
    case Action::DragEnvironment:
    case Action::PaintEnvironment:
    case Action::LassoEnvironment:
    case Action::DragMesh:
        return DragEvents + 2; // the pointer arrives, and lets go
    case Action::Click:
        return 3;
    default:
        return 1;
    }
}

std::vector<ScriptCommand> parse_script(std::string_view text, const std::string& source) {
    std::vector<ScriptCommand> commands;
    std::size_t line_number = 0;
    while (!text.empty()) {
        ++line_number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));

        const std::optional<std::vector<std::string>> words = words_of(line);
        if (!words)
            throw std::runtime_error(fmt::format(
                "{}:{}: expected a closing quote, got the line's end", source, line_number));
        if (words->empty())
            continue;
        const auto form = std::find_if(Forms.begin(), Forms.end(),
                                       [&](const Form& f) { return f.name == words->front(); });
        if (form == Forms.end())
            throw std::runtime_error(
                fmt::format("{}:{}: expected a command of docs/viewer.md, got '{}'", source,
                            line_number, words->front()));
        ScriptCommand command{.action = form->action, .line = line_number};
        if (!read_arguments(*form, *words, command))
            throw std::runtime_error(fmt::format("{}:{}: expected {}, got '{}'", source,
                                                 line_number, form->usage, line));
        commands.push_back(std::move(command));
    }
    return commands;
}

std::vector<ScriptCommand> load_script(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    std::string text;
    std::transform(bytes.begin(), bytes.end(), std::back_inserter(text),
                   [](std::byte byte) { return static_cast<char>(byte); });
    return parse_script(text, path.string());
}

} // namespace relumine::viewer
