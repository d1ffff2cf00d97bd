// JSON that keeps the line of every value, so error messages can name it.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace relumine::files {

/// A value of a JSON text.
struct JsonValue {
    using Array = std::vector<JsonValue>;
    /// Members in the order of the file.
    using Object = std::vector<std::pair<std::string, JsonValue>>;
    /// The line on which the value begins.
    int line = 1;
    std::variant<std::nullptr_t, bool, double, std::string, Array, Object> value = nullptr;
};

/// Reads JSON and checks types. Messages name the file and the line.
class JsonReader {
public:
    /// `name` stands for the file in messages.
    explicit JsonReader(std::string name) : name_(std::move(name)) {}

    /// Parses a text.
    /// Throws:  std::runtime_error "name:line: expected X, got Y". An object with the same name
    ///          twice is refused too.
    [[nodiscard]] JsonValue parse(std::span<const std::byte> text) const;

    /// Throws:  std::runtime_error "name:line: expected X, got Y".
    [[noreturn]] void refuse(int line, std::string_view expected, std::string_view got) const;

    /// These functions return the value's content and refuse a value of another type. `what` says
    /// what the value is for.
    [[nodiscard]] double number(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] bool boolean(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] const std::string& string(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] const JsonValue::Array& array(const JsonValue& value,
                                                std::string_view what) const;
    [[nodiscard]] const JsonValue::Object& object(const JsonValue& value,
                                                  std::string_view what) const;

    /// Returns a member of an object. Null if there is none.
    [[nodiscard]] static const JsonValue* find(const JsonValue::Object& object,
                                               std::string_view field);

    /// Returns a member of an object. An object without the member is refused.
    [[nodiscard]] const JsonValue& required(const JsonValue& owner,
                                            const JsonValue::Object& members,
                                            std::string_view field) const;

    /// Refuses members with other names. `what` says what the object is.
    void known(const JsonValue::Object& members, std::span<const std::string_view> names,
               std::string_view what) const;

    [[nodiscard]] const std::string& name() const { return name_; }

private:
    std::string name_;
};

} // namespace relumine::files
