// JSON that remembers the line of every value, for error messages that say where.
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

struct JsonValue {
    using Array = std::vector<JsonValue>;
    /// As in the file
    using Object = std::vector<std::pair<std::string, JsonValue>>;
    /// Where the value begins; for a string or a number where it stands
    int line = 1;
    std::variant<std::nullptr_t, bool, double, std::string, Array, Object> value = nullptr;
};

/// What reading needs to know: the file's name and the values' text.
class JsonReader {
public:
    /// `name` stands for the file in messages.
    explicit JsonReader(std::string name) : name_(std::move(name)) {}

    /// Throws std::runtime_error "name:line: expected X, got Y"; a name that an object has twice is
    /// refused too.
    [[nodiscard]] JsonValue parse(std::span<const std::byte> text) const;

    [[noreturn]] void refuse(int line, std::string_view expected, std::string_view got) const;

    /// The value's content if it is of the type, otherwise refused: `what` says what it is for.
    [[nodiscard]] double number(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] bool boolean(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] const std::string& string(const JsonValue& value, std::string_view what) const;
    [[nodiscard]] const JsonValue::Array& array(const JsonValue& value,
                                                std::string_view what) const;
    [[nodiscard]] const JsonValue::Object& object(const JsonValue& value,
                                                  std::string_view what) const;

    /// A member of an object, or null.
    [[nodiscard]] static const JsonValue* find(const JsonValue::Object& object,
                                               std::string_view field);

    [[nodiscard]] const std::string& name() const { return name_; }

private:
    std::string name_;
};

} // namespace relumine::files
