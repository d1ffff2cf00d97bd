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

/// A text that is no JSON.
class JsonSyntaxError : public JsonError {
public:
    JsonSyntaxError(const std::string& message, int at_line, std::string_view wanted,
                    std::string_view found)
        : JsonError(message), line(at_line), expected(wanted), got(found) {}
    /// Counted from 1.
    int line;
    std::string expected, got;
};

/// An object of named values, a list, a number, text, a truth value or null.
class Json {
public:
    using Array = std::vector<Json>;
    /// Members in the order in which they were set.
    using Object = std::vector<std::pair<std::string, Json>>;
    enum class Type { Null, Boolean, Number, String, Array, Object };

    /// Null.
    Json() = default;
    /// A truth value, a number, text, a vector of three numbers, a list of any of these, Array,
    /// Object or null.
    template<typename T>
        requires(!std::same_as<T, Json>)
    Json(T value) : value_(content_of(std::move(value))) {}
    /// An object if each value is a pair that begins with a text: {{"vertices", 6}, {"name", "a"}}.
    /// A list otherwise. Json::Array{...} is a list whatever the values look like.
    Json(std::initializer_list<Json> values);

    [[nodiscard]] Type type() const;

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

    /// Returns a member, null if there is none or the value is no object. Of members with the same
    /// name it is the last.
    [[nodiscard]] const Json* find(std::string_view name) const;
    /// Throws:  JsonError if there is no such member.
    [[nodiscard]] const Json& at(std::string_view name) const;

    /// Adds a member to an object or replaces it. Null becomes an object.
    void set(std::string_view name, Json value);
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
    friend class JsonBuilder;
    friend class JsonReader;
    friend class JsonWriter;

    using Content = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double,
                                 std::string, Array, Object>;

    template<typename T>
    [[nodiscard]] static Content content_of(T value) {
        if constexpr (std::same_as<T, bool> || std::same_as<T, std::nullptr_t> ||
                      std::same_as<T, Array> || std::same_as<T, Object>)
            return value;
        else if constexpr (std::signed_integral<T>)
            return std::int64_t{value};
        else if constexpr (std::unsigned_integral<T>)
            return std::uint64_t{value};
        else if constexpr (std::floating_point<T>)
            return double{value};
        else if constexpr (std::constructible_from<std::string, T>)
            return std::string(std::move(value));
        else if constexpr (std::same_as<T, glm::vec3> || std::same_as<T, glm::dvec3>)
            return Array{value.x, value.y, value.z};
        else
            return Array(value.begin(), value.end());
    }
    template<typename T>
    [[nodiscard]] const T& content(const char* expected) const;

    Content value_;
    /// The line of a text on which the value begins; 0 for values of no text.
    int line_ = 0;
};

/// Returns "null", "boolean", "number", "string", "array" or "object".
[[nodiscard]] std::string_view name(Json::Type type);

/// Whether an object may have a name twice.
enum class Repeats { Allow, Refuse };

/// Reads a text. Objects keep their order.
/// Throws:  JsonSyntaxError "a syntax error at byte N", "a number out of range", "more than 100
///          levels of nesting" or, where that is refused, a name that comes twice.
[[nodiscard]] Json parse_json(std::string_view text, Repeats repeats = Repeats::Allow);

/// Adds or replaces all members of another object. Null has none.
void update(Json& object, const Json& members);

} // namespace relumine::files
