// JSON that people write: checks types, with messages that name the line.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <glm/vec3.hpp>

#include "files/json.h"

namespace relumine::files {

/// Reads JSON and checks types. Messages name the file and the line.
class JsonReader {
public:
    /// `name` stands for the file in messages.
    explicit JsonReader(std::string name) : name_(std::move(name)) {}

    /// Parses a text.
    /// Throws:  std::runtime_error "name:line: expected X, got Y". An object with the same name
    ///          twice is refused too.
    [[nodiscard]] Json parse(std::span<const std::byte> text) const;

    /// Throws:  std::runtime_error "name:line: expected X, got Y", with the value's line.
    [[noreturn]] void refuse(const Json& value, std::string_view expected,
                             std::string_view got) const;
    /// Throws:  std::runtime_error "name:line: reason".
    [[noreturn]] void refuse(const Json& value, std::string_view reason) const;

    /// These functions return the value's content and refuse a value of another type. `what` says
    /// what the value is for.
    [[nodiscard]] double number(const Json& value, std::string_view what) const;
    [[nodiscard]] bool boolean(const Json& value, std::string_view what) const;
    [[nodiscard]] const std::string& string(const Json& value, std::string_view what) const;
    [[nodiscard]] const Json::Array& array(const Json& value, std::string_view what) const;
    [[nodiscard]] const Json::Object& object(const Json& value, std::string_view what) const;
    /// An array of three numbers.
    [[nodiscard]] glm::dvec3 vector(const Json& value, std::string_view what) const;

    /// Returns a member of an object. An object without the member is refused.
    [[nodiscard]] const Json& required(const Json& object, std::string_view member) const;

    /// Refuses what is no object, and members with other names. `what` says what the object is.
    void known(const Json& value, std::span<const std::string_view> names,
               std::string_view what) const;

    /// Refuses a file whose "version" is another number.
    void require_version(const Json& object, double version) const;

private:
    [[noreturn]] void fail(int line, std::string_view expected, std::string_view got) const;

    std::string name_;
};

} // namespace relumine::files
