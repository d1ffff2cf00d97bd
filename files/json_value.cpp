#include "files/json_value.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/joined.h"
#include "files/nearest_name.h"

namespace relumine::files {

namespace {

/// A layer file never nests deeper. Deeper values would overflow the stack when they are destroyed.
constexpr std::size_t MaxDepth = 32;

/// The line of the last character read that is not white space. The parser reads one character past
/// a number.
struct Place {
    int line = 1;
    int last_line = 1;
};

class CountingIterator {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    CountingIterator(const char* at, Place* place) : at_(at), place_(place) {}
    reference operator*() const { return *at_; }
    CountingIterator& operator++() {
        if (*at_ == '\n')
            ++place_->line;
        else if (*at_ != ' ' && *at_ != '\t' && *at_ != '\r')
            place_->last_line = place_->line;
        ++at_;
        return *this;
    }
    CountingIterator operator++(int) {
        CountingIterator before = *this;
        ++*this;
        return before;
    }
    bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
    bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

private:
    const char* at_;
    Place* place_;
};

/// Builds the value from the parser's events. nlohmann gives the names of the functions.
class Builder {
public:
    Builder(const JsonReader& reader, const Place& place) : reader_(reader), place_(place) {}

    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(std::int64_t value) { return add(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) { return add(static_cast<double>(value)); }
    bool number_float(double value, const std::string&) { return add(value); }
    bool string(std::string& value) { return add(value); }
    bool binary(nlohmann::json::binary_t&) { return false; }
    bool start_object(std::size_t) { return open(JsonValue::Object()); }
    bool start_array(std::size_t) { return open(JsonValue::Array()); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(std::string& name) {
        const auto& members = std::get<JsonValue::Object>(open_.back().value);
        if (JsonReader::find(members, name) != nullptr)
            reader_.refuse(place_.last_line, fmt::format("one \"{}\"", name), "a second one");
        keys_.back() = name;
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
        // The text is "[json.exception...] parse error at line 1, column 2: syntax error while
        // parsing value - unexpected X; expected Y".
        const std::string_view text = error.what();
        const std::size_t dash = text.find(" - ");
        std::string_view reason = dash == std::string_view::npos ? text : text.substr(dash + 3);
        constexpr std::string_view Unexpected = "unexpected ", Expected = "; expected ";
        std::string_view expected = "JSON";
        if (reason.starts_with(Unexpected)) {
            reason.remove_prefix(Unexpected.size());
            if (const std::size_t at = reason.rfind(Expected); at != std::string_view::npos) {
                expected = reason.substr(at + Expected.size());
                reason = reason.substr(0, at);
            }
        }
        reader_.refuse(place_.last_line, expected, reason);
    }

    JsonValue result;

private:
    bool add(decltype(JsonValue::value) value) {
        place(JsonValue{place_.last_line, std::move(value)});
        return true;
    }
    bool open(decltype(JsonValue::value) value) {
        if (open_.size() == MaxDepth)
            reader_.refuse(place_.last_line, fmt::format("at most {} levels of nesting", MaxDepth),
                           "more");
        open_.push_back(JsonValue{place_.last_line, std::move(value)});
        keys_.emplace_back();
        return true;
    }
    bool close() {
        JsonValue closed = std::move(open_.back());
        open_.pop_back();
        keys_.pop_back();
        place(std::move(closed));
        return true;
    }
    void place(JsonValue value) {
        if (open_.empty())
            result = std::move(value);
        else if (auto* array = std::get_if<JsonValue::Array>(&open_.back().value))
            array->push_back(std::move(value));
        else
            std::get<JsonValue::Object>(open_.back().value)
                .emplace_back(keys_.back(), std::move(value));
    }

    const JsonReader& reader_;
    const Place& place_;
    std::vector<JsonValue> open_;
    std::vector<std::string> keys_;
};

std::string description(const JsonValue& value) {
    struct Describe {
        std::string operator()(std::nullptr_t) const { return "null"; }
        std::string operator()(bool is) const { return is ? "true" : "false"; }
        std::string operator()(double number) const { return fmt::format("{}", number); }
        std::string operator()(const std::string& text) const {
            return fmt::format("\"{}\"", text);
        }
        std::string operator()(const JsonValue::Array&) const { return "an array"; }
        std::string operator()(const JsonValue::Object&) const { return "an object"; }
    };
    return std::visit(Describe{}, value.value);
}

/// Returns the content if it is a T and refuses it otherwise.
template<typename T>
const T& content(const JsonReader& reader, const JsonValue& value, std::string_view what,
                 std::string_view type) {
    if (const T* is = std::get_if<T>(&value.value))
        return *is;
    reader.refuse(value.line, fmt::format("{} to be {}", what, type), description(value));
}

} // namespace

JsonValue JsonReader::parse(std::span<const std::byte> text) const {
    const auto* begin = reinterpret_cast<const char*>(text.data());
    Place position;
    Builder builder(*this, position);
    (void)nlohmann::json::sax_parse(CountingIterator(begin, &position),
                                    CountingIterator(begin + text.size(), &position), &builder);
    return std::move(builder.result);
}

void JsonReader::refuse(int line, std::string_view expected, std::string_view got) const {
    // Both may quote the file: a name, a text, or all that the parser has read since.
    std::string message =
        fmt::format("{}:{}: expected {:.500}, got {:.500}", name_, line, expected, got);
    std::replace_if(
        message.begin(), message.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; },
        '?');
    throw std::runtime_error(message);
}

double JsonReader::number(const JsonValue& value, std::string_view what) const {
    return content<double>(*this, value, what, "a number");
}

bool JsonReader::boolean(const JsonValue& value, std::string_view what) const {
    return content<bool>(*this, value, what, "true or false");
}

const std::string& JsonReader::string(const JsonValue& value, std::string_view what) const {
    return content<std::string>(*this, value, what, "a string");
}

const JsonValue::Array& JsonReader::array(const JsonValue& value, std::string_view what) const {
    return content<JsonValue::Array>(*this, value, what, "an array");
}

const JsonValue::Object& JsonReader::object(const JsonValue& value, std::string_view what) const {
    return content<JsonValue::Object>(*this, value, what, "an object");
}

const JsonValue* JsonReader::find(const JsonValue::Object& object, std::string_view field) {
    const auto found = std::find_if(object.begin(), object.end(),
                                    [&](const auto& member) { return member.first == field; });
    return found == object.end() ? nullptr : &found->second;
}

const JsonValue& JsonReader::required(const JsonValue& owner, const JsonValue::Object& members,
                                      std::string_view field) const {
    const JsonValue* found = find(members, field);
    if (found != nullptr)
        return *found;
    std::vector<std::string_view> names;
    for (const auto& [name, value] : members)
        names.push_back(name);
    const std::string_view nearest = nearest_name(field, names);
    if (nearest.empty())
        refuse(owner.line, fmt::format("\"{}\"", field), "none");
    refuse(find(members, nearest)->line, fmt::format("\"{}\"", field),
           fmt::format("\"{}\"", nearest));
}

void JsonReader::known(const JsonValue::Object& members, std::span<const std::string_view> names,
                       std::string_view what) const {
    for (const auto& [name, value] : members) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            refuse(value.line, fmt::format("in {} only {}", what, files::joined(names, ", ")),
                   fmt::format("\"{}\"{}", name, did_you_mean(name, names)));
    }
}

} // namespace relumine::files
