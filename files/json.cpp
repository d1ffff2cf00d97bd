#include "files/json.h"

#include <algorithm>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace relumine::files {

namespace {

/// Deeper values would overflow the stack when they are destroyed.
constexpr std::size_t MaxJsonDepth = 100;

/// Builds the value from the parser's events. nlohmann gives the names of the functions.
class JsonBuilder {
public:
    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(std::int64_t value) { return add(value); }
    bool number_unsigned(std::uint64_t value) { return add(value); }
    bool number_float(double value, const std::string&) { return add(value); }
    bool string(std::string& value) { return add(std::move(value)); }
    bool binary(nlohmann::json::binary_t&) { return false; }
    bool start_object(std::size_t) { return open(true); }
    bool start_array(std::size_t) { return open(false); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(std::string& name) {
        open_.back().key = std::move(name);
        return true;
    }
    [[noreturn]] bool parse_error(std::size_t byte, const std::string&,
                                  const nlohmann::json::exception& error) {
        // The library has no type of its own for a number that a double does not hold.
        constexpr int OutOfRange = 406;
        throw JsonError(error.id == OutOfRange ? "a number out of range"
                                               : fmt::format("a syntax error at byte {}", byte));
    }

    Json result;

private:
    struct Level {
        Json::Array values;
        Json::Object members;
        bool is_object;
        std::string key;
    };

    bool add(Json value) {
        if (open_.empty())
            result = std::move(value);
        else if (open_.back().is_object)
            open_.back().members.emplace_back(std::move(open_.back().key), std::move(value));
        else
            open_.back().values.push_back(std::move(value));
        return true;
    }
    bool open(bool is_object) {
        if (open_.size() == MaxJsonDepth)
            throw JsonError(fmt::format("more than {} levels of nesting", MaxJsonDepth));
        open_.push_back({.values = {}, .members = {}, .is_object = is_object, .key = {}});
        return true;
    }
    bool close() {
        Level closed = std::move(open_.back());
        open_.pop_back();
        return add(closed.is_object ? Json(std::move(closed.members))
                                    : Json(std::move(closed.values)));
    }

    std::vector<Level> open_;
};

} // namespace

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
        return value.is_array() && value.size() == 2 && value.at(0).is_string();
    };
    if (!std::all_of(values.begin(), values.end(), is_member)) {
        value_ = Array(values);
        return;
    }
    Object members;
    for (const Json& value : values)
        members.emplace_back(value.at(0).string(), value.at(1));
    value_ = std::move(members);
}

Json Json::parse(std::string_view text) {
    JsonBuilder builder;
    (void)nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
    return std::move(builder.result);
}

const char* Json::type_name() const {
    if (is_number())
        return "number";
    return is_null()      ? "null"
           : is_boolean() ? "boolean"
           : is_string()  ? "string"
           : is_array()   ? "array"
                          : "object";
}

template<typename T>
const T& Json::content(const char* expected) const {
    if (const T* content = std::get_if<T>(&value_))
        return *content;
    throw JsonError(fmt::format("expected {}, got {}", expected, type_name()));
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

const Json& Json::at(std::size_t index) const {
    if (index < values().size())
        return values()[index];
    throw JsonError(fmt::format("expected {} values or more, got {}", index + 1, size()));
}

void Json::set(std::string_view name, Json value) {
    if (is_null())
        value_ = Object();
    auto& members = std::get<Object>(value_);
    const auto found = std::find_if(members.begin(), members.end(),
                                    [&](const auto& member) { return member.first == name; });
    if (found != members.end())
        found->second = std::move(value);
    else
        members.emplace_back(name, std::move(value));
}

void Json::update(const Json& other) {
    if (other.is_null())
        return;
    for (const auto& [name, value] : other.members())
        set(name, value);
}

void Json::push_back(Json value) {
    if (is_null())
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
