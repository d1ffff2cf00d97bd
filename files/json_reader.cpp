#include "files/json_reader.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "files/joined.h"
#include "files/nearest_name.h"
#include "files/printable.h"

namespace relumine::files {

namespace {

std::string description(const Json& value) {
    switch (value.type()) {
    case Json::Type::Null:
        return "null";
    case Json::Type::Boolean:
        return value.boolean() ? "true" : "false";
    case Json::Type::Number:
        return fmt::format("{}", value.number());
    case Json::Type::String:
        return fmt::format("\"{}\"", value.string());
    case Json::Type::Array:
        return "an array";
    case Json::Type::Object:
        return "an object";
    }
    return "";
}

} // namespace

Json JsonReader::parse(std::span<const std::byte> text) const {
    try {
        return parse_json({reinterpret_cast<const char*>(text.data()), text.size()},
                          Repeats::Refuse);
    } catch (const JsonSyntaxError& error) {
        fail(error.line, error.expected, error.got);
    }
}

void JsonReader::refuse(const Json& value, std::string_view expected, std::string_view got) const {
    fail(value.line_, expected, got);
}

void JsonReader::refuse(const Json& value, std::string_view reason) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", name_, value.line_, reason));
}

void JsonReader::fail(int line, std::string_view expected, std::string_view got) const {
    // Both may quote the file: a name, a text, or all that the parser has read since.
    throw std::runtime_error(
        printable(fmt::format("{}:{}: expected {:.500}, got {:.500}", name_, line, expected, got)));
}

double JsonReader::number(const Json& value, std::string_view what) const {
    if (value.type() != Json::Type::Number)
        refuse(value, fmt::format("{} to be a number", what), description(value));
    return value.number();
}

bool JsonReader::boolean(const Json& value, std::string_view what) const {
    if (value.type() != Json::Type::Boolean)
        refuse(value, fmt::format("{} to be true or false", what), description(value));
    return value.boolean();
}

const std::string& JsonReader::string(const Json& value, std::string_view what) const {
    if (value.type() != Json::Type::String)
        refuse(value, fmt::format("{} to be a string", what), description(value));
    return value.string();
}

const Json::Array& JsonReader::array(const Json& value, std::string_view what) const {
    if (value.type() != Json::Type::Array)
        refuse(value, fmt::format("{} to be an array", what), description(value));
    return value.values();
}

const Json::Object& JsonReader::object(const Json& value, std::string_view what) const {
    if (value.type() != Json::Type::Object)
        refuse(value, fmt::format("{} to be an object", what), description(value));
    return value.members();
}

glm::dvec3 JsonReader::vector(const Json& value, std::string_view what) const {
    const Json::Array& values = array(value, what);
    if (values.size() != 3)
        refuse(value, fmt::format("{} of 3 numbers", what), fmt::format("{}", values.size()));
    return {number(values[0], what), number(values[1], what), number(values[2], what)};
}

const Json& JsonReader::required(const Json& object, std::string_view member) const {
    if (const Json* found = object.find(member))
        return *found;
    std::vector<std::string_view> names;
    for (const auto& [name, value] : object.members())
        names.push_back(name);
    const std::string_view nearest = nearest_name(member, names);
    refuse(nearest.empty() ? object : object.at(nearest), fmt::format("\"{}\"", member),
           nearest.empty() ? "none" : fmt::format("\"{}\"", nearest));
}

void JsonReader::known(const Json& value, std::span<const std::string_view> names,
                       std::string_view what) const {
    for (const auto& [name, member] : object(value, what)) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            refuse(member, fmt::format("in {} only {}", what, joined(names, ", ")),
                   fmt::format("\"{}\"{}", name, did_you_mean(name, names)));
    }
}

void JsonReader::require_version(const Json& object, double version) const {
    const Json& given = required(object, "version");
    if (const double got = number(given, "\"version\""); got != version)
        refuse(given, fmt::format("version {}", version), fmt::format("{}", got));
}

} // namespace relumine::files
