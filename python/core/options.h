// Options of calls: Python's keyword arguments, by the names of the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "relumine/relumine.h"

namespace relumine::python {

namespace py = pybind11;

/// The options that a call was given. None is the same as not given.
class Options {
public:
    explicit Options(py::dict values) : values_(std::move(values)) {}

    /// Throws:  py::value_error "NAME: expected X, got Y".
    template<typename Value>
    [[nodiscard]] std::optional<Value> find(const char* name) const {
        const py::object value = given(name);
        if (value.is_none())
            return std::nullopt;
        try {
            return value.cast<Value>();
        } catch (const py::cast_error&) {
            constexpr bool IsWhole = std::is_integral_v<Value>;
            refuse(name,
                   std::is_same_v<Value, bool>          ? "True or False"
                   : std::is_same_v<Value, std::string> ? "text"
                   : IsWhole                            ? "a whole number that is not negative"
                   : std::is_floating_point_v<Value>    ? "a number"
                                                        : "another type",
                   value);
        }
    }
    /// Replaces `value` where the option is given.
    template<typename Value>
    void take(const char* name, Value& value) const {
        if (std::optional<Value> found = find<Value>(name))
            value = *std::move(found);
    }
    template<typename Value>
    void take(const char* name, std::optional<Value>& value) const {
        if (std::optional<Value> found = find<Value>(name))
            value = std::move(found);
    }

    /// A number for grey, or three.
    [[nodiscard]] std::optional<glm::vec3> color(const char* name) const;
    [[nodiscard]] std::optional<glm::vec3> point(const char* name) const;
    [[nodiscard]] py::object given(const char* name) const;
    [[nodiscard]] bool has(const char* name) const { return !given(name).is_none(); }

    [[noreturn]] static void refuse(const char* name, const std::string& expected,
                                    const py::object& got);

private:
    py::dict values_;
};

[[nodiscard]] glm::vec3 vec3_of(const char* name, const py::object& value);

/// EnvironmentOptions, and the text that they point into.
struct TurnedOptions {
    std::string from = "openexr";
    EnvironmentOptions options = {};

    explicit TurnedOptions(const Options& given);
    [[nodiscard]] EnvironmentOptions get() const {
        EnvironmentOptions result = options;
        result.from = from;
        return result;
    }
};

/// Throws py::value_error for an unknown word.
[[nodiscard]] cubemap::Layout layout_named(const char* option, const std::string& name);
[[nodiscard]] MeshOptions mesh_options(const Options& given);
[[nodiscard]] RefineOptions refine_options(const Options& given);
[[nodiscard]] PrecomputeOptions precompute_options(const Options& given);
/// `material`: what Python made of it.
[[nodiscard]] std::vector<SurfaceMaterial> materials_of(const Options& given);
[[nodiscard]] OutputOptions output_options(const Options& given, const Scene& scene);

} // namespace relumine::python
