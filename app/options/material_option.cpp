#include "app/options/material_option.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/command_line/command_line.h"
#include "files/joined.h"
#include "prt/glossy/lobe_list.h"

namespace relumine::app {

namespace {

class Parser {
public:
    Parser(const std::string& text, const std::string& option) : text_(text), option_(option) {}
    SurfaceMaterial parse();

private:
    [[noreturn]] void fail(const std::string& expected, std::string_view got) const {
        throw UsageError(option_, fmt::format("expected {}, got '{}'", expected, got));
    }
    const prt::LobeFacts& take_model(std::string_view& rest, SurfaceMaterial& result) const;
    void read_values(std::string_view rest, const prt::LobeFacts& model);
    [[nodiscard]] std::vector<float> numbers(std::string_view key, float max) const;
    [[nodiscard]] std::optional<glm::vec3> color(std::string_view key) const;

    const std::string& text_;
    const std::string& option_;
    std::map<std::string_view, std::vector<std::string_view>> values_;
};

/// Group names may have any letters: the model is looked for behind the last = that a model's name
/// follows.
const prt::LobeFacts& Parser::take_model(std::string_view& rest, SurfaceMaterial& result) const {
    const std::string_view text = text_;
    for (std::size_t start = text.size() + 1; start-- > 0;) {
        if (start > 0 && text[start - 1] != '=')
            continue;
        for (std::size_t i = 0; i < prt::NumHighlights; ++i) {
            const auto highlight = static_cast<prt::Highlight>(i);
            const prt::LobeFacts& model = prt::facts_of(highlight);
            const std::string_view tail = text.substr(start);
            if (tail != model.name && !tail.starts_with(fmt::format("{}:", model.name)))
                continue;
            if (start == 1)
                fail("a group's name before =", text);
            result.group = start > 0 ? text.substr(0, start - 1) : "";
            result.highlight = highlight;
            rest = tail.substr(std::min(model.name.size() + 1, tail.size()));
            return model;
        }
    }
    std::vector<std::string> forms;
    for (std::size_t i = 1; i <= prt::NumHighlights; ++i) // lambert last
        forms.push_back(
            fmt::format("[GROUP=]{}:...",
                        prt::facts_of(static_cast<prt::Highlight>(i % prt::NumHighlights)).name));
    const std::string last = std::exchange(forms.back(), "");
    forms.pop_back();
    fail(files::joined(forms, ", ") + " or " + last, text);
}

/// key=number,number,number,key=number: words without = belong to the key before them.
void Parser::read_values(std::string_view rest, const prt::LobeFacts& model) {
    std::vector<std::string_view> keys = {model.albedo};
    for (const std::string_view key : {model.specular, model.shape})
        if (!key.empty())
            keys.push_back(key);
    std::vector<std::string_view>* current = nullptr;
    while (!rest.empty()) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        std::string_view word = rest.substr(0, comma);
        const bool ends_in_comma = comma + 1 == rest.size();
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        if (const std::size_t equals = word.find('='); equals != std::string_view::npos) {
            const std::string_view key = word.substr(0, equals);
            if (std::find(keys.begin(), keys.end(), key) == keys.end())
                fail(fmt::format("{} of {}", files::joined(keys, ", "), model.name), key);
            if (values_.contains(key))
                fail(fmt::format("{} once", key), text_);
            current = &values_[key];
            word.remove_prefix(equals + 1);
        }
        if (current == nullptr || ends_in_comma)
            fail(fmt::format("{}:NAME=VALUE,...", model.name), text_);
        current->push_back(word);
    }
}

std::vector<float> Parser::numbers(std::string_view key, float max) const {
    std::vector<float> result;
    const auto found = values_.find(key);
    if (found == values_.end())
        return result;
    for (const std::string_view word : found->second) {
        float value = 0.0f;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() ||
            !(value >= 0.0f && value <= max))
            fail(fmt::format("numbers of 0 to {} as {}", max, key), word);
        result.push_back(value);
    }
    return result;
}

std::optional<glm::vec3> Parser::color(std::string_view key) const {
    const std::vector<float> values = numbers(key, 1.0f);
    if (values.empty())
        return std::nullopt;
    if (values.size() == 1)
        return glm::vec3(values[0]);
    if (values.size() != 3) {
        std::vector<std::string> texts;
        texts.reserve(values.size());
        for (const float value : values)
            texts.push_back(fmt::format("{}", value));
        fail(fmt::format("1 or 3 numbers of {}", key), files::joined(texts, ","));
    }
    return glm::vec3(values[0], values[1], values[2]);
}

SurfaceMaterial Parser::parse() {
    SurfaceMaterial result;
    std::string_view rest;
    const prt::LobeFacts& model = take_model(rest, result);
    read_values(rest, model);
    result.albedo = color(model.albedo);
    if (!model.specular.empty())
        result.specular = color(model.specular);
    if (!model.shape.empty()) {
        const std::vector<float> shape = numbers(model.shape, model.largest_shape);
        if (shape.size() != 1)
            fail(fmt::format("one number of {} of {}", model.shape, model.name), text_);
        result.roughness_or_exponent = shape[0];
    }
    if (model.needs_specular) {
        if (!result.specular)
            fail(fmt::format("{} of {}", model.specular, model.name), text_);
        const glm::vec3 sum = result.albedo.value_or(glm::vec3(0.0f)) + *result.specular;
        if (std::max({sum.r, sum.g, sum.b}) > 1.0f + 1e-6f)
            fail(fmt::format("{} + {} of 1 or less", model.albedo, model.specular), text_);
    }
    return result;
}

} // namespace

SurfaceMaterial parse_material(const std::string& text, const std::string& option) {
    return Parser(text, option).parse();
}

prt::SurfaceOverride surface_override(const std::vector<SurfaceMaterial>& options,
                                      const mesh::TriangleMesh& mesh, const std::string& option) {
    try {
        return relumine::surface_override(options, mesh);
    } catch (const std::invalid_argument& error) {
        throw UsageError(option, error.what());
    }
}

} // namespace relumine::app
