// Checks of a scene's values: whatever is read from a file, and whatever is written to one, passes
// them. Each group of sections has its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace relumine::prt {

/// For sums and products of floats that were in range, and for a mesh file's printed digits.
inline constexpr float RangeSlack = 1e-3f;

/// Throws std::runtime_error "path: expected X, got Y" for the first failure.
class SceneCheck {
public:
    explicit SceneCheck(const std::filesystem::path& path) : path_(path) {}

    template<typename Element, typename IsGood>
    void all(const std::string& expected, const std::vector<Element>& elements,
             const IsGood& is_good) const {
        all(expected, elements, is_good, [](const Element& element) { return element; });
    }
    /// `field` takes what is looked at out of an element.
    template<typename Element, typename IsGood, typename Field>
    void all(const std::string& expected, const std::vector<Element>& elements,
             const IsGood& is_good, const Field& field) const {
        const auto bad = std::find_if_not(elements.begin(), elements.end(),
                                          [&](const Element& e) { return is_good(field(e)); });
        if (bad != elements.end())
            fail(expected,
                 fmt::format("element {}: {}", bad - elements.begin(), text_of(field(*bad))));
    }
    void that(bool condition, const std::string& expected, const std::string& got) const {
        if (!condition)
            fail(expected, got);
    }
    [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path_.string(), expected, got));
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    static std::string text_of(float value) { return fmt::format("{}", value); }
    static std::string text_of(const glm::vec2& v) { return fmt::format("({}, {})", v.x, v.y); }
    static std::string text_of(const glm::vec3& v) {
        return fmt::format("({}, {}, {})", v.x, v.y, v.z);
    }
    static std::string text_of(const glm::vec4& v) {
        return fmt::format("({}, {}, {}, {})", v.x, v.y, v.z, v.w);
    }

private:
    const std::filesystem::path& path_;
};

// NaN fails every comparison below.

inline bool is_unit(const glm::vec3& v) {
    return std::abs(glm::length(v) - 1.0f) <= RangeSlack;
}

inline bool is_unit_or_zero(const glm::vec3& v) {
    return v == glm::vec3(0.0f) || is_unit(v);
}

inline bool is_within(const glm::vec3& v, float low, float high) {
    return v.x >= low && v.x <= high && v.y >= low && v.y <= high && v.z >= low && v.z <= high;
}

inline bool is_finite_uv(const glm::vec2& v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

} // namespace relumine::prt
