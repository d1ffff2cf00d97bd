// What a command found out, as --json prints it.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>

namespace relumine::app {

/// A value of JSON: an object of named values, a list, a number, text, a truth value or null. The
/// JSON library's full header stays in report.cpp, since it is slow to compile.
class Report {
public:
    struct Field;

    /// An empty object.
    Report();
    /// An object: {{"vertices", 6}, {"name", "octahedron"}}
    Report(std::initializer_list<Field> fields);
    Report(std::nullptr_t);
    Report(bool value);
    Report(double value);
    Report(const char* text);
    Report(std::string_view text);
    Report(const std::string& text) : Report(std::string_view(text)) {}
    template<std::integral T>
    Report(T value) : Report(whole(value)) {}
    /// Lists
    Report(const glm::dvec3& vector);
    Report(const glm::vec3& vector) : Report(glm::dvec3(vector)) {}
    Report(const std::vector<double>& numbers);
    Report(const std::vector<std::string>& texts);
    Report(const std::vector<Report>& values);

    ~Report();
    Report(const Report& other);
    Report(Report&& other) noexcept;
    Report& operator=(const Report& other);
    Report& operator=(Report&& other) noexcept;

    /// Adds a field to an object, or replaces it.
    void set(const std::string& name, const Report& value);
    /// Adds all fields of another object, or replaces them.
    void update(const Report& other);

    /// An object without fields, or a list without values.
    [[nodiscard]] bool empty() const;
    /// Two columns more for each level, names sorted; bytes that are no UTF-8 are replaced.
    [[nodiscard]] std::string text() const;
    /// The same on one line.
    [[nodiscard]] std::string line() const;

private:
    struct Signed {
        std::int64_t value;
    };
    struct Unsigned {
        std::uint64_t value;
    };
    explicit Report(Signed value);
    explicit Report(Unsigned value);
    template<std::integral T>
    static auto whole(T value) {
        if constexpr (std::signed_integral<T>)
            return Signed{value};
        else
            return Unsigned{value};
    }

    std::unique_ptr<nlohmann::json> json_;
};

/// One named value.
struct Report::Field {
    std::string_view name;
    Report value;
};

} // namespace relumine::app
