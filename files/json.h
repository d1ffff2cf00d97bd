// A value of JSON, to be written and to be read. The JSON library stays in json.cpp, since its
// header takes seconds to compile.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::files {

/// A text that is no JSON, or a value that is of another type than asked for.
class JsonError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An object of named values, a list, a number, text, a truth value or null.
class Json {
public:
    using Array = std::vector<Json>;
    /// Members in the order in which they were set.
    using Object = std::vector<std::pair<std::string, Json>>;

    /// Null.
    Json() = default;
    Json(std::nullptr_t) {}
    template<std::same_as<bool> T>
    Json(T value) : value_(value) {}
    template<std::signed_integral T>
    Json(T value) : value_(std::int64_t{value}) {}
    template<std::unsigned_integral T>
    requires(!std::same_as<T, bool>) Json(T value) : value_(std::uint64_t{value}) {}
    template<std::floating_point T>
    Json(T value) : value_(double{value}) {}
    Json(const char* text) : value_(std::string(text)) {}
    Json(std::string_view text) : value_(std::string(text)) {}
    Json(std::string text) : value_(std::move(text)) {}
    Json(const glm::vec3& vector) : Json(Array{vector.x, vector.y, vector.z}) {}
    Json(const glm::dvec3& vector) : Json(Array{vector.x, vector.y, vector.z}) {}
    Json(Array values) : value_(std::move(values)) {}
    Json(Object members) : value_(std::move(members)) {}
    template<typename T>
    requires std::constructible_from<Json, T> Json(const std::vector<T>& values)
        : value_(Array(values.begin(), values.end())) {}
    /// An object if each value is a pair that begins with a text: {{"vertices", 6}, {"name", "a"}}.
    /// A list otherwise.
    Json(std::initializer_list<Json> values);

    /// These functions return a list or an object whatever the values look like.
    [[nodiscard]] static Json array(std::initializer_list<Json> values = {}) {
        return Array(values);
    }
    [[nodiscard]] static Json object() { return Object(); }

    /// Reads a text. Objects keep their order.
    /// Throws:  JsonError "a syntax error at byte N", "a number out of range", or "more than 100
    ///          levels of nesting".
    [[nodiscard]] static Json parse(std::string_view text);

    [[nodiscard]] bool is_null() const { return is<std::nullptr_t>(); }
    [[nodiscard]] bool is_boolean() const { return is<bool>(); }
    [[nodiscard]] bool is_number() const {
        return is<double>() || is<std::int64_t>() || is<std::uint64_t>();
    }
    [[nodiscard]] bool is_string() const { return is<std::string>(); }
    [[nodiscard]] bool is_array() const { return is<Array>(); }
    [[nodiscard]] bool is_object() const { return is<Object>(); }
    [[nodiscard]] bool is_structured() const { return is_array() || is_object(); }
    /// Returns "null", "boolean", "number", "string", "array" or "object".
    [[nodiscard]] const char* type_name() const;

    /// These functions return the content.
    /// Throws:  JsonError for a value of another type. whole() also for a number that is negative
    ///          or was written with a point or an exponent.
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] double number() const;
    [[nodiscard]] std::uint64_t whole() const;
    [[nodiscard]] const std::string& string() const;
    [[nodiscard]] const Array& values() const;
    [[nodiscard]] const Object& members() const;

    /// Returns the number of values or members, 0 for all other types.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool empty() const { return size() == 0; }

    /// Returns a member, null if there is none or the value is no object. Of members with the same
    /// name it is the last.
    [[nodiscard]] const Json* find(std::string_view name) const;
    [[nodiscard]] bool contains(std::string_view name) const { return find(name) != nullptr; }
    /// Throws:  JsonError if there is no such member or value.
    [[nodiscard]] const Json& at(std::string_view name) const;
    [[nodiscard]] const Json& at(std::size_t index) const;

    /// Adds a member to an object or replaces it. Null becomes an object.
    void set(std::string_view name, Json value);
    /// Adds or replaces all members of another object. Null has none.
    void update(const Json& other);
    /// Appends a value to a list. Null becomes a list.
    void push_back(Json value);

    /// Names in the order in which they were set, or sorted.
    enum class Order { Set, Sorted };
    /// Bytes that are no UTF-8 are replaced, or refused.
    enum class Utf8 { Replace, Require };
    /// Returns the text with `indent` columns more for each level, on one line without.
    /// Throws:  JsonError for bytes that are no UTF-8, if it is required.
    [[nodiscard]] std::string text(int indent = -1, Order order = Order::Sorted,
                                   Utf8 utf8 = Utf8::Replace) const;

private:
    friend class JsonWriter;

    template<typename T>
    [[nodiscard]] bool is() const {
        return std::holds_alternative<T>(value_);
    }
    template<typename T>
    [[nodiscard]] const T& content(const char* expected) const;

    std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array,
                 Object>
        value_;
};

} // namespace relumine::files
