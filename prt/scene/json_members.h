// One list of members for writing a JSON object and for reading it.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "files/json.h"

namespace relumine::prt {

/// Numbers of a JSON object, checked for range, as 32 bits hold them.
///
/// Throws:  std::out_of_range for a number beyond the type, files::JsonError for another type.
[[nodiscard]] std::uint32_t natural(const files::Json& json);
[[nodiscard]] float real(const files::Json& json);

/// Sets the members of an object, or takes values from them.
///
/// Throws:  when reading: std::exception for members that are missing or of another type.
class JsonMembers {
public:
    /// Writes.
    JsonMembers() = default;
    /// Reads. The object must outlast this one.
    explicit JsonMembers(const files::Json& from) : from_(&from) {}

    template<typename Value>
    void operator()(const char* name, Value& value) {
        if (from_ != nullptr)
            take(from_->at(name), value);
        else
            json.set(name, json_of(value));
    }
    /// A member that is left out where the value is the usual one.
    template<typename Value>
    void unusual(const char* name, Value& value, const Value& usual) {
        if (from_ != nullptr ? from_->find(name) != nullptr : value != usual)
            (*this)(name, value);
    }

    /// What was written.
    files::Json json = files::Json::Object();

private:
    template<typename Value>
    static files::Json json_of(const Value& value) {
        return value;
    }
    template<typename Value>
    static files::Json json_of(const std::optional<Value>& value) {
        return json_of(*value);
    }

    static void take(const files::Json& from, bool& value) { value = from.boolean(); }
    static void take(const files::Json& from, float& value) { value = real(from); }
    static void take(const files::Json& from, std::uint32_t& value) { value = natural(from); }
    static void take(const files::Json& from, std::string& value) { value = from.string(); }
    static void take(const files::Json& from, glm::vec3& value) {
        if (from.values().size() != 3)
            throw std::out_of_range("expected three numbers");
        const files::Json::Array& v = from.values();
        value = {real(v[0]), real(v[1]), real(v[2])};
    }
    template<typename Element>
    static void take(const files::Json& from, std::vector<Element>& values) {
        values.clear();
        for (const files::Json& element : from.values())
            take(element, values.emplace_back());
    }
    template<typename Value>
    static void take(const files::Json& from, std::optional<Value>& value) {
        take(from, value.emplace());
    }

    const files::Json* from_ = nullptr;
};

} // namespace relumine::prt
