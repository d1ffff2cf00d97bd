#include "files/json.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace relumine::files {

namespace {

/// Deeper values would overflow the stack when they are destroyed.
constexpr std::size_t MaxJsonDepth = 100;

/// Reads a text and counts its lines.
class CountingIterator {
public:
    /// The present line, and that of the last character that is not white space: the parser reads
    /// one character past a number.
    struct Place {
        int line = 1;
        int last_line = 1;
    };

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

} // namespace

/// Builds the value from the parser's events. nlohmann gives the names of the functions.
class JsonBuilder {
public:
    JsonBuilder(const int& line, Repeats repeats) : line_(line), repeats_(repeats) {}

    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(std::int64_t value) { return add(value); }
    bool number_unsigned(std::uint64_t value) { return add(value); }
    bool number_float(double value, const std::string&) { return add(value); }
    bool string(std::string& value) { return add(std::move(value)); }
    bool binary(nlohmann::json::binary_t&) { return false; }
    bool start_object(std::size_t) { return open(Json::Object()); }
    bool start_array(std::size_t) { return open(Json::Array()); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(std::string& name) {
        if (repeats_ == Repeats::Refuse && open_.back().value.find(name) != nullptr)
            fail("a name that comes twice", fmt::format("one \"{}\"", name), "a second one");
        open_.back().key = std::move(name);
        return true;
    }
    [[noreturn]] bool parse_error(std::size_t byte, const std::string&,
                                  const nlohmann::json::exception& error) {
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
        // Newer versions of the library have a sentence of their own, with a hint for programmers.
        if (dash == std::string_view::npos && text.find("an empty input") != std::string_view::npos)
            reason = "end of input";
        // The library has no type of its own for a number that a double does not hold.
        constexpr int OutOfRange = 406;
        fail(error.id == OutOfRange ? "a number out of range"
                                    : fmt::format("a syntax error at byte {}", byte),
             expected, reason);
    }

    Json result;

private:
    struct Level {
        Json value;
        std::string key;
    };

    [[noreturn]] void fail(const std::string& message, std::string_view expected,
                           std::string_view got) const {
        throw JsonSyntaxError(message, line_, expected, got);
    }
    bool add(Json value) {
        value.line_ = line_;
        return place(std::move(value));
    }
    bool open(Json value) {
        if (open_.size() == MaxJsonDepth)
            fail(fmt::format("more than {} levels of nesting", MaxJsonDepth),
                 fmt::format("at most {} levels of nesting", MaxJsonDepth), "more");
        value.line_ = line_;
        open_.push_back({std::move(value), {}});
        return true;
    }
    bool close() {
        Json closed = std::move(open_.back().value);
        open_.pop_back();
        return place(std::move(closed));
    }
    bool place(Json value) {
        if (open_.empty())
            result = std::move(value);
        else if (auto* array = std::get_if<Json::Array>(&open_.back().value.value_))
            array->push_back(std::move(value));
        else
            std::get<Json::Object>(open_.back().value.value_)
                .emplace_back(std::move(open_.back().key), std::move(value));
        return true;
    }

    const int& line_;
    Repeats repeats_;
    std::vector<Level> open_;
};

/// Hands values over to the JSON library, which writes them. Library is its type that sorts names,
/// or the one that keeps their order.
class JsonWriter {
public:
    template<typename Library>
    [[nodiscard]] static Library converted(const Json& json) {
        return std::visit(
            [](const auto& value) {
                using Value = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<Value, Json::Object>) {
                    Library result = Library::object();
                    for (const auto& [name, member] : value)
                        result[name] = converted<Library>(member);
                    return result;
                } else if constexpr (std::is_same_v<Value, Json::Array>) {
                    Library result = Library::array();
                    for (const Json& item : value)
                        result.push_back(converted<Library>(item));
                    return result;
                } else {
                    return Library(value);
                }
            },
            json.value_);
    }
};

Json::Json(std::initializer_list<Json> values) {
    const auto is_member = [](const Json& value) {
        return value.type() == Type::Array && value.size() == 2 &&
               value.values()[0].type() == Type::String;
    };
    if (!std::all_of(values.begin(), values.end(), is_member)) {
        value_ = Array(values);
        return;
    }
    Object members;
    for (const Json& value : values)
        members.emplace_back(value.values()[0].string(), value.values()[1]);
    value_ = std::move(members);
}

Json parse_json(std::string_view text, Repeats repeats) {
    CountingIterator::Place place;
    JsonBuilder builder(place.last_line, repeats);
    (void)nlohmann::json::sax_parse(CountingIterator(text.data(), &place),
                                    CountingIterator(text.data() + text.size(), &place), &builder);
    return std::move(builder.result);
}

Json::Type Json::type() const {
    constexpr std::array Types = {Type::Null,   Type::Boolean, Type::Number, Type::Number,
                                  Type::Number, Type::String,  Type::Array,  Type::Object};
    static_assert(Types.size() == std::variant_size_v<Content>);
    return Types[value_.index()];
}

std::string_view name(Json::Type type) {
    constexpr std::array<std::string_view, 6> Names = {"null",   "boolean", "number",
                                                       "string", "array",   "object"};
    return Names[static_cast<std::size_t>(type)];
}

template<typename T>
const T& Json::content(const char* expected) const {
    if (const T* content = std::get_if<T>(&value_))
        return *content;
    throw JsonError(fmt::format("expected {}, got {}", expected, name(type())));
}

bool Json::boolean() const {
    return content<bool>("true or false");
}

double Json::number() const {
    if (const auto* positive = std::get_if<std::uint64_t>(&value_))
        return static_cast<double>(*positive);
    if (const auto* integer = std::get_if<std::int64_t>(&value_))
        return static_cast<double>(*integer);
    return content<double>("a number");
}

std::uint64_t Json::whole() const {
    return content<std::uint64_t>("a whole number");
}

const std::string& Json::string() const {
    return content<std::string>("a string");
}

const Json::Array& Json::values() const {
    return content<Array>("an array");
}

const Json::Object& Json::members() const {
    return content<Object>("an object");
}

std::size_t Json::size() const {
    if (const auto* array = std::get_if<Array>(&value_))
        return array->size();
    const auto* object = std::get_if<Object>(&value_);
    return object != nullptr ? object->size() : 0;
}

const Json* Json::find(std::string_view name) const {
    const auto* object = std::get_if<Object>(&value_);
    if (object == nullptr)
        return nullptr;
    const auto found = std::find_if(object->rbegin(), object->rend(),
                                    [&](const auto& member) { return member.first == name; });
    return found == object->rend() ? nullptr : &found->second;
}

const Json& Json::at(std::string_view name) const {
    if (const Json* found = find(name))
        return *found;
    throw JsonError(fmt::format("expected \"{}\", got none", name));
}

void Json::set(std::string_view name, Json value) {
    if (type() == Type::Null)
        value_ = Object();
    auto& members = std::get<Object>(value_);
    const auto found = std::find_if(members.begin(), members.end(),
                                    [&](const auto& member) { return member.first == name; });
    if (found != members.end())
        found->second = std::move(value);
    else
        members.emplace_back(name, std::move(value));
}

void update(Json& object, const Json& members) {
    if (members.type() == Json::Type::Null)
        return;
    for (const auto& [name, value] : members.members())
        object.set(name, value);
}

void Json::push_back(Json value) {
    if (type() == Type::Null)
        value_ = Array();
    std::get<Array>(value_).push_back(std::move(value));
}

std::string Json::text(int indent, Order order, Utf8 utf8) const {
    using Handler = nlohmann::json::error_handler_t;
    const auto dump = [&]<typename Library>(const Library& json) {
        try {
            return json.dump(indent, ' ', false,
                             utf8 == Utf8::Replace ? Handler::replace : Handler::strict);
        } catch (const nlohmann::json::exception& error) {
            throw JsonError(error.what());
        }
    };
    return order == Order::Sorted ? dump(JsonWriter::converted<nlohmann::json>(*this))
                                  : dump(JsonWriter::converted<nlohmann::ordered_json>(*this));
}

} // namespace relumine::files
